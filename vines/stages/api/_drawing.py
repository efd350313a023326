"""Figures that are drawn anew from what is stored: to be changed in Python, or written to a file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import UnknownNameError, nearest
from vines.pipeline import file_of, stored_inputs
from vines.stages.api._home import Home, current
from vines.stages.api._parts import load_pipeline
from vines.stages.plots import inches, plot_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Pipeline

__all__ = ["figure", "save_figure"]


def figure(
    name: str,
    *,
    width: float | str | None = None,
    style: str | Path | None = None,
    overrides: Mapping[str, Any] | None = None,
    study: Home | None = None,
) -> Figure:
    """Draw a figure of a pipeline from the results that are stored.

    Parameters
    ----------
    name : str
        ``<pipeline>.<stage>``, or the pipeline alone if it has one figure.
    width : float or str, optional
        Inches, or a text such as ``"85mm"``; as declared if left out. What is written around the panels is fitted to
        it.
    style : str or Path, optional
        A style sheet of matplotlib, ``.mplstyle``, or the name of one, over the look of vines.
    overrides : mapping, optional
        Values by dotted key that replace those of the file, such as ``{"stages.response.title": ""}``.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    matplotlib.figure.Figure
        One that may be changed, and saved by its `savefig`.

    Raises
    ------
    UnknownNameError
        If there is no such pipeline, or no such figure in it.
    DeclarationError
        If a value is not allowed.
    FileMissingError
        If there is no such style sheet.
    StoreError
        If a stage that is drawn is not computed as it is declared now.
    """
    study = study or current()
    pipeline, stage = _asked(name, width, overrides, study)
    with _worn(pipeline, stage, style):
        return _drawn(pipeline, stage, study)


def save_figure(
    name: str,
    out: Path | None = None,
    *,
    width: float | str | None = None,
    dpi: int | None = None,
    style: str | Path | None = None,
    overrides: Mapping[str, Any] | None = None,
    study: Home | None = None,
) -> Path:
    """Draw a figure as :func:`figure` does, write it, and return the file.

    Parameters
    ----------
    name : str
        ``<pipeline>.<stage>``, or the pipeline alone if it has one figure.
    out : Path, optional
        The file, .pdf, .png or .svg; ``<pipeline>.<stage>.pdf`` in the current folder if left out.
    width, style, overrides, study : optional
        As for :func:`figure`.
    dpi : int, optional
        Pixels per inch of a PNG; those declared, and 300 at least, if left out.

    Raises
    ------
    VinesError
        As :func:`figure`, and if there is no such format or folder.
    """
    from vines.figures import save_as

    study = study or current()
    pipeline, stage = _asked(name, width, overrides, study)
    path = Path(f"{pipeline.name}.{stage}.pdf") if out is None else out
    declared: Any = pipeline.stages[stage].options
    resolution = dpi or max(declared.worn.dpi, _PRINTED)
    with _worn(pipeline, stage, style):
        return save_as(_drawn(pipeline, stage, study), path, dpi=resolution)


_PRINTED = 300
"""Pixels per inch of a figure for a paper where nothing is said."""


def _worn(pipeline: Pipeline, stage: str, style: str | Path | None) -> AbstractContextManager[None]:
    """Return the context in which a figure has its look, and a style."""
    from vines.figures import style_settings
    from vines.stages.plots import worn_by

    options: Any = pipeline.stages[stage].options
    return worn_by(options.worn, None if style is None else style_settings(style))


def _drawn(pipeline: Pipeline, stage: str, study: Home) -> Figure:
    """Draw a figure and fit what is written around its panels to its width."""
    from vines.figures import finish

    options: Any = pipeline.stages[stage].options
    return finish(plot_of(options).draw(stored_inputs(pipeline, stage, study.store), options))


def _asked(
    name: str, width: float | str | None, overrides: Mapping[str, Any] | None, study: Home
) -> tuple[Pipeline, str]:
    """Return the pipeline, with the values that replace some of its file, and the name of the figure."""
    known = file_of(name, study.root) is not None or Path(name).suffix == ".toml"
    of, _, stage = (name, "", "") if known else name.partition(".")
    given = dict(overrides or {})
    pipeline = load_pipeline(of, given, study=study)
    figures = [each.name for each in pipeline.stages.values() if each.kind.pictures]
    if not stage:
        if len(figures) != 1:
            all_of_them = ", ".join(f"{pipeline.name}.{each}" for each in figures) or "none is declared"
            raise UnknownNameError(f"{pipeline.name} has {len(figures)} figures; name one: {all_of_them}")
        stage = figures[0]
    if stage not in figures:
        raise UnknownNameError(f"{pipeline.name} has no figure {stage!r}: {nearest(stage, figures)}")
    if width is not None:
        number = re.fullmatch(r"\d*\.?\d+", width) if isinstance(width, str) else None
        inches(float(width) if number else width)
        pipeline = load_pipeline(of, {**given, f"stages.{stage}.width": width}, study=study)
    return pipeline, stage
