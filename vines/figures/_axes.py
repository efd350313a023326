"""What axes show, by name: their labels, and the parts of them that are shown, as the look of a figure has them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal
from weakref import WeakKeyDictionary

from vines.figures._look import worn
from vines.figures._names import NAMES, PANELS, QUANTITIES, SYMBOLS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["SHOWN", "called", "name_axis", "shown_by"]

SHOWN = {
    "w": r"gap  $w$",
    "w_dot": r"relative velocity  $\dot w$",
    "t": r"time  $t/T$",
    "ends": r"$x_1 \pm 1,\ x_2$",
    "gap": r"$w,\ \dot w$",
    "energy": r"$K_2/K_1$,  $\max|x_1|$",
    "multipliers": r"moduli of the multipliers  $|\lambda_i|$",
    "share": "share of impacts",
    "temperature": "temperature  [°C]",
    "residual": r"residual of the fit  [$\mu$m]",
    "width": "width of the range",
    "factor": "least worst measure",
    "T_exit": "forcing periods",
    "held": "share of runs that hold",
    "mean_exit": r"mean time to an exit  $[T]$",
    "held_share": "share",
    "x1": "$x_1$ at the start",
    "v1": r"$\dot x_1$ at the start",
    "x2": "$x_2$ at the start",
    "v2": r"$\dot x_2$ at the start",
}
"""What axes can show beside parameters, quantities of impacts and columns, by the names that a look has for them."""

_NAMED: WeakKeyDictionary[Axes, dict[str, str]] = WeakKeyDictionary()


def called(name: str) -> str:
    """Return what is written at an axis that shows a parameter or a quantity.

    Examples
    --------
    >>> called("A"), called("rms_x1")
    ('forcing amplitude  $A$', 'root mean square of $x_1$')
    """
    if name in NAMES:
        return f"{NAMES[name]}  ${SYMBOLS[name]}$"
    return {**SHOWN, **PANELS, **QUANTITIES}.get(name, name)


def name_axis(ax: Axes, along: Literal["x", "y"], name: str, text: str | None = None, *, written: bool = True) -> None:
    """Say what an axis shows, and write it there.

    Parameters
    ----------
    ax : matplotlib Axes
        The panel.
    along : {"x", "y"}
        Which of its axes.
    name : str
        What it shows; the look may have another label for it, and limits.
    text : str, optional
        The label; that of :func:`called` if left out.
    written : bool
        Whether the label is written: beside others that show the same it need not be.
    """
    _NAMED.setdefault(ax, {})[along] = name
    if written:
        getattr(ax, f"set_{along}label")(worn().labels.get(name, called(name) if text is None else text))


def shown_by(ax: Axes) -> dict[str, str]:
    """Return what the axes of a panel show, by ``"x"`` and ``"y"``; empty where nothing was said."""
    return _NAMED.get(ax, {})
