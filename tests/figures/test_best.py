"""Maps of which set is best, and what sets are worth along one parameter."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from vines.figures import SETS, BestMap, LeadMap, SetCurve, SetPanel, sheet_figure

X, Y = np.array([0.01, 0.02, 0.04, 0.08]), np.array([0.9, 1.0, 1.1, 1.2, 1.3])
NAMES = ("ball", "spring", "both")


def best_map(**changes):
    best = np.zeros((5, 4), dtype=np.int64)
    best[:, 2:] = 2
    best[0, 0] = -1
    lead = np.full((5, 4), 2.0)
    lead[1, 0] = 1.01
    return BestMap(("A", "Omega"), X, Y, best, lead, NAMES, 0.05, (True, False), **changes)


def test_a_map_has_the_colour_of_the_best_paler_where_another_is_close_and_white_where_none_is_known():
    ax = sheet_figure([best_map(title="worst")]).axes[0]
    (mesh,) = ax.collections
    shown = mesh.get_array().reshape(5, 4, 3)
    assert tuple(shown[2, 0]) == pytest.approx(to_rgb(SETS[0]))
    assert tuple(shown[2, 3]) == pytest.approx(to_rgb(SETS[2]))
    assert (shown[1, 0] > shown[2, 0]).all()
    assert tuple(shown[0, 0]) == (1.0, 1.0, 1.0)
    assert (ax.get_title(), ax.get_xlabel(), ax.get_ylabel()) == (
        "worst",
        "forcing amplitude  $A$",
        r"frequency ratio  $\Omega$",
    )
    # cells reach half a step beyond the values, on a logarithmic axis in ratio
    assert ax.get_xlim() == pytest.approx((0.01 / 2**0.5, 0.08 * 2**0.5))
    assert ax.get_ylim() == pytest.approx((0.85, 1.35))


def test_a_legend_tells_each_set_once_for_maps_and_lines():
    curves = [SetCurve(X, np.full(4, 0.4), np.full(4, 0.5), k) for k in (0, 2)]
    over = SetPanel("A", "reduction", curves, NAMES, log=(True, False))
    figure = sheet_figure([best_map(), over], columns=2)
    (legend,) = figure.legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said == ["ball", "spring", "both", "paler: by less than 5 %", "from the best attractor to the worst"]
    first, second = figure.axes[1].lines
    assert (first.get_color(), second.get_color()) == (SETS[0], SETS[2])
    assert first.get_linestyle() != second.get_linestyle()
    assert first.get_ydata() == pytest.approx(0.5)
    assert figure.axes[1].get_ylabel() == r"reduction of $\max|x_1|$"


def test_names_stand_in_regions_that_have_room_for_them():
    x, y = np.linspace(0.01, 0.06, 12), np.linspace(0.9, 1.1, 12)
    best = np.zeros((12, 12), dtype=np.int64)
    best[:, 6:] = 1
    best[0, 0] = 2
    ax = sheet_figure([BestMap(("A", "Omega"), x, y, best, np.full((12, 12), 2.0), NAMES, 0.0)]).axes[0]
    assert sorted(text.get_text() for text in ax.texts) == ["ball", "spring"]


def test_a_lead_is_a_ratio_from_one_and_its_bar_says_when_it_goes_beyond():
    lead = np.array([[1.0, 2.0], [4.0, np.nan]])
    panel = LeadMap(("A", "Omega"), X[:2], Y[:2], lead, limits=(1.0, 3.0))
    figure = sheet_figure([panel])
    bar = figure.axes[1]
    assert bar.get_ylabel() == "second best over best"
    assert bar.get_ylim() == pytest.approx((1.0, 3.0))
    assert [tick.get_text() for tick in bar.get_yticklabels()] == ["1", "1.2", "1.5", "2", "3"]
    assert panel.entries() == []


def test_where_nothing_is_attached_there_is_a_line_for_comparison():
    curve = SetCurve(Y, np.ones(5), np.ones(5), 1)
    panel = SetPanel("Omega", "max_abs_x1", [curve], NAMES, without=(Y, np.full(5, 9.0)), log=(False, True))
    ax = sheet_figure([panel]).axes[0]
    assert [line.get_ydata()[0] for line in ax.lines] == [9.0, 1.0]
    assert (ax.get_yscale(), ax.get_xlim()) == ("log", pytest.approx((0.9, 1.3)))
    assert [text for text, _ in panel.entries()] == ["spring", "nothing attached"]
