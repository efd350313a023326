"""Moduli of Floquet multipliers along branches, as in the paper's Fig. 4(c) and (f)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from vines.figures._legend import add_legend
from vines.figures._marks import MARKS, mark_style
from vines.figures._names import NAMES, SYMBOLS
from vines.figures._style import COLOURS, FAMILIES, RC, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["MultiplierLines", "multiplier_figure"]

Floats = npt.NDArray[np.float64]

_HIGHEST = 2.5
"""Largest modulus shown: next to a grazing one grows without bound."""


@dataclass(frozen=True)
class MultiplierLines:
    """Moduli of the multipliers along one branch.

    Attributes
    ----------
    x : (n,) array
        Value of the varied parameter along the branch.
    moduli : (n, 4) array
        In each row the largest first.
    marks : sequence of (str, float)
        Type and place of the bifurcations and events on the branch.
    label : str
        Such as ``"1:1 symmetric"``.
    family : str
        One of :data:`FAMILIES`, for the colour.
    """

    x: Floats
    moduli: Floats
    marks: Sequence[tuple[str, float]]
    label: str
    family: str = "symmetric"


def multiplier_figure(
    axis: str,
    branches: Sequence[MultiplierLines],
    *,
    caption: str = "",
    width: float = 7.0,
    window: tuple[float, float] | None = None,
) -> Figure:
    """Draw the moduli, a panel a branch side by side, with the unit circle as a line.

    Parameters
    ----------
    axis : str
        The varied parameter.
    branches : sequence of MultiplierLines
    caption : str
        The fixed parameters, written above.
    width : float
        Width of the figure [inch].
    window : (float, float), optional
        The part of the varied parameter that is shown.
    """
    import matplotlib as mpl
    from matplotlib.lines import Line2D

    with mpl.rc_context(RC):
        figure = new_figure(width, 3.4)
        axes = figure.subplots(1, len(branches), squeeze=False)[0]
        kinds: dict[str, None] = {}
        for letter, branch, ax in zip("abcdefgh", branches, axes, strict=False):
            kinds |= dict.fromkeys(_panel(ax, branch, window))
            ax.set_xlabel(f"{NAMES.get(axis, axis)}  ${SYMBOLS.get(axis, axis)}$")
            ax.set_title(f"({letter})  {branch.label}", fontsize=9, loc="left")
        axes[0].set_ylabel(r"moduli of the multipliers  $|\lambda_i|$")
        if caption:
            figure.suptitle(caption, fontsize=8.5)
        entries = [
            (MARKS.get(kind, ("x", kind))[1], (Line2D([], [], linestyle="none", **mark_style(kind)),)) for kind in kinds
        ]
        add_legend(figure, entries)
    return figure


def _panel(ax: Axes, branch: MultiplierLines, window: tuple[float, float] | None) -> list[str]:
    """Draw one branch and return the types that are marked."""
    low, high = (min(window), max(window)) if window is not None else (float(branch.x.min()), float(branch.x.max()))
    inside = (low <= branch.x) & (branch.x <= high)
    left, right = FAMILIES[branch.family]
    for k, colour in enumerate((left, left, right, right)):
        values = np.where(inside, branch.moduli[:, k], np.nan)
        ax.plot(branch.x, values, color=colour, linewidth=1.3, linestyle="-" if k % 2 == 0 else (0, (4, 2)))
    ax.axhline(1.0, color=COLOURS["mark"], linewidth=0.8)
    x = branch.x[inside]
    shown = [(kind, place) for kind, place in branch.marks if len(x) and x.min() <= place <= x.max()]
    for kind, place in shown:
        ax.axvline(place, color=COLOURS["mark"], linewidth=0.6, linestyle=":")
        ax.plot([place], [1.0], linestyle="none", zorder=3, **mark_style(kind))
    if len(x):
        pad = 0.02 * float(np.ptp(x))
        ax.set_xlim(float(x.min()) - pad, float(x.max()) + pad)
        ax.set_ylim(0, min(_HIGHEST, 1.08 * float(branch.moduli[inside].max())))
    ax.locator_params(axis="x", nbins=5)
    return [kind for kind, _ in shown]
