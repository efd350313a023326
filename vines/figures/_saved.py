"""A figure as the file that somebody asked for."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from vines.errors import DeclarationError, FileMissingError
from vines.figures._style import FORMATS, look

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["save_as"]


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
        with mpl.rc_context({**look(), "svg.fonttype": "none", "pdf.fonttype": 42}):
            figure.savefig(beside, dpi=dpi, metadata=FORMATS[ending])
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
    return path
