"""The plane of amplitude and frequency: where branches are stable, what was measured, what to measure next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import name_axis
from vines.figures._colours import COLOURS
from vines.figures._regimes import REGIME_CLASSES
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["PlaneMark", "StableBand", "rig_next_figure"]

Floats = npt.NDArray[np.float64]

_NARROW = 0.35
"""Half the width of a column beside which a branch has no like, in distances of columns."""


@dataclass(frozen=True, slots=True, eq=False)
class StableBand:
    """Where a branch is stable.

    Attributes
    ----------
    name : str
        As the legend calls it, one of the keys of `REGIME_CLASSES` by its regime.
    regime : str
        A key of `REGIME_CLASSES`: its colour.
    omega : ndarray, shape (n,)
        Columns, rising, next to each other.
    low, high : ndarray, shape (n,)
        Amplitudes between which it is stable.
    """

    name: str
    regime: str
    omega: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True)
class PlaneMark:
    """A suggestion: its number, where it is, and whether it is a jump."""

    number: int
    omega: float
    A: float
    jump: bool


def rig_next_figure(
    bands: Sequence[StableBand],
    measured: Floats,
    marks: Sequence[PlaneMark],
    *,
    window: tuple[tuple[float, float], tuple[float, float]],
    units: tuple[float, float],
    caption: str = "",
    width: float = 6.6,
) -> Figure:
    """Draw the plane.

    Parameters
    ----------
    bands : sequence of StableBand
        Where they overlap branches coexist.
    measured : ndarray, shape (runs, 2)
        A and Omega of the runs.
    marks : sequence of PlaneMark
    window : ((float, float), (float, float))
        Ranges of Omega and A.
    units : (float, float)
        f/Omega [Hz] and E/A [mm], for the outer axes.
    caption : str
    width : float
        Width of the figure [inch].
    """
    import matplotlib as mpl
    from matplotlib.colors import to_rgb
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    with mpl.rc_context(look()):
        figure = new_figure(width, 0.78 * width)
        ax = figure.add_subplot()
        step = (window[0][1] - window[0][0]) / 8
        entries: dict[str, Patch | Line2D] = {}
        for band in bands:
            omega, low, high = _wide(band, step)
            colour = REGIME_CLASSES[band.regime]
            # Of two families of one kind the one whose ends differ is hatched.
            n, _, m = band.name.partition("/")[0].partition(":")
            hatch = "////" if band.regime == "p > 1 periods" and n != m else ""
            drawn: Any = {"facecolor": (*to_rgb(colour), 0.55), "edgecolor": colour, "hatch": hatch, "linewidth": 0.8}
            ax.fill_between(omega, low, high, **drawn)
            entries.setdefault(band.name, Patch(**drawn))
        ink = COLOURS["ink"]
        dots: Any = {"marker": "o", "color": ink, "markeredgecolor": "white", "markersize": 4.5, "linestyle": ""}
        ax.plot(measured[:, 1], measured[:, 0], zorder=8, **dots)
        entries["measured"] = Line2D([], [], **dots)
        for mark in marks:
            colour = COLOURS["L"] if mark.jump else COLOURS["ink"]
            # A mark is small, with its number beside it: a run or a jump may lie in the same place.
            ax.plot(mark.omega, mark.A, "D" if mark.jump else "s", color=colour if mark.jump else "white",
                    markeredgecolor=colour, markersize=4.5 if mark.jump else 7, zorder=5 + mark.jump)  # fmt: skip
            ax.annotate(
                str(mark.number), (mark.omega, mark.A), (9, -4 if mark.jump else 5), textcoords="offset points",
                ha="center", va="center", fontsize=font(7.5), color=colour, zorder=9, weight="bold",
            )  # fmt: skip
        for name, jump in (("measure next", False), ("a jump is near", True)):
            if any(mark.jump == jump for mark in marks):
                entries[name] = Line2D(
                    [], [], marker="D" if jump else "s", color=COLOURS["L"] if jump else "white", linestyle="",
                    markersize=4.5 if jump else 7, markeredgecolor=COLOURS["L"] if jump else COLOURS["ink"],
                )  # fmt: skip
        ax.set_xlim(*window[0])
        ax.set_ylim(*window[1])
        name_axis(ax, "x", "Omega")
        name_axis(ax, "y", "A")
        top = ax.secondary_xaxis("top", functions=_scaled(units[0]))
        top.set_xlabel("$f$ [Hz]")
        right = ax.secondary_yaxis("right", functions=_scaled(units[1]))
        right.set_ylabel("$E$ [mm]")
        ax.tick_params(top=False, right=False, which="both")
        if caption:
            figure.suptitle(caption, fontsize=font(8.5))
        figure.legend(
            entries.values(), entries.keys(), loc="outside lower center", ncols=4, handlelength=1.4, columnspacing=1.2
        )
        return figure


def _scaled(unit: float) -> Any:
    """Return the functions from a number to its measure in a unit and back."""
    return lambda x: np.asarray(x) * unit, lambda x: np.asarray(x) / unit


def _wide(band: StableBand, step: float) -> tuple[Floats, Floats, Floats]:
    """Return the edges of a band; one in a single column is as wide as that."""
    if len(band.omega) > 1:
        return band.omega, band.low, band.high
    at = band.omega[0] + np.array([-_NARROW, _NARROW]) * step
    return at, np.repeat(band.low, 2), np.repeat(band.high, 2)
