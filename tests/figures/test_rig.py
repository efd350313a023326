"""Figures of a rig: panels, labels, marks, where the data lie, bytes that repeat."""

import numpy as np
import pytest

from vines.figures import (
    BranchLine,
    RigCycle,
    RigPoints,
    rig_branches_figure,
    rig_cycles_figure,
    rig_residual_figure,
    rig_waits_figure,
    save,
)


def line(side, values, family="symmetric", label="1:1 symmetric"):
    x = np.linspace(0.01, 0.03, 21)
    return BranchLine(x, side, x < 0.02, {name: scale * x for name, scale in values.items()}, label, family)


def points(side, scale, model=True):
    x = np.array([0.014, 0.016, 0.0161])
    lack = np.full(3, np.nan)
    return RigPoints(
        x=x,
        u_x=np.full(3, 1e-4),
        y=scale * x,
        u_y=np.full(3, 0.01),
        side=np.full(3, side),
        protocol=np.array(["sweep_up", "sweep_up", "sweep_down"]),
        good=np.array([True, False, True]),
        model=scale * x if model else lack,
        u_model=np.full(3, 0.02) if model else lack,
    )


@pytest.fixture
def branches():
    lines = [line(0, {"max_abs_x1": 40.0}), line(1, {"w_dot": 60.0}), line(-1, {"w_dot": -60.0})]
    shown = {"max_abs_x1": points(0, 40.0), "w_dot": points(1, 60.0, model=False)}
    return rig_branches_figure(shown, lines, caption="at $\\mu = 0.01$")


def test_rig_points_lie_on_branches_with_bars_of_two_standard_uncertainties(branches):
    first, second = branches.axes
    assert first.get_ylabel() == r"largest displacement  $\max|x_1|$"
    assert second.get_ylabel() == r"relative impact velocity  $\dot w$"
    assert (first.get_xlabel(), second.get_xlabel()) == ("", "forcing amplitude  $A$")
    assert first.get_title(loc="left") == "at $\\mu = 0.01$; bars: two standard uncertainties"
    low, high = first.get_xlim()
    assert 0.0125 < low < 0.014 < 0.0161 < high < 0.0175
    bars = [bar for bar in first.containers if bar.lines[0].get_marker() == "^"]
    ends = sorted(cap.get_ydata()[0] for cap in bars[0].lines[1] if cap.get_marker() == "_")
    assert ends == pytest.approx([40 * 0.014 - 0.02, 40 * 0.014 + 0.02])


def test_rising_and_falling_amplitudes_and_what_failed_have_marks_of_their_own(branches):
    marks = {
        (drawn.get_marker(), drawn.get_markerfacecolor() == "white")
        for bar in branches.axes[0].containers
        for drawn in bar.lines[:1]
    }
    assert {("^", False), ("^", True), ("v", False)} <= marks
    (legend,) = branches.legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said == [
        "rig, amplitude rising",
        "rig, amplitude falling",
        "empty: gates failed, or no pattern holds",
        "model at the measured parameters",
        "1:1 symmetric",
        "stable",
    ]


def test_lines_of_whole_orbits_and_of_impacts_stay_in_their_panels(branches):
    first, second = branches.axes
    curves = [[one for one in ax.lines if len(one.get_xdata()) > 3] for ax in (first, second)]
    assert {float(np.sign(one.get_ydata()[0])) for one in curves[0]} == {1.0}
    assert {float(np.sign(one.get_ydata()[0])) for one in curves[1]} == {1.0, -1.0}


def cycle(k):
    turn = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    edges = np.linspace(0.4, 0.6, 11)
    share = np.full(10, 0.1)
    curves = (0.9 * np.cos(turn), np.sin(turn), 0.91 * np.cos(turn), 1.01 * np.sin(turn))
    return RigCycle(f"run {k}: 1:1, agree", *curves, edges, share, share[::-1], (0.011, 0.023))


def test_each_run_has_a_panel_with_walls_and_rms():
    figure = rig_cycles_figure([cycle(k) for k in range(4)], caption="cycles")
    shown = [ax for ax in figure.axes if ax.axison]
    assert len(shown) == 4
    assert shown[0].get_title(loc="left") == "run 0: 1:1, agree\nrms of $w$ 1.1%, of $\\dot w$ 2.3%"
    assert shown[0].get_xlim() == (-1.12, 1.12)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["measured", "model"]
    curves = [one for one in shown[0].lines if len(one.get_xdata()) > 2]
    assert len(curves) == 2
    assert all(one.get_xdata()[0] == one.get_xdata()[-1] for one in curves)  # they close
    assert figure.get_suptitle() == "cycles"


def test_waits_are_histograms_of_both():
    figure = rig_waits_figure([cycle(0)])
    (ax,) = figure.axes
    assert len(ax.patches) == 2
    assert ax.get_xlim() == pytest.approx((0.4, 0.6))
    assert ax.get_xlabel() == r"time to next impact  $\Delta t/T$"
    assert ax.get_title(loc="left") == "run 0: 1:1, agree"


def test_residual_over_temperature_in_micrometres(tmp_path):
    given = (np.array([20.0, 21.0]), np.array([5e-7, 9e-7]), np.array([4e-7, 4e-7]))
    figure = rig_residual_figure(*given, ["sweep_up", "sweep_down"], np.array([True, False]), caption="residual")
    (ax,) = figure.axes
    drawn = {(one.get_marker(), one.get_markerfacecolor() == "white"): one for one in ax.lines if len(one.get_xdata())}
    assert drawn["^", False].get_ydata() == pytest.approx([0.5])
    assert drawn["v", True].get_ydata() == pytest.approx([0.9])
    assert ax.get_ylim()[0] == 0
    first = [path.read_bytes() for path in save(figure, tmp_path)]
    again = rig_residual_figure(*given, ["sweep_up", "sweep_down"], np.array([True, False]), caption="residual")
    assert [path.read_bytes() for path in save(again, tmp_path, "again")] == first
