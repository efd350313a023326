"""Panels of runs and sheets of panels: colours, walls, letters, legends, and bytes that repeat."""

from dataclasses import replace

import numpy as np
import pytest

from vines.figures import COLOURS, EndsPanel, GapPanel, PhasePlanePanel, RunCurves, save, sheet_figure


def run(label="", impacts=4):
    t = np.linspace(0, 4, 401)
    w = np.sin(2 * np.pi * t)
    hits = (np.arange(impacts) + 0.5) * 4 / impacts
    side = np.where(np.arange(impacts) % 2, -1, 1)
    return RunCurves(t, 0.2 * w, -0.8 * w, w, np.cos(t), hits, side, 0.8 * side, 1.5 * side, label)


def test_panels_in_rows_with_letters_and_labels():
    one = run()
    figure = sheet_figure([EndsPanel(one, 3), GapPanel(one, 3), PhasePlanePanel([one])], columns=3, caption="above")
    assert [ax.get_title(loc="left") for ax in figure.axes] == ["(a)", "(b)", "(c)"]
    assert [ax.get_xlabel() for ax in figure.axes] == ["time  $t/T$", "time  $t/T$", "gap  $w$"]
    assert [ax.get_xlim() for ax in figure.axes] == [(0, 3), (0, 3), (-1.15, 1.15)]
    assert figure.get_suptitle() == "above"
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels[:3] == [r"cavity ends $x_1 \pm 1$", "ball $x_2$", "impact"]
    assert len(set(labels)) == len(labels)


def test_ends_are_dotted_blue_and_the_ball_is_red():
    one = run()
    (ax,) = sheet_figure([EndsPanel(one, 4)]).axes
    low, high, ball, hits = ax.lines
    assert {low.get_color(), high.get_color()} == {COLOURS["R"]}
    assert low.get_linestyle() == high.get_linestyle() != "-"
    assert ball.get_color() == COLOURS["L"]
    assert np.array_equal(high.get_ydata() - low.get_ydata(), np.full(401, 2.0))
    assert np.array_equal(hits.get_xdata(), one.hit_t)


def test_a_single_run_marks_its_impacts_by_side():
    one = run()
    (ax,) = sheet_figure([PhasePlanePanel([one])]).axes
    *_, left, right = ax.lines
    assert (left.get_color(), right.get_color()) == (COLOURS["L"], COLOURS["R"])
    assert set(left.get_xdata()) == {1}
    assert np.array_equal(right.get_ydata(), one.hit_w_dot[one.hit_side < 0])


def test_stops_are_grey_and_bodies_have_their_names():
    one = replace(run(), stops=np.array([[0.5, 0.75], [2.5, 2.75]]), body="mass", ends="barriers")
    figure = sheet_figure([EndsPanel(one, 4), GapPanel(one, 4), PhasePlanePanel([one])], columns=3)
    for ax, values in zip(figure.axes, (one.x2, one.w), strict=False):
        first, _ = (line for line in ax.lines if line.get_color() == COLOURS["stop"])
        there = (one.t >= 0.5) & (one.t <= 0.75)
        assert np.array_equal(first.get_xdata(), one.t[there])
        assert np.array_equal(first.get_ydata(), values[there])
    (mark,) = (line for line in figure.axes[2].lines if line.get_marker() == "s")
    assert mark.get_xdata() == pytest.approx(np.sin(2 * np.pi * one.stops[:, 0]))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:4] == [r"barriers $x_1 \pm 1$", "mass $x_2$", "impact", "stop in mid-cavity"]


def test_where_there_are_no_walls_none_are_drawn():
    one = replace(run(), body="mass", ends="barriers", walls=False, w=2.0 * run().w)
    ends = EndsPanel(one, 3).entries()
    assert [text for text, _ in ends][:2] == ["oscillator $x_1$", "mass $x_2$"]
    figure = sheet_figure([EndsPanel(one, 3), GapPanel(one, 3), PhasePlanePanel([one])])
    assert figure.axes[0].lines[0].get_ydata() == pytest.approx(one.x1)
    assert [len(ax.lines) for ax in figure.axes[1:]] == [2, 3]
    assert figure.axes[2].get_xlim()[1] > one.w.max()


def test_runs_that_share_a_plane_are_told_apart_in_it():
    figure = sheet_figure([PhasePlanePanel([run("one"), run("two")])])
    (ax,) = figure.axes
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["one", "two"]
    assert not figure.legends
    colours = [line.get_color() for line in ax.lines[-2:]]
    assert colours[0] == COLOURS["R"] != colours[1]


@pytest.mark.parametrize(("columns", "rows"), [(1, 3), (2, 2), (3, 1)])
def test_a_grid_that_is_not_full_leaves_the_rest_empty(columns, rows):
    one = run()
    figure = sheet_figure([GapPanel(one, 3, title=str(k)) for k in range(3)], columns=columns)
    drawn = [ax for ax in figure.axes if ax.axison]
    assert len(figure.axes) == rows * columns
    assert [ax.get_title() for ax in drawn] == ["0", "1", "2"]


def test_sheets_are_the_same_bytes_each_time(tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        save(sheet_figure([EndsPanel(run(), 3), PhasePlanePanel([run()])], columns=2), tmp_path / name)
    for suffix in ("png", "svg"):
        one, two = ((tmp_path / n / f"picture.{suffix}").read_bytes() for n in ("one", "two"))
        assert one == two
