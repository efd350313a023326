"""The map of what is reached: panels, labels, classes and names."""

import numpy as np

from vines.figures import REGIME_CLASSES, RegimeMap, regimes_figure


def _map() -> RegimeMap:
    """Return a map whose left half is symmetric 1:1, sticking below, and whose right half is chaotic."""
    shape = (40, 60)
    left = np.broadcast_to(np.arange(60) < 30, shape)
    low = np.broadcast_to((np.arange(40) < 10)[:, None], shape)
    places = list(REGIME_CLASSES)
    name = np.full(shape, None, dtype=object)
    name[left] = "1:1"
    return RegimeMap(
        axes=("A", "mu"),
        x=np.geomspace(0.01, 1.0, 60),
        y=np.geomspace(0.001, 1.0, 40),
        regime=np.where(left, places.index("1:1, symmetric"), places.index("chaotic")),
        sticks=left & low,
        name=name,
        ratio=np.where(left, 2.0, 0.01),
        caption="fixed",
    )


def test_two_panels_share_axes_that_are_logarithmic_where_the_range_is_wide() -> None:
    figure = regimes_figure(_map(), title="told")
    left, right, bar = figure.axes
    assert left.get_xlabel().startswith("forcing amplitude")
    assert right.get_xlabel() == left.get_xlabel()
    assert left.get_ylabel().startswith("mass ratio")
    assert bar.get_ylabel() == "$K_2/K_1$"
    assert left.get_xscale() == right.get_yscale() == "log"
    assert left.get_xlim() == (0.01, 1.0)
    assert figure.get_suptitle() == "told, fixed"


def test_the_legend_has_the_classes_that_occur_and_the_mark_of_sticking() -> None:
    (legend,) = regimes_figure(_map()).legends
    told = [text.get_text() for text in legend.get_texts()]
    assert told == ["1:1, symmetric", "chaotic", "any, darker: sticking recurs"]


def test_a_wide_region_bears_its_name_inside_itself() -> None:
    left = regimes_figure(_map()).axes[0]
    (name,) = left.texts
    assert name.get_text() == "1:1"
    assert name.get_position()[0] < 0.1
