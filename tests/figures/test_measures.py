"""Measures over one parameter, and what designs are worth: panels, labels, marks, bands and ranges."""

import numpy as np
import pyarrow as pa
import pytest

from vines.figures import (
    BandCurve,
    BandPanel,
    DesignMap,
    FactorPanel,
    MeasureCurve,
    MeasurePanel,
    sheet_figure,
)
from vines.stages.plots._designs import designs_of

X = np.linspace(0.9, 1.1, 21)


def sweeps(**options):
    up = MeasureCurve(X, np.full(21, 0.2), "one ball", 0, "up")
    down = MeasureCurve(X, np.full(21, 0.3), "one ball", 0, "down")
    return MeasurePanel("Omega", "max_abs_x1", [up, down], **options)


def test_sweeps_up_and_down_have_marks_that_point_and_one_colour_with_the_band_between():
    figure = sheet_figure([sweeps(band=True, marks=[1.0])])
    (ax,) = figure.axes
    mark, up, down = ax.lines
    assert list(mark.get_xdata()) == [1.0, 1.0]
    assert (up.get_marker(), down.get_marker()) == ("^", "v")
    assert up.get_color() == down.get_color()
    assert (up.get_linestyle(), down.get_markerfacecolor()) == ("None", "none")
    (band,) = ax.collections
    assert sorted(set(np.round(band.get_paths()[0].vertices[:, 1], 6))) == [0.2, 0.3]
    assert (ax.get_xlabel(), ax.get_ylabel()) == (
        r"frequency ratio  $\Omega$",
        r"largest displacement  $\max|x_1|$",
    )
    assert ax.get_xlim() == pytest.approx((0.897, 1.103))
    assert ax.get_ylim()[0] == 0
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["one ball", "swept up", "swept down"]


def test_lines_are_told_apart_by_colour_and_dashes_and_axes_may_be_logarithmic():
    curves = [MeasureCurve(X, k * X, f"$r = {k}$", k) for k in range(3)]
    panel = MeasurePanel(
        "V", "impact_share", curves, log=(True, False), legend=True, window=(0.5, 2.0), title="a title"
    )
    (ax,) = sheet_figure([panel]).axes
    looks = {(line.get_color(), str(line.get_linestyle()), line._dash_pattern[1] is None) for line in ax.lines}
    assert len(looks) == 3
    assert (ax.get_xscale(), ax.get_yscale(), ax.get_xlim()) == ("log", "linear", (0.5, 2.0))
    assert (ax.get_xlabel(), ax.get_title()) == ("velocity at the start  $V$", "a title")
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["$r = 0$", "$r = 1$", "$r = 2$"]


def test_branches_are_lines_dotted_where_unstable_over_paler_points():
    turning = np.concatenate([X, X[::-1]])
    branch = MeasureCurve(turning, np.linspace(0, 1, 42), "1:1 symmetric", 1, stable=np.arange(42) < 21)
    up = MeasureCurve(X, np.full(21, 0.2), "simulation", 0, "up")
    figure = sheet_figure([MeasurePanel("Omega", "max_abs_x1", [up, branch])])
    dots, stable, unstable = figure.axes[0].lines
    assert (dots.get_alpha(), stable.get_alpha()) == (0.35, None)
    assert dots.get_zorder() < stable.get_zorder()
    assert stable.get_color() == unstable.get_color() != dots.get_color()
    assert (stable.get_linestyle(), unstable.get_linestyle()) == ("-", ":") or unstable._dash_pattern[1] is not None
    assert stable.get_xdata()[-1] == unstable.get_xdata()[0]
    assert figure.axes[0].get_xlim() == pytest.approx((0.897, 1.103))
    (legend,) = figure.legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said == ["simulation", "1:1 symmetric", "swept up", "stable", "unstable"]


def points(rows):
    names = ("mu_1", "beta_2", "A", "reduction")
    return pa.table({name: [row[k] for row in rows] for k, name in enumerate(names)})


def test_of_each_design_the_worst_attractor_counts_over_every_range_of_the_grid():
    rng = np.random.default_rng(5)
    over, mus, betas = 0.01 * 2.0 ** np.arange(7), (0.004, 0.008), (1.0, 1.5, 2.0)
    starts = rng.uniform(0.1, 1.0, (3, 2, 3, 7))
    tables = [
        points(
            [(m, b, a, s[i, j, k]) for k, a in enumerate(over) for i, m in enumerate(mus) for j, b in enumerate(betas)]
        )
        for s in starts
    ]
    found = designs_of(tables, ("mu_1", "beta_2"), "A", "reduction")
    assert np.array_equal(found.worst, starts.max(axis=0))
    assert np.array_equal(found.least, starts.min(axis=0))
    # ranges of a factor of 4 are three values of the grid
    by_hand = {(i, j, k): starts[:, i, j, k : k + 3].max() for i in range(2) for j in range(3) for k in range(5)}
    place, worst = min(by_hand.items(), key=lambda item: item[1])
    best = found.best(0.02, 0.08)
    assert ((*best.place, best.first), best.worst) == (place, worst)
    assert best.last == best.first + 2
    assert best.size == 0.02 / over[best.first]
    assert found.windows(4.0).shape == (2, 3, 5)
    assert found.best(0.01, 6.5) is None


def test_a_run_that_failed_gains_a_design_nothing():
    rows = [(0.01, 1.0, 0.01, 0.5), (0.01, 1.0, 0.02, None), (0.02, 1.0, 0.01, 0.6), (0.02, 1.0, 0.02, 0.7)]
    found = designs_of([points(rows)], ("mu_1", "beta_2"), "A", "reduction")
    assert found.best(0.01, 0.02).place == (1, 0)


def test_panels_of_designs_have_bands_widths_and_a_map_with_its_best_place():
    x = np.geomspace(0.01, 0.1, 9)
    band = BandCurve(x, np.full(9, 0.2), np.full(9, 0.4), "one cavity: 0.400", 0)
    other = BandCurve(x, np.full(9, 0.1), np.full(9, 0.3), "two: 0.300", 1)
    worst = np.linspace(0.3, 0.9, 12).reshape(4, 3)
    panels = [
        BandPanel("A", "reduction", [band, other], (0.012, 0.06)),
        FactorPanel("A", "reduction", [("one", np.array([2.0, 5.0, 8.0]), np.array([0.2, 0.3, 0.4]), 0)], 5.0),
        DesignMap(
            ("mu_1", "beta_2"),
            np.array([0.004, 0.008, 0.012]),
            np.arange(1.0, 5.0),
            worst,
            (0.004, 1.0),
            "reduction",
            limits=(0.3, 0.6),
        ),
    ]
    figure = sheet_figure(panels, columns=3)
    bands, widths, plan, bar = figure.axes
    assert [ax.get_title(loc="left") for ax in (bands, widths, plan)] == ["(a)", "(b)", "(c)"]
    assert bands.get_xscale() == widths.get_xscale() == "log"
    assert bands.get_xlim()[0] < 0.012 < 0.06 < bands.get_xlim()[1]
    assert bands.get_ylim() == pytest.approx((0.0, 0.432))
    one, two = (line for line in bands.lines if len(line.get_xdata()) == 9)
    assert one.get_color() != two.get_color()
    assert one.get_linestyle() != two.get_linestyle()
    assert widths.get_ylabel() == r"least worst reduction of $\max|x_1|$"
    assert widths.get_xlim() == (1.0, 8.0)
    assert [text.get_text() for text in widths.get_legend().get_texts()] == ["one"]
    assert (plan.get_xlabel(), plan.get_ylabel()) == (
        r"mass ratio 1  $\mu_{1}$",
        r"length of the cavity 2  $\beta_{2}$",
    )
    assert plan.get_xlim() == pytest.approx((0.002, 0.014))
    (star,) = (line for line in plan.lines if line.get_marker() == "*")
    assert (list(star.get_xdata()), list(star.get_ydata())) == ([0.004], [1.0])
    assert bar.get_ylabel() == r"least worst reduction of $\max|x_1|$"
    assert plan.collections[0].get_clim() == (0.3, 0.6)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "one cavity: 0.400",
        "two: 0.300",
        "from the best attractor to the worst",
        "best design",
    ]
