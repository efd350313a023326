"""Several panels of different kinds on one sheet, lettered row by row, with one legend."""

from __future__ import annotations

from collections.abc import Sequence
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any, Literal, Protocol

from vines.figures._fit import columns_in
from vines.figures._legend import add_legend
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vines.figures._legend import Entry

__all__ = ["Panel", "sheet_figure"]


class Panel(Protocol):
    """Something that draws itself on axes and says what the legend tells of it."""

    def draw(self, ax: Axes) -> None:
        """Draw it, labels and limits included."""
        ...

    def entries(self) -> list[Entry]:
        """Return its entries of the legend."""
        ...


def sheet_figure(
    panels: Sequence[Panel],
    *,
    columns: int = 1,
    letters: Literal["panels", "rows"] = "panels",
    caption: str = "",
    width: float = 7.0,
    height: float = 2.4,
) -> Figure:
    """Draw panels on a grid.

    Parameters
    ----------
    panels : sequence of Panel
        Row by row; letters follow this order.
    columns : int
        Panels in a row; fewer where the figure is too narrow for them.
    letters : {"panels", "rows"}
        What is lettered; the rows are those of a figure that is wide enough.
    caption : str
        Written above everything.
    width : float
        Width of the figure [inch].
    height : float
        Height of a row [inch].
    """
    import matplotlib as mpl

    in_a_row, columns = columns, columns_in(width, columns)
    rows = -(-len(panels) // columns)
    with mpl.rc_context(look()):
        figure = new_figure(width, 0.85 + height * rows)
        grid = figure.subplots(rows, columns, squeeze=False)
        axes = grid.ravel()
        for panel, ax in zip(panels, axes, strict=False):
            panel.draw(ax)
            if ax.get_xscale() == "linear":
                ax.locator_params(axis="x", nbins=max(2, min(max(4, 11 - 2 * columns), round(1.7 * width / columns))))
        lettered = axes[: len(panels) : 1 if letters == "panels" else in_a_row]
        lettered = lettered if len(lettered) > 1 else ()
        for letter, ax in zip(ascii_lowercase, lettered, strict=False):
            ax.set_title(f"({letter})", fontsize=font(9), fontweight="bold", loc="left")
        for ax in axes[len(panels) :]:
            ax.set_axis_off()
        _share_labels(grid, len(panels))
        if caption:
            figure.suptitle(caption, fontsize=font(9))
        said = {label: drawn for panel in panels for label, drawn in panel.entries()}
        add_legend(figure, list(said.items()), ncols=max(2, int(width / 2.3)))
    return figure


def _share_labels(grid: Any, count: int) -> None:
    """Write a label along x once where all panels of a column have the same."""
    rows, columns = grid.shape
    for column in grid.T:
        if len({ax.get_xlabel() for ax in column}) == 1 and count == rows * columns:
            for ax in column[:-1]:
                ax.set_xlabel("")
