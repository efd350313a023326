"""Charts of two parameters and multipliers along branches: axes, labels, styles."""

import numpy as np

from vines.figures import (
    CurveLine,
    MultiplierLines,
    Region,
    SpecialMark,
    chart_figure,
    multiplier_figure,
)

X = np.geomspace(0.004, 0.2, 30)


def chart(**options):
    curves = [
        CurveLine("fold", "1:1 symmetric", X, X / 2),
        CurveLine("grazing", "1:1 asymmetric", X, X / 4),
    ]
    region = Region(X, X / 2, X[:, None] > X[None, :], "stable here")
    return chart_figure(("A", "mu"), curves, [SpecialMark("resonance_1_1", 0.02, 0.01)], [region], **options)


def test_axes_legend_and_styles_of_a_chart():
    figure = chart(caption="r = 0.65")
    (ax,) = figure.axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("forcing amplitude  $A$", "mass ratio  $\\mu$")
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert ax.get_title(loc="left") == "r = 0.65"
    fold, grazing, special = ax.lines
    assert fold.get_linestyle() == "-"
    assert grazing.get_linestyle() == "--"
    assert fold.get_color() != grazing.get_color()
    assert special.get_marker() == "*"
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "stable here",
        "fold, 1:1 symmetric",
        "grazing, 1:1 asymmetric",
        "resonance 1:1",
    ]


def test_a_narrow_range_is_linear():
    line = CurveLine("fold", "1:1 symmetric", np.linspace(0.01, 0.02, 5), np.linspace(0.9, 1.1, 5))
    (ax,) = chart_figure(("A", "Omega"), [line], []).axes
    assert (ax.get_xscale(), ax.get_yscale()) == ("linear", "linear")


def test_multipliers_have_a_panel_a_branch_and_the_unit_circle():
    x = np.linspace(0.016, 0.02, 9)
    moduli = np.column_stack([x / 0.018, np.full_like(x, 0.9), np.full_like(x, 0.4), np.full_like(x, 0.3)])
    branches = [
        MultiplierLines(x, moduli, [("symmetry_breaking", 0.018)], "1:1 symmetric"),
        MultiplierLines(x, moduli, [("period_doubling", 0.03)], "1:1 asymmetric", "asymmetric"),
    ]
    figure = multiplier_figure("A", branches, window=(0.017, 0.02))
    first, second = figure.axes
    assert first.get_title(loc="left") == "(a)  1:1 symmetric"
    assert second.get_title(loc="left") == "(b)  1:1 asymmetric"
    assert first.get_ylabel().endswith(r"$|\lambda_i|$")
    assert 0.0165 < first.get_xlim()[0] < 0.0171
    assert any(list(line.get_ydata()) == [1.0, 1.0] for line in first.lines)
    (legend,) = figure.legends
    # What the window does not show is not explained.
    assert [text.get_text() for text in legend.get_texts()] == ["symmetry breaking (0.018)"]
