"""Numbers on logarithmic axes that span little."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["plain_ticks"]


def plain_ticks(ax: Axes, along: Literal["x", "y"]) -> None:
    """Write numbers on a logarithmic axis as they are, several to a decade where it spans little; its limits are set.

    Examples
    --------
    >>> from vines.figures._style import new_figure
    >>> ax = new_figure(3.0, 2.0).subplots()
    >>> ax.set_xscale("log"), ax.set_xlim(0.012, 0.06)[1], plain_ticks(ax, "x")
    (None, 0.06, None)
    >>> [each.get_text() for each in ax.get_xticklabels()]
    ['0.02', '0.03', '0.04', '0.06']
    """
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

    low, high = getattr(ax, f"get_{along}lim")()
    axis = getattr(ax, f"{along}axis")
    tens = 10.0 ** np.arange(np.floor(np.log10(low)) - 1, np.ceil(np.log10(high)) + 1)
    steps = (1, 2, 3, 4, 6) if high < 40 * low else (1,)
    inside = [low * (1 - 1e-9) <= m * ten <= high * (1 + 1e-9) for ten in tens for m in steps]
    marks = np.array([m * ten for ten in tens for m in steps])
    axis.set_major_locator(FixedLocator(marks[inside].tolist()))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
