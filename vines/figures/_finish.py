"""What a figure gets when everything is drawn: limits, letters and size of its look, lines that fit its width."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any

from vines.errors import DeclarationError, nearest
from vines.figures._axes import shown_by
from vines.figures._fit import LETTER, fit_titles
from vines.figures._look import worn
from vines.figures._place import place_in_panels
from vines.figures._style import look, write_letter

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["finish"]

_LEAST = 0.35
"""Inches that a panel measures at least where a height is declared."""
_TOO_SMALL = (
    "panels, labels and legend do not fit the size of the figure: take a greater height or width, fewer columns, "
    'a smaller font_size, or legend = "none"'
)


def finish(figure: Figure) -> Figure:
    """Bring a figure to the look that is worn, lay it out, and return it.

    Parameters
    ----------
    figure : matplotlib Figure
        As a plot drew it, with constrained layout.

    Raises
    ------
    DeclarationError
        If the look names what no axis shows, a label is no text that can be set, or the panels do not fit the height.
    """
    own = worn()
    _check_names(figure)
    _limit(figure)
    if own.letters is not None:
        _letter(figure, wanted=own.letters)
    if own.legend == "none":
        for ax in figure.axes:
            if (legend := ax.get_legend()) is not None:
                legend.remove()
    import matplotlib as mpl

    engine = figure.get_layout_engine()
    with mpl.rc_context(look()), _clear():
        for ax in figure.axes:
            _keep_ticks(ax)
        if own.height is not None:
            figure.set_size_inches(figure.get_size_inches()[0], own.height)
        changed = fit_titles(figure)
        if own.height is not None:  # whatever lines were added
            figure.set_size_inches(figure.get_size_inches()[0], own.height)
        if engine is not None and (changed or own.height is not None):
            engine.execute(figure)
        panels = [ax.bbox for ax in figure.axes if shown_by(ax)]
        if own.height is not None and min(min(box.width, box.height) for box in panels) < _LEAST * figure.dpi:
            raise DeclarationError(_TOO_SMALL)
        place_in_panels(figure)
    return figure


@contextmanager
def _clear() -> Iterator[None]:
    """Say in a line of ours what matplotlib warns of, or cannot read, when it lays a figure out."""
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            yield
    except ValueError as error:
        raise DeclarationError(f"a text of the figure cannot be set: {str(error).strip().splitlines()[-1]}") from None
    if any("collapsed" in str(each.message) for each in told):
        raise DeclarationError(_TOO_SMALL)


def _keep_ticks(ax: Axes) -> None:
    """Give ticks that matplotlib makes later, as when somebody moves a limit, the look of those that are there."""
    import matplotlib as mpl

    rc: Any = mpl.rcParams
    for along in ("x", "y"):
        own = {name: rc[f"{along}tick.{name}"] for name in ("direction", "labelsize")}
        for which in ("major", "minor"):
            size, width, pad = (rc[f"{along}tick.{which}.{name}"] for name in ("size", "width", "pad"))
            ax.tick_params(axis=along, which=which, length=size, width=width, pad=pad, **own)


def _check_names(figure: Figure) -> None:
    """Refuse labels and limits of what no axis shows."""
    there = sorted({name for ax in figure.axes for name in shown_by(ax).values()})
    for what, names in (("labels", worn().labels), ("limits", worn().limits)):
        for name in names:
            if name not in there:
                raise DeclarationError(f"look.{what}.{name}: no axis of this figure shows it: {nearest(name, there)}")


def _limit(figure: Figure) -> None:
    limits = worn().limits
    for ax in figure.axes:
        for along, name in shown_by(ax).items():
            if name in limits:
                if min(limits[name]) <= 0 and getattr(ax, f"get_{along}scale")() == "log":
                    raise DeclarationError(
                        f"look.limits.{name}: {min(limits[name]):g} on a logarithmic axis; allowed is > 0"
                    )
                getattr(ax, f"set_{along}lim")(*limits[name])


def _letter(figure: Figure, *, wanted: bool) -> None:
    """Letter all panels that have axes with names, or none."""
    panels = [ax for ax in figure.axes if shown_by(ax) and ax.axison]
    if wanted and any(_lettered(ax) for ax in panels):
        return
    if wanted:
        for letter, ax in zip(ascii_lowercase, panels, strict=False):
            write_letter(ax, letter)
        return
    for ax in panels:
        for text in _lettered(ax):
            rest = LETTER.sub("", text.get_text(), count=1)
            text.set_text(rest)
            if not rest and text in ax.texts:
                text.remove()


def _lettered(ax: Axes) -> list[Any]:
    """Return the texts of a panel that begin with its letter."""
    titles: list[Any] = [ax.title, ax._left_title, *ax.texts]  # pyright: ignore[reportAttributeAccessIssue] # no other way
    return [text for text in titles if LETTER.match(text.get_text())]
