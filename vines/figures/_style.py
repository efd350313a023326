"""One look for all figures, and bytes that do not change from run to run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.figures._fit import fit_titles

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "BALLS",
    "COLOURS",
    "FAMILIES",
    "FORMATS",
    "LETTER",
    "PALETTE",
    "RC",
    "look",
    "new_figure",
    "save",
    "wearing",
]

COLOURS = {
    "L": "#c8102e",
    "R": "#0b4ea2",
    "L light": "#ef8a97",
    "R light": "#85b0e6",
    "ink": "#222222",
    "mark": "#555555",
}
"""As in the paper: impacts on the left end red, on the right end blue; light for simulated dots, full for branches."""

FAMILIES = {
    "symmetric": ("#c8102e", "#0b4ea2"),
    "asymmetric": ("#d0118f", "#0aa0bd"),
    "doubled": ("#7a2bbf", "#0b7d6b"),
    "doubled again": ("#a98bd0", "#6cb8aa"),
    "unequal": ("#e87800", "#2c962c"),
}
"""Colours of branches on L and R: symmetric, asymmetric and unequal (2:1) ones as in the paper's Figs 4 and 5."""

BALLS = ("#e87800", "#2c962c", "#7a2bbf", "#0aa0bd", "#d0118f", "#8a6d3b", "#555555", "#a39a00")
"""Colours of balls with numbers, unlike those of the ends; the end of an impact is then its shape."""

PALETTE = {
    "red": "#c8102e",
    "green": "#2c962c",
    "blue": "#0b4ea2",
    "black": "#222222",
    "orange": "#e87800",
    "magenta": "#d0118f",
    "cyan": "#0aa0bd",
}
"""Colours that declarations name."""

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

LETTER = (-37.0, 0.0)
"""Where the letter of a panel stands from its upper left corner [points]: beside its numbers, however wide it is."""

_WORN: ContextVar[Mapping[str, Any]] = ContextVar("_WORN", default={})  # noqa: B039 - nobody changes it


def look() -> dict[Any, Any]:
    """Return matplotlib's settings for a figure: ours, and over them those of a style that is worn."""
    return {**RC, **_WORN.get()}


@contextmanager
def wearing(settings: Mapping[str, Any]) -> Iterator[None]:
    """Draw with settings of matplotlib over ours, as a style sheet gives them."""
    token = _WORN.set(settings)
    try:
        yield
    finally:
        _WORN.reset(token)


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of that size [inch], drawn without any screen."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with mpl.rc_context(look()):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
    return figure


def save(figure: Figure, folder: Path, name: str = "picture") -> list[Path]:
    """Write a figure as PNG, SVG and PDF into a folder, without dates, and return the paths.

    Panels are laid out once, so all files show the same, and each file is drawn once. In a PDF text is text. Drawing is
    slow: a sheet of 12 panels has hundreds of ticks and texts, which matplotlib measures at every draw.
    """
    import matplotlib as mpl

    files = [folder / f"{name}{ending}" for ending in FORMATS]
    with mpl.rc_context(RC):
        engine = figure.get_layout_engine()
        if engine is not None:
            if fit_titles(figure):
                engine.execute(figure)
            figure.set_layout_engine(None)  # "none" would keep a placeholder, for which each file is drawn twice
        for file in files:
            figure.savefig(file, metadata=FORMATS[file.suffix])
    return files
