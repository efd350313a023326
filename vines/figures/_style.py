"""One look for all figures, and bytes that do not change from run to run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.figures._look import worn

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["FORMATS", "RC", "font", "look", "new_figure", "write_letter"]

RC: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.labelsize": 9.5,
    "axes.linewidth": 0.7,
    "axes.spines.top": True,
    "axes.spines.right": True,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.minor.visible": True,
    "ytick.minor.visible": True,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.3,
    "mathtext.fontset": "dejavusans",
    "savefig.dpi": 200,
    # Element ids of an SVG are hashes; a fixed salt and text as outlines make the bytes repeatable anywhere.
    "svg.hashsalt": "vines",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
}

FORMATS: dict[str, dict[str, Any]] = {
    ".png": {"Software": "vines"},
    ".svg": {"Creator": "vines", "Date": None},
    ".pdf": {"Creator": "vines", "CreationDate": None, "ModDate": None},
}
"""Endings of files, and what each says of its origin; without a date, so that a figure has the same bytes each time."""


def look() -> dict[Any, Any]:
    """Return matplotlib's settings for a figure: ours, and over them those of the look that is worn."""
    own = worn()
    settings = {**RC, **own.settings}
    if own.font_size is not None:
        factor = own.font_size / RC["font.size"]
        settings |= {name: factor * RC[name] for name in ("font.size", "axes.labelsize", "legend.fontsize")}
    return settings


def font(size: float) -> float:
    """Return the size of what is written [point], in the ratio to numbers that it has in our own look.

    Examples
    --------
    >>> font(8.5)
    8.5
    """
    return size * look()["font.size"] / RC["font.size"]


def write_letter(ax: Axes, letter: str) -> None:
    """Write the letter of a panel beside its numbers, however wide it is."""
    place = (font(-37.0), 0.0)
    ax.annotate(f"({letter})", (0.0, 1.0), place, "axes fraction", "offset points", va="top", weight="bold")


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of that size [inch], drawn without any screen."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with mpl.rc_context(look()):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
    return figure
