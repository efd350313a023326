"""The bifurcation figure: panels, labels, ranges, and bytes that repeat."""

import numpy as np
import pytest

from vines.errors import DeclarationError
from vines.figures import COLOURS, BranchLine, ImpactDots, Marker, bifurcation_figure, save
from vines.figures._colours import FAMILIES


def drawing(**options):
    x = np.linspace(0.015, 0.024, 40)
    values = {"w_dot": 0.2 + x, "dt": np.full_like(x, 0.5), "x1": x, "phase": x}
    dots = ImpactDots(
        x=np.repeat(x, 2), side=np.tile([1, -1], 40), values={k: np.repeat(v, 2) for k, v in values.items()}
    )
    lines = [BranchLine(x=x, side=s, stable=x < 0.018, values=values, label="1:1 symmetric") for s in (1, -1)]
    marker = Marker("symmetry_breaking", 0.018, {k: np.array([0.2, 0.2]) for k in values})
    return bifurcation_figure("A", [dots], lines, [marker], **options)


def test_panels_labels_and_ranges():
    axes = drawing().axes
    assert [ax.get_ylabel() for ax in axes] == [
        r"relative impact velocity  $\dot w$",
        r"time to next impact  $\Delta t / T$",
    ]
    assert axes[-1].get_xlabel() == "forcing amplitude  $A$"
    low, high = axes[-1].get_xlim()
    assert 0.0148 < low < 0.015 < 0.024 < high < 0.0242


def test_stable_parts_are_solid_and_unstable_ones_dotted():
    styles = {line.get_linestyle() for line in drawing().axes[0].lines}
    assert {"-", ":"} <= {s if isinstance(s, str) else ":" for s in styles} | {":"}
    solid = [line for line in drawing().axes[0].lines if line.get_linestyle() == "-"]
    assert all(line.get_xdata().max() <= 0.0182 for line in solid)


def test_legend_names_everything_once():
    (legend,) = drawing().legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels == ["simulation", "1:1 symmetric", "stable", "unstable", "symmetry breaking (0.018)"]


def test_families_have_the_colours_of_the_paper():
    x = np.linspace(0.02, 0.03, 5)
    values = {"w_dot": x, "dt": x}
    lines = [
        BranchLine(x=x, side=side, stable=x > 0, values=values, label=family, family=family)
        for family in ("symmetric", "asymmetric", "unequal")
        for side in (1, -1)
    ]
    # The flight times of the two ends of a symmetric orbit coincide, and are neither red nor blue.
    drawn = bifurcation_figure("A", [], lines, [], panels=("w_dot", "dt")).axes
    assert [line.get_color() for line in drawn[0].lines[2:]] == [
        colour for family in ("asymmetric", "unequal") for colour in FAMILIES[family]
    ]
    assert {line.get_color() for line in drawn[1].lines[:2]} == {COLOURS["ink"]}


def test_stops_are_no_impacts():
    x = np.linspace(0.02, 0.03, 5)
    values = {"w_dot": 0.0 * x, "dt": x}
    lines = [BranchLine(x=x, side=0, stable=x > 0, values=values, label="1:1", family="unequal", stop=True)]
    figure = bifurcation_figure("A", [], lines, [], panels=("w_dot", "dt"))
    assert {line.get_color() for ax in figure.axes for line in ax.lines} == {COLOURS["stop"]}
    assert "stop in mid-cavity" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_a_mirror_image_adds_nothing_to_flight_times():
    x = np.linspace(0.02, 0.03, 5)
    line = BranchLine(x=x, side=1, stable=x > 0, values={"w_dot": x, "dt": x}, label="", family="asymmetric")
    image = BranchLine(
        x=x, side=-1, stable=x > 0, values={"w_dot": -x, "dt": x}, label="", family="asymmetric", image=True
    )
    axes = bifurcation_figure("A", [], [line, image], []).axes
    assert [len(ax.lines) for ax in axes] == [2, 1]


def test_a_window_scales_the_other_axis_to_what_it_shows():
    (ax,) = drawing(panels=("x1",), window=(0.016, 0.017)).axes
    assert ax.get_xlim() == (0.016, 0.017)
    low, high = ax.get_ylim()
    assert 0.0158 < low < 0.016 < 0.017 < high < 0.0172
    (legend,) = ax.figure.legends
    assert "symmetry breaking (0.018)" not in [text.get_text() for text in legend.get_texts()]


def test_a_long_flight_does_not_flatten_the_branches():
    x = np.linspace(0.01, 0.02, 200)
    dt = np.where(np.arange(200) == 7, 25.0, 0.5)
    dots = ImpactDots(x=x, side=np.ones(200, dtype=int), values={"dt": dt})
    line = BranchLine(x=x, side=1, stable=x > 0, values={"dt": np.linspace(0.3, 0.7, 200)}, label="1:1")
    (ax,) = bifurcation_figure("A", [dots], [line], [], panels=("dt",)).axes
    assert ax.get_ylim()[1] < 0.8


def test_orbits_at_a_few_places_are_shown_beside_chaos_at_one():
    x = np.linspace(0.02, 0.05, 60)
    line = BranchLine(x=x, side=1, stable=x < 0.03, values={"dt": np.full(60, 0.5)}, label="1:1 symmetric")
    regular, chaos = np.concatenate([np.full(50, 0.5), np.full(10, 0.9)]), np.linspace(0.45, 0.55, 2000)
    dots = ImpactDots(
        x=np.concatenate([x, np.full(2000, 0.05)]), side=np.ones(2060), values={"dt": np.concatenate([regular, chaos])},
        repeats=np.concatenate([np.full(60, 64.0), np.ones(2000)]),
    )  # fmt: skip
    assert bifurcation_figure("A", [dots], [line], [], panels=("dt",)).axes[0].get_ylim()[1] > 0.9


def test_files_are_the_same_bytes_each_time(tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        save(drawing(), tmp_path / name)
    for suffix in ("png", "svg"):
        one, two = ((tmp_path / n / f"picture.{suffix}").read_bytes() for n in ("one", "two"))
        assert one == two


def test_all_files_are_laid_out_once_and_each_is_drawn_once(tmp_path, monkeypatch):
    from collections import Counter

    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    calls = Counter()

    def counted(owner, name):
        function = getattr(owner, name)

        def inner(self, *about, **options):
            calls[name] += 1
            return function(self, *about, **options)

        monkeypatch.setattr(owner, name, inner)

    figure = drawing()
    counted(ConstrainedLayoutEngine, "execute")
    counted(Figure, "draw")
    files = save(figure, tmp_path)
    assert calls == {"execute": 1, "draw": len(files)}


def test_unknown_panel_names_the_nearest():
    with pytest.raises(DeclarationError, match="'w_dot'"):
        drawing(panels=["w_dott"])
