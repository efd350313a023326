"""Figures of energy measures: panels, letters, labels, what is drawn where, bytes that repeat."""

import numpy as np

from vines.figures import PALETTE, EnergyCurve, EnergyPanel, VelocityPanel, response_figure, save


def curve(label="$A = 0.1$", colour="red", found=None):
    x = np.linspace(0.1, 1.0, 10)
    kinds = np.zeros(10, dtype=int) if found is None else np.array(found)
    return EnergyCurve(x, 3 * x, 1 / x, 0.1 / x, kinds, x, np.full(10, 10.0), 0.5 / x, label, colour)


def test_letters_labels_strips_and_ranges():
    energy = EnergyPanel("mu", [curve(), curve("$A = 0.3$", "blue")], "$r = 0.3$", y=(0, 4))
    velocity = VelocityPanel("Omega", np.ones(4), np.array([-1.0, 1, 2, -2]), np.array([-1, 1, 1, -1]), np.zeros(4))
    alone = EnergyPanel("Omega", [curve("", "orange")], ratio=False, window=(0.2, 0.8))
    figure = response_figure([energy, velocity, alone], columns=2, caption="$\\Omega = 1$")
    first, strip, dots, last, _ = figure.axes
    assert [ax.get_title(loc="left") for ax in (first, dots, last)] == ["(a)  $r = 0.3$", "(b)", "(c)"]
    assert first.get_ylabel() == r"$K_2/K_1$,  $\max|x_1|$"
    assert (strip.get_ylabel(), strip.get_yscale()) == ("reduction", "log")
    assert strip.get_xlabel() == r"mass ratio  $\mu$"
    assert last.get_ylabel() == r"$\max|x_1|$"
    assert first.get_ylim() == (0, 4)
    assert last.get_xlim() == (0.2, 0.8)
    assert figure.get_suptitle() == "$\\Omega = 1$"
    assert [text.get_text() for text in first.get_legend().get_texts()] == ["$A = 0.1$", "$A = 0.3$"]
    assert last.get_legend() is None
    # the last axis shows nearly all of max|x1| where its window lies
    assert 1 / 0.2 * 0.9 < last.get_ylim()[1] < 1 / 0.2 * 1.2
    assert {line.get_color() for line in dots.lines if line.get_marker() == "."} <= {
        "#c8102e",
        "#0b4ea2",
        "#ef8a97",
        "#85b0e6",
    }


def test_each_attractor_has_the_mark_of_how_it_was_found():
    found = [0] * 7 + [1, 2, 2]
    figure = response_figure([EnergyPanel("mu", [curve(found=found)])], columns=1)
    ax = figure.axes[0]
    counts = {}
    for line in ax.lines:
        if line.get_linestyle() == "None":
            counts[line.get_marker(), line.get_markerfacecolor() == "white"] = counts.get(
                (line.get_marker(), line.get_markerfacecolor() == "white"), 0
            ) + len(line.get_xdata())
    assert counts["D", False] == 9
    assert counts["D", True] == 1
    assert (counts["x", False], counts["+", False], counts["1", False]) == (7, 1, 2)
    (legend,) = figure.legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said == [
        r"$K_2/K_1$ and $\max|x_1|$: upward sweep",
        "another attractor, downwards",
        "another, from random starts",
        "with no ball",
        "with the ball locked",
    ]


def test_yardsticks_are_in_every_energy_panel():
    figure = response_figure([EnergyPanel("mu", [curve()])], columns=1)
    ax, strip = figure.axes
    lines = [line for line in ax.lines if line.get_linestyle() != "None"]
    assert [list(line.get_ydata()) for line in lines] == [[10.0] * 10, list(0.5 / np.linspace(0.1, 1.0, 10))]
    assert {line.get_color() for line in lines} == {PALETTE["red"]}
    ratio = [line for line in strip.lines if line.get_linestyle() == "-"]
    np.testing.assert_allclose(ratio[0].get_ydata(), 0.05 / np.linspace(0.1, 1.0, 10))
    marks = [line for line in strip.lines if line.get_linestyle() == "None" and len(line.get_xdata())]
    np.testing.assert_allclose(marks[0].get_ydata(), 0.1 / np.linspace(0.1, 1.0, 10))


def test_files_are_the_same_bytes_each_time(tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        save(response_figure([EnergyPanel("mu", [curve()])], columns=1), tmp_path / name)
    for suffix in ("png", "svg"):
        one, two = ((tmp_path / n / f"picture.{suffix}").read_bytes() for n in ("one", "two"))
        assert one == two
