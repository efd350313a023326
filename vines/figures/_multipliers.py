"""Moduli of Floquet multipliers along branches, as in the paper's Fig. 4(c) and (f)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import SHOWN, name_axis
from vines.figures._colours import COLOURS, FAMILIES
from vines.figures._fit import columns_in
from vines.figures._legend import add_legend, mark_entries
from vines.figures._marks import mark_style
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vines.figures._legend import Entry

__all__ = ["MultiplierLines", "MultiplierPanel", "multiplier_figure"]

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


@dataclass(frozen=True)
class MultiplierPanel:
    """The moduli along a branch over the varied parameter, with the line 1 and the bifurcations on it.

    `names` is what is written beside the bifurcations of a type.
    """

    axis: str
    branch: MultiplierLines
    window: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    title: str = ""
    names: Mapping[str, str] = field(default_factory=dict)

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        branch, inside = self.branch, self._inside()
        left, right = FAMILIES[branch.family]
        pairs = (left, right, COLOURS["ink"], COLOURS["mark"])
        for k in range(branch.moduli.shape[1]):
            colour = pairs[k // 2 % len(pairs)]
            values = np.where(inside, branch.moduli[:, k], np.nan)
            ax.plot(branch.x, values, color=colour, linewidth=1.3, linestyle="-" if k % 2 == 0 else (0, (4, 2)))
        ax.axhline(1.0, color=COLOURS["R"], linewidth=0.8)
        for kind, place in self._marks():
            ax.axvline(place, color=COLOURS["mark"], linewidth=0.6, linestyle=":")
            ax.plot([place], [1.0], linestyle="none", zorder=3, **mark_style(kind))
            if kind in self.names:
                at = {"xytext": (-4, 6), "textcoords": "offset points", "ha": "right"}
                ax.annotate(self.names[kind], (place, 1.0), fontsize=font(9), **at)
        x = branch.x[inside]
        if len(x):
            pad = 0.02 * float(np.ptp(x))
            ax.set_xlim(self.window or (float(x.min()) - pad, float(x.max()) + pad))
            ax.set_ylim(0, min(_HIGHEST, 1.08 * float(branch.moduli[inside].max())))
        if self.y is not None:
            ax.set_ylim(*self.y)
        ax.locator_params(axis="x", nbins=5)
        name_axis(ax, "x", self.axis)
        name_axis(ax, "y", "multipliers", SHOWN["multipliers"])
        if self.title:
            ax.set_title(self.title, fontsize=font(8.5))

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        return mark_entries(self._marks(), self.names)

    def _inside(self) -> npt.NDArray[np.bool_]:
        x = self.branch.x
        low, high = (min(self.window), max(self.window)) if self.window is not None else (x.min(), x.max())
        return (low <= x) & (x <= high)

    def _marks(self) -> list[tuple[str, float]]:
        x = self.branch.x[self._inside()]
        return [(kind, place) for kind, place in self.branch.marks if len(x) and x.min() <= place <= x.max()]


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

    with mpl.rc_context(look()):
        columns = columns_in(width, len(branches))
        rows = -(-len(branches) // columns)
        figure = new_figure(width, 0.9 + 2.5 * rows)
        grid = figure.subplots(rows, columns, squeeze=False)
        axes = grid.ravel()
        said: dict[str, tuple[Any, ...]] = {}
        for letter, branch, ax in zip("abcdefgh", branches, axes, strict=False):
            panel = MultiplierPanel(axis, branch, window)
            panel.draw(ax)
            said |= dict(panel.entries())
            ax.set_title(f"({letter})  {branch.label}", fontsize=font(9), loc="left")
        for ax in grid[:, 1:].flat:
            ax.set_ylabel("")
        for ax in axes[len(branches) :]:
            ax.set_axis_off()
        if caption:
            figure.suptitle(caption, fontsize=font(8.5))
        add_legend(figure, list(said.items()))
    return figure
