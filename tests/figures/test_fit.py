"""What is written around panels fits the width, from 60 to 200 mm."""

import itertools

import numpy as np
import pytest
from matplotlib.text import Text
from matplotlib.ticker import LogFormatter

from vines.figures import BranchLine, ImpactDots, Look, Marker, bifurcation_figure, finish, wearing
from vines.figures._style import new_figure

LABELS = ("simulation", "1:1 symmetric", "1:1 asymmetric, the branch that a broken symmetry begins", "2:1")
CAPTION = r"$\mu = 0.01$,  $\Omega = 1$,  $r = 0.65$,  $\lambda = 0.012$,  and a word of what the study is about"


def drawn(width, look=None):
    with wearing(look or Look()):
        return laid_out(width)


def laid_out(width):
    x = np.linspace(0.0201, 0.0219, 40)
    values = {"w_dot": 0.2 + x, "dt": np.full_like(x, 0.5), "x1": x, "phase": x}
    dots = ImpactDots(
        x=np.repeat(x, 2), side=np.tile([1, -1], 40), values={k: np.repeat(v, 2) for k, v in values.items()}
    )
    lines = [
        BranchLine(x=x, side=side, stable=x < 0.021, values=values, label=label, family=family)
        for label, family in zip(LABELS[1:], ("symmetric", "asymmetric", "unequal"), strict=True)
        for side in (1, -1)
    ]
    marker = Marker("symmetry_breaking", 0.021, {k: np.array([0.2, 0.2]) for k in values})
    figure = bifurcation_figure("A", [dots], lines, [marker], caption=CAPTION, width=width / 25.4)
    finish(figure)
    figure.draw_without_rendering()
    return figure


def boxes(figure):
    """Return what is written, numbers of an axis only where it reaches, each with its box."""
    numbers, shown = set(), []
    for ax in figure.axes:
        for axis, (low, high), k in ((ax.xaxis, sorted(ax.get_xlim()), 0), (ax.yaxis, sorted(ax.get_ylim()), 1)):
            ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
            numbers |= {id(label) for tick in ticks for label in (tick.label1, tick.label2)}
            shown += [tick.label1 for tick in ticks if low <= tick.label1.get_position()[k] <= high]
    texts = [each for each in figure.findobj(Text) if id(each) not in numbers] + shown
    renderer = figure.canvas.get_renderer()
    texts = [each for each in texts if each.get_visible() and each.get_text().strip()]
    return [(each.get_text(), each.get_window_extent(renderer)) for each in texts]


LOOKS = {
    "ours": Look(),
    "above": Look(legend="above"),
    "right": Look(legend="right"),
    "large": Look(font_size=12.0),
    "low": Look(height=5.2),
}


@pytest.mark.parametrize(
    ("width", "look"),
    [*((width, "ours") for width in (60, 85, 120, 200)), *((85, name) for name in LOOKS if name != "ours")],
)
def test_nothing_is_cut_off_and_nothing_lies_on_another(width, look):
    figure = drawn(width, LOOKS[look])
    told = boxes(figure)
    assert len(told) > 20
    for text, box in told:
        assert box.x0 >= -1, text
        assert box.x1 <= figure.bbox.width + 1, text
        assert box.y0 >= -1, text
        assert box.y1 <= figure.bbox.height + 1, text
    for (one, a), (other, b) in itertools.combinations(told, 2):
        assert not (a.x0 < b.x1 - 1 and b.x0 < a.x1 - 1 and a.y0 < b.y1 - 1 and b.y0 < a.y1 - 1), (one, other)


def test_a_narrow_figure_keeps_the_size_of_its_panels():
    narrow, wide = (drawn(width) for width in (60, 180))
    heights = [[ax.bbox.height / figure.dpi for ax in figure.axes] for figure in (narrow, wide)]
    assert heights[0] == pytest.approx(heights[1], rel=0.25)


def test_every_entry_of_the_legend_is_there_at_every_width():
    for width in (60, 180):
        (legend,) = drawn(width).legends
        said = [" ".join(each.get_text().split()) for each in legend.get_texts()]
        assert [each for each in said if each in LABELS] == list(LABELS)


def test_a_title_in_the_middle_keeps_away_from_the_letter():
    with wearing(Look()):
        figure = new_figure(180 / 25.4, 2.0)
        for ax in figure.subplots(1, 3):
            ax.set_title("(h)", loc="left", fontsize=9)
            ax.set_title("1:1/2T, by definition 2:2/2T", fontsize=9)
        finish(figure)
    figure.draw_without_rendering()
    for ax in figure.axes:
        letter, title = (each.get_window_extent() for each in (ax._left_title, ax.title))
        assert letter.x1 < title.x0
        assert " ".join(ax.title.get_text().split()) == "1:1/2T, by definition 2:2/2T"


def test_the_legend_of_a_panel_covers_no_curve_where_there_is_room_anywhere():
    """In all nine places that matplotlib tries it would."""
    with wearing(Look()):
        figure = new_figure(60 / 25.4, 2.2)
        ax = figure.add_subplot()
        angle = np.linspace(0, 2 * np.pi, 400)
        for size in (1.0, 0.93):
            ax.plot(size * np.cos(angle), size * np.sin(angle), label=f"A = {size}")
        ax.plot([-1, 0.2], [0.5, 0.3], color="black")
        ax.plot([-1, 1], [-0.62, -0.62], color="black")
        ax.plot([0.2, 0.2], [0.3, 1.0], color="black")
        ax.legend(loc="best")
        finish(figure)
    figure.draw_without_rendering()
    box = ax.get_legend().get_window_extent()
    for line in ax.lines:
        at = ax.transData.transform(np.column_stack(line.get_data()))
        assert not ((at > box.min) & (at < box.max)).all(axis=1).any()


@pytest.mark.parametrize(("width", "written"), [(120, {"0.02", "0.03", "0.04", "0.06"}), (52, {"0.02"})])
def test_numbers_of_a_logarithmic_axis_do_not_touch(width, written):
    with wearing(Look()):
        figure = new_figure(width / 25.4, 2.0)
        ax = figure.add_subplot(xscale="log", xlim=(0.011, 0.066))
        ax.set_ylim(0, 1)
        ax.xaxis.set_minor_formatter(LogFormatter(minor_thresholds=(2, 0.4)))
        finish(figure)
    figure.draw_without_rendering()
    shown = [(each.get_text(), each.get_window_extent()) for each in ax.get_xticklabels(which="both")]
    shown = sorted(((text, box) for text, box in shown if text.strip()), key=lambda each: each[1].x0)
    assert all(one.x1 < other.x0 for (_, one), (_, other) in itertools.pairwise(shown))
    assert len(shown) >= len(written) - 1
