"""Figures as files: those of a result, and the one that somebody asked for."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from vines.errors import DeclarationError, FileMissingError
from vines.figures._finish import finish
from vines.figures._style import FORMATS, look
from vines.figures._style_sheet import Told

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["save", "save_as"]


def save(
    figure: Figure,
    folder: Path,
    name: str = "picture",
    *,
    formats: Sequence[str] = ("png", "svg", "pdf"),
    dpi: int = 200,
) -> list[Path]:
    """Finish a figure and write it into a folder in some formats, without dates, and return the paths.

    Panels are laid out once, so all files show the same, and each file is drawn once. In a PDF text is text. Drawing is
    slow: a sheet of 12 panels has hundreds of ticks and texts, which matplotlib measures at every draw.

    Parameters
    ----------
    figure : matplotlib Figure
        As a plot drew it.
    folder : Path
        Where to.
    name : str
        What the files are called.
    formats : sequence of str
        Of png, svg, pdf.
    dpi : int
        Pixels per inch of a PNG, and of dense dots in the others.
    """
    import matplotlib as mpl

    files = [folder / f"{name}.{ending}" for ending in formats]
    with mpl.rc_context(look()):
        finish(figure)
        if figure.get_layout_engine() is not None:
            figure.set_layout_engine(None)  # "none" would keep a placeholder, for which each file is drawn twice
        for file in files:
            # Which takes a font apart for a PDF, and says that its date is odd.
            with Told("fontTools"):
                figure.savefig(file, dpi=dpi, metadata=FORMATS[file.suffix])
    return files


def save_as(figure: Figure, path: Path, *, dpi: int = 300) -> Path:
    """Write a figure into one file; text stays text in PDF and SVG. An existing file is replaced, as a whole.

    Parameters
    ----------
    figure : matplotlib Figure
        What is written.
    path : Path
        Where to; its ending, .pdf, .png or .svg, says the format.
    dpi : int
        Pixels per inch of a PNG, and of dense dots inside a PDF or SVG.

    Raises
    ------
    DeclarationError
        If there is no such format.
    FileMissingError
        If the folder does not exist.
    """
    import matplotlib as mpl

    ending = path.suffix.lower()
    if ending not in FORMATS:
        raise DeclarationError(
            f"{path}: a figure ends in {', '.join(sorted(FORMATS))}, such as {path.with_suffix('.pdf').name}"
        )
    if not path.absolute().parent.is_dir():
        raise FileMissingError(f"{path}: the folder {path.parent} does not exist; make it first")
    beside = path.with_name(f".{path.stem}-{os.getpid()}{ending}")
    try:
        with mpl.rc_context({**look(), "svg.fonttype": "none", "pdf.fonttype": 42}), Told("fontTools"):
            figure.savefig(beside, dpi=dpi, metadata=FORMATS[ending])
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
    return path
