"""Energy measures against a parameter: K2/K1 as diamonds, max|x1| as crosses, and what the absorber buys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._colours import COLOURS, PALETTE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["FOUND", "EnergyCurve", "EnergyPanel", "draw_energy", "draw_reduction", "frame", "lighter"]

Floats = npt.NDArray[np.float64]

FOUND = ("up", "down", "random")
"""How an attractor was found: by the sweep upwards, only by the one downwards, only from random starts."""

_BULK = 0.985
"""Share of the values of max|x1| that lies below the upper end of an axis where none is declared."""


@dataclass(frozen=True)
class EnergyCurve:
    """The attractors over one parameter, the others fixed; several at a value where they coexist.

    Attributes
    ----------
    x : (n,) array
        Value of the varied parameter.
    kinetic_ratio, max_abs_x1, reduction : (n,) array
        K2/K1, max|x1|, and max|x1| over that of the oscillator with no ball.
    found : (n,) array of int
        Place in :data:`FOUND`.
    at : (m,) array
        Values of the varied parameter for the yardsticks, ascending.
    no_ball, locked : (m,) array
        max|x1| of the oscillator with no ball, and with the ball locked to it.
    label : str
        What tells this curve from the others of its panel.
    colour : str
        One of :data:`PALETTE`.
    """

    x: Floats
    kinetic_ratio: Floats
    max_abs_x1: Floats
    reduction: Floats
    found: npt.NDArray[np.integer[Any]]
    at: Floats
    no_ball: Floats
    locked: Floats
    label: str
    colour: str


@dataclass(frozen=True)
class EnergyPanel:
    """Curves over one axis. With `ratio` K2/K1 is shown too; `y` is the part of the vertical axis shown.

    `body` is what the body in the oscillator is called.
    """

    axis: str
    curves: Sequence[EnergyCurve]
    caption: str = ""
    ratio: bool = True
    window: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    body: str = "ball"


def draw_energy(ax: Axes, panel: EnergyPanel) -> None:
    """Draw K2/K1 and max|x1| of every attractor, and the yardsticks as lines, on one vertical axis from 0."""
    for curve in panel.curves:
        colour = PALETTE[curve.colour]
        ax.plot(curve.at, curve.no_ball, color=colour, **NO_BALL)
        ax.plot(curve.at, curve.locked, color=colour, **LOCKED)
    for curve in panel.curves:
        for found in (2, 1, 0):
            mine = curve.found == found
            ax.plot(curve.x[mine], curve.max_abs_x1[mine], **cross(curve.colour, found))
            if panel.ratio:
                ax.plot(curve.x[mine], curve.kinetic_ratio[mine], **diamond(curve.colour, found))
    ax.set_ylim(*(panel.y or (0.0, _top(panel))))
    frame(ax, np.concatenate([curve.at for curve in panel.curves]), panel.window)
    handles: Any = [_swatch(curve) for curve in panel.curves]
    if any(curve.label for curve in panel.curves):
        ax.legend(handles=handles, loc="best", handlelength=0.9, labelspacing=0.3, borderaxespad=0.3)


def draw_reduction(ax: Axes, panel: EnergyPanel) -> None:
    """Draw max|x1| over that with no ball: below 1 the absorber helps, below the line more than a locked ball."""
    from matplotlib.ticker import LogLocator, NullFormatter

    ax.axhline(1.0, color=COLOURS["mark"], **NO_BALL)
    for curve in panel.curves:
        ax.plot(curve.at, curve.locked / curve.no_ball, color=PALETTE[curve.colour], **LOCKED)
    for curve in panel.curves:
        for found in (2, 1, 0):
            mine = curve.found == found
            ax.plot(curve.x[mine], curve.reduction[mine], **cross(curve.colour, found, size=1.8))
    ax.set_yscale("log")
    frame(ax, np.concatenate([curve.at for curve in panel.curves]), panel.window)
    shown = np.concatenate([c.reduction[_inside(c.x, panel.window)] for c in panel.curves] + [np.ones(1)])
    shown = shown[np.isfinite(shown) & (shown > 0)]
    low, high = 0.6 * shown.min(), max(1.7, 1.5 * float(np.quantile(shown, 0.995)))
    ax.set_ylim(low, high)
    # A strip is too low for a number at each line of its scale.
    ax.yaxis.set_major_locator(LogLocator(subs=(1.0,) if high > _DECADES * low else (0.5, 1.0, 2.0)))
    ax.yaxis.set_major_formatter("{x:g}")
    ax.yaxis.set_minor_formatter(NullFormatter())


_DECADES = 20.0
"""Factor between the ends of a strip beyond which only powers of ten have numbers."""
NO_BALL: Any = {"linestyle": (0, (5, 2.5)), "linewidth": 0.8, "zorder": 1}
LOCKED: Any = {"linestyle": "-", "linewidth": 0.8, "alpha": 0.75, "zorder": 1}


def diamond(colour: str, found: int, size: float = 2.6) -> dict[str, Any]:
    """Return the style of K2/K1: filled if found upwards, open if only downwards, light if only from random starts."""
    full, light = PALETTE[colour], lighter(colour)
    edge = 0.0 if found == 0 else 0.6
    return {
        "linestyle": "none",
        "marker": "D",
        "markersize": size if found == 0 else size + 0.6,
        "markerfacecolor": (full, "white", light)[found],
        "markeredgecolor": full,
        "markeredgewidth": edge,
        "zorder": 3 - 0.2 * found,
    }


def cross(colour: str, found: int, size: float = 2.8) -> dict[str, Any]:
    """Return the style of max|x1|: a cross if found upwards, upright if only downwards, three arms if from random."""
    return {
        "linestyle": "none",
        "marker": ("x", "+", "1")[found],
        "markersize": size if found == 0 else size + 1.2,
        "markeredgecolor": PALETTE[colour],
        "markeredgewidth": 0.6,
        "zorder": 2.3 - 0.2 * found,
    }


def lighter(colour: str) -> tuple[float, float, float]:
    """Return a colour of :data:`PALETTE` halfway to white.

    Examples
    --------
    >>> max(lighter("black")) < 0.6
    True
    """
    from matplotlib.colors import to_rgb

    r, g, b = to_rgb(PALETTE[colour])
    return (0.5 + r / 2, 0.5 + g / 2, 0.5 + b / 2)


def _swatch(curve: EnergyCurve) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], linestyle="none", marker="s", markersize=4.5, color=PALETTE[curve.colour], label=curve.label)


def frame(ax: Axes, x: Floats, window: tuple[float, float] | None) -> None:
    """Show the window, or all values with a margin."""
    if window is not None:
        ax.set_xlim(*window)
    elif len(x) and x.min() < x.max():
        margin = 0.01 * float(x.max() - x.min())
        ax.set_xlim(float(x.min()) - margin, float(x.max()) + margin)


def _top(panel: EnergyPanel) -> float:
    """Return an upper end that shows every K2/K1 and all but the rarest max|x1|."""
    ends = [1e-9]
    for curve in panel.curves:
        shown = _inside(curve.x, panel.window)
        ends.append(float(np.quantile(curve.max_abs_x1[shown], _BULK)))
        if panel.ratio:
            ends.append(float(curve.kinetic_ratio[shown].max()))
    return 1.1 * max(ends)


def _inside(x: Floats, window: tuple[float, float] | None) -> npt.NDArray[np.bool_]:
    return np.ones(len(x), dtype=bool) if window is None else (window[0] <= x) & (x <= window[1])
