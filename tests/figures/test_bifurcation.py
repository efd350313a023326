"""The bifurcation figure: panels, labels, ranges, and bytes that repeat."""

import numpy as np
import pytest

from vines.errors import DeclarationError
from vines.figures import BranchLine, ImpactDots, Marker, bifurcation_figure, save


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
    assert labels == [
        "simulation, left end",
        "simulation, right end",
        "1:1 symmetric, stable",
        "1:1 symmetric, unstable",
        "symmetry breaking (0.018)",
    ]


def test_files_are_the_same_bytes_each_time(tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        save(drawing(), tmp_path / name)
    for suffix in ("png", "svg"):
        one, two = ((tmp_path / n / f"picture.{suffix}").read_bytes() for n in ("one", "two"))
        assert one == two


def test_unknown_panel_names_the_nearest():
    with pytest.raises(DeclarationError, match="'w_dot'"):
        drawing(panels=["w_dott"])
