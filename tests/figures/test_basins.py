"""The map of basins: an image whose pixels are the cells, whatever their sizes, and a legend that says everything."""

import io
import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from vines.figures import BasinMap, basins_figure
from vines.figures._basins import SHADE, UNSETTLED
from vines.figures._colours import CHAOS, HUES


def _map(nx: int = 6, ny: int = 4) -> BasinMap:
    """Return a map: 1:1 on the left, its mirror image in the first column, chaos on the right, one cell not settled."""
    x, y = (grid.ravel() for grid in np.meshgrid(0.1 * np.arange(nx), 1.0 * np.arange(ny)))
    attractor = np.where(x < 0.25, 0, 1)
    attractor[-1] = -1
    return BasinMap(
        axes=("$x_2$", "$x_2'$"),
        x=x,
        y=y,
        level=np.zeros(nx * ny, dtype=np.int64),
        attractor=attractor,
        mirrored=x < 0.05,
        names=["1:1: 50 %", "chaotic: 46 %", "not settled: 4 %"],
        regimes=["periodic", "chaotic"],
        steps=(0.1, 1.0),
    )


def _pixels(data: BasinMap) -> np.ndarray:
    (ax,) = basins_figure(data).axes
    return np.asarray(ax.get_images()[0].get_array())


def test_each_cell_is_a_pixel_of_the_colour_of_what_it_comes_to() -> None:
    (ax,) = basins_figure(_map(), title="told").axes
    image = ax.get_images()[0]
    assert image.get_extent() == pytest.approx((-0.05, 0.55, -0.5, 3.5))
    pixels = np.asarray(image.get_array())
    assert pixels.shape == (4, 6, 3)
    assert pixels[0, 0] == pytest.approx(SHADE * np.array(to_rgb(HUES[0])))
    assert pixels[0, 2] == pytest.approx(to_rgb(HUES[0]))
    assert pixels[0, 5] == pytest.approx(to_rgb(CHAOS[0]))
    assert pixels[3, 5] == pytest.approx(to_rgb(UNSETTLED))
    assert ax.get_title() == "told"


def test_the_legend_has_what_has_not_settled_too() -> None:
    (legend,) = basins_figure(_map()).legends
    assert [text.get_text() for text in legend.get_texts()] == _map().names


@pytest.mark.parametrize(
    "told", ["chaotic: 46 %", "chaotic: 94.46 ± 0.02 % of the starts, left after 450,000 periods on average"]
)
def test_the_legend_stays_inside_the_picture(told: str) -> None:
    figure = basins_figure(replace(_map(), names=["1:1: 50 %", told, "not settled: 0.0033 ± 0.0006 % of the starts"]))
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert box.x0 >= 0
    assert box.x1 <= figure.bbox.x1


def test_halved_cells_fill_their_part_and_cells_outside_the_cavity_stay_white() -> None:
    whole = _map()
    keep = np.arange(24) != 9
    cut = whole.x[9] + 0.025 * np.array([-1, 1, -1, 1]), whole.y[9] + 0.25 * np.array([-1, -1, 1, 1])
    keep[23] = False
    data = BasinMap(
        axes=whole.axes,
        x=np.concatenate([whole.x[keep], cut[0]]),
        y=np.concatenate([whole.y[keep], cut[1]]),
        level=np.concatenate([whole.level[keep], np.ones(4, dtype=np.int64)]),
        attractor=np.concatenate([whole.attractor[keep], [1, 1, 0, -1]]),
        mirrored=np.concatenate([whole.mirrored[keep], np.zeros(4, dtype=bool)]),
        names=whole.names,
        regimes=whole.regimes,
        steps=whole.steps,
    )
    pixels = _pixels(data)
    assert pixels.shape == (8, 12, 3)
    chaos, one, open_one = (np.array(to_rgb(colour)) for colour in (CHAOS[0], HUES[0], UNSETTLED))
    assert pixels[2, 6] == pytest.approx(chaos)
    assert pixels[2, 7] == pytest.approx(chaos)
    assert pixels[3, 6] == pytest.approx(one)
    assert pixels[3, 7] == pytest.approx(open_one)
    assert np.all(pixels[6:, 10:] == 1.0)
    # Every other cell fills four pixels.
    assert np.all(
        pixels[::2, ::2][~np.isin(np.arange(24).reshape(4, 6), (9, 23))]
        == pixels[1::2, 1::2][~np.isin(np.arange(24).reshape(4, 6), (9, 23))]
    )


def test_cells_smaller_than_a_pixel_are_mixed() -> None:
    side = np.arange(1200)
    x, y = (grid.ravel() for grid in np.meshgrid(side + 0.0, [0.0]))
    quarters = np.array([-0.25, 0.25])
    data = BasinMap(
        axes=("$x_2$", "$x_2'$"),
        x=np.concatenate([x[1:], quarters, quarters]),
        y=np.concatenate([y[1:], [-0.25, -0.25, 0.25, 0.25]]),
        level=np.concatenate([np.zeros(1199, dtype=np.int64), np.ones(4, dtype=np.int64)]),
        attractor=np.concatenate([np.zeros(1199, dtype=np.int64), [0, 0, 0, 1]]),
        mirrored=np.zeros(1203, dtype=bool),
        names=["a", "b"],
        regimes=["periodic", "chaotic"],
        steps=(1.0, 1.0),
    )
    pixels = _pixels(data)
    assert pixels.shape == (1, 1200, 3)
    assert pixels[0, 0] == pytest.approx(0.75 * np.array(to_rgb(HUES[0])) + 0.25 * np.array(to_rgb(CHAOS[0])))


def test_a_large_map_is_one_picture_inside_the_svg() -> None:
    file = io.StringIO()
    basins_figure(_map(300, 200)).savefig(file, format="svg")
    assert len(re.findall("<image", file.getvalue())) == 1
    assert len(file.getvalue()) < 400_000
