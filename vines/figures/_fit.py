"""Fit what is written around the panels of a figure to its width, whatever that is."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from vines.figures._look import worn

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

__all__ = ["LETTER", "broken", "columns_in", "fit_titles", "place_legend"]

_WORDS = re.compile(r"(?:\$[^$]*\$|[^\s$])+")
"""What a line is not broken within: a formula, and what is written to it without a space."""
LETTER = re.compile(r"\([a-z]\)\s*")
"""How the letter of a panel is written, alone or before its title."""
_NARROWEST = 1.7
"""Inches that a panel with its numbers and labels takes at least."""
_PLACES: Any = {"below": "outside lower center", "above": "outside upper center", "right": "outside right upper"}
_BESIDE = 0.35
"""Part of the width that a legend on the right may take."""
_EDGE = 4.0
"""Points that stay free at an edge of the figure."""


def columns_in(width: float, wanted: int) -> int:
    """Return how many panels stand side by side: as many as are wanted, fewer where each would be too narrow.

    Examples
    --------
    >>> [columns_in(width / 25.4, 3) for width in (85, 120, 180)]
    [1, 2, 3]
    """
    return max(1, min(wanted, int(width / _NARROWEST)))


def broken(text: str, fits: Callable[[str], bool]) -> str:
    r"""Return a text in as few lines as fit, broken between words and never inside a formula.

    Parameters
    ----------
    text : str
        The text; where it fits as it stands it is returned as it is.
    fits : callable
        ``fits(line)`` says whether a line is short enough. A single word that is too long stands alone.

    Examples
    --------
    >>> broken("$\\mu = 0.01$,  $A = 0.015$,  $r = 0.65$", lambda line: len(line) < 30)
    '$\\mu = 0.01$, $A = 0.015$,\n$r = 0.65$'
    """
    if all(fits(line) for line in text.split("\n")):
        return text
    lines = [""]
    for word in _WORDS.findall(text):
        longer = f"{lines[-1]} {word}".lstrip()
        if lines[-1] and not fits(longer):
            lines.append(word)
        else:
            lines[-1] = longer
    return "\n".join(lines)


def fit_titles(figure: Figure) -> bool:
    """Break titles that are longer than there is room, and thin numbers along x that touch each other.

    The figure gets the height of the lines that come to it.

    Parameters
    ----------
    figure : matplotlib Figure
        With constrained layout, by which it is laid out here; its legend is placed already.

    Returns
    -------
    bool
        Whether anything was changed, so that it has to be laid out again.
    """
    engine = figure.get_layout_engine()
    if engine is None:
        return False
    engine.execute(figure)  # places of the panels
    taller = _break_titles(figure)
    broke = any([_break_label(ax) for ax in figure.axes])  # noqa: C419 - each of them
    _heighten(figure, taller)
    if taller or broke:
        engine.execute(figure)  # panels are narrower beside a label of two lines: titles and numbers have less room
    if broke and (taller := _break_titles(figure)):
        _heighten(figure, taller)
        engine.execute(figure)
    thinned = [_thin(ax, figure) for ax in figure.axes]
    return any(thinned)


def _break_titles(figure: Figure) -> float:
    """Break titles that are longer than there is room, and return the height of the lines that came to them, px."""
    before = after = 0.0
    for title, room in _titles(figure):
        old = _height(title)
        title.set_text(broken(title.get_text(), lambda line, title=title, room=room: _width(title, line) <= room))
        if _height(title) > old:
            before, after = before + old, after + _height(title)
    return after - before


def _heighten(figure: Figure, taller: float) -> None:
    """Give a figure so many px of height more."""
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + taller / figure.dpi)


def place_legend(
    figure: Figure, handles: Sequence[Any], labels: Sequence[str], *, ncols: int, handler_map: Any = None, **how: Any
) -> None:
    """Write a legend beside the panels, in as many columns as fit the width; what it takes the figure gets in height.

    It stands where the look that is worn has it: below by default.

    Parameters
    ----------
    figure : matplotlib Figure
        The figure.
    handles : sequence of artists
        What is shown before each label.
    labels : sequence of str
        The labels; one that is wider than the figure is broken.
    ncols : int
        Columns at most.
    handler_map : dict, optional
        Who draws which handles.
    **how
        Further options of :meth:`matplotlib.figure.Figure.legend`.
    """
    place = worn().legend
    if place == "none":
        return

    def legend(columns: int, words: Sequence[str]) -> Any:
        for old in list(figure.legends):
            old.remove()
        return figure.legend(
            list(handles), list(words), handler_map=handler_map, loc=_PLACES[place], ncols=columns, **how
        )

    room = figure.bbox.width - 2 * _EDGE * figure.dpi / 72
    if place == "right":
        ncols, room = 1, _BESIDE * room
    drawn = legend(ncols, labels)
    first = _extent(drawn).height
    columns = min(ncols, len(labels))
    while columns > 1 and _extent(drawn).width > room:
        columns -= 1
        drawn = legend(columns, labels)
    if (wide := _extent(drawn).width) > room:
        text = drawn.get_texts()[0]
        lost = wide - max(_width(each, each.get_text()) for each in drawn.get_texts())  # handles and gaps
        drawn = legend(columns, [broken(each, lambda line: _width(text, line) <= room - lost) for each in labels])
    taller = _extent(drawn).height - first
    if place != "right" and taller > 0:
        width, height = figure.get_size_inches()
        figure.set_size_inches(width, height + taller / figure.dpi)


def _titles(figure: Figure) -> list[tuple[Text, float]]:
    """Return the titles of the figure and of its panels, each with its room, px."""
    edge = _EDGE * figure.dpi / 72
    found: list[tuple[Text, float]] = []
    above: Any = getattr(figure, "_suptitle", None)
    if above is not None and above.get_text():
        found.append((above, figure.bbox.width - 2 * edge))
    for ax in figure.axes:
        left: Any = ax._left_title  # pyright: ignore[reportAttributeAccessIssue] # no other way to it
        if left.get_text():
            found.append((left, _room(ax, figure) - edge))
        if ax.title.get_text():  # in the middle, so that a letter on the left counts on both sides
            letter = _extent(left).width + edge if left.get_text() else 0.0
            found.append((ax.title, ax.bbox.width - 2 * letter))
    return found


def _break_label(ax: Axes) -> bool:
    """Break the label of an axis upwards that is longer than its panel, below its letter; say whether it was."""
    label = ax.yaxis.label
    letters = [_height(text) for text in ax.texts if LETTER.fullmatch(text.get_text())]
    room = ax.bbox.height - 2 * max(letters, default=0.0)  # in the middle, so that the letter counts on both sides
    text = label.get_text()
    if text and _height(label) > room > 0:
        label.set_text(broken(text, lambda line: _long(label, line) <= room))
    return label.get_text() != text


def _long(label: Text, line: str) -> float:
    """Return how long a line is in the font of a label upwards, px."""
    kept = label.get_text()
    label.set_text(line)
    length = _height(label)
    label.set_text(kept)
    return length


def _thin(ax: Axes, figure: Figure) -> bool:
    """Take numbers from an axis along x until none touches the next; say whether any was taken."""
    from matplotlib.ticker import MaxNLocator

    if ax.get_xscale() == "log":
        return _thin_log(ax, figure)
    locator: Any = ax.xaxis.get_major_locator()
    if ax.get_xscale() != "linear" or not isinstance(locator, MaxNLocator) or not ax.xaxis.get_visible():
        return False
    for most in range(7, 1, -1):
        if _apart(ax.get_xticklabels(), ax, figure):
            return most < 7
        locator.set_params(nbins=most, min_n_ticks=2 if most > 2 else 1)  # else a finer step for a second one
    return True


def _thin_log(ax: Axes, figure: Figure) -> bool:
    """Take numbers from a logarithmic axis along x until none touches the next; say whether any was taken.

    Numbers between powers of ten are left at twice and five times those, then at none; of fixed ones every other.
    """
    from matplotlib.ticker import FixedLocator, FuncFormatter

    whole: Any = ax.xaxis.get_minor_formatter()

    def written(value: float, place: int | None = None) -> str:
        leading = round(value / 10 ** math.floor(math.log10(value)))
        return whole(value, place) if leading in kept else ""

    for kept in ((2, 5), ()):
        if _apart(ax.get_xticklabels(which="both"), ax, figure):
            return kept != (2, 5)
        ax.xaxis.set_minor_formatter(FuncFormatter(written))
        whole.set_locs(ax.xaxis.get_minorticklocs())
    while isinstance(ax.xaxis.get_major_locator(), FixedLocator) and not _apart(ax.get_xticklabels(), ax, figure):
        ax.xaxis.set_major_locator(FixedLocator(list(ax.xaxis.get_majorticklocs())[::2]))
    return True


def _apart(labels: Sequence[Text], ax: Axes, figure: Figure) -> bool:
    """Say whether numbers along x that are shown have half a letter between them."""
    low, high = sorted(ax.get_xlim())
    shown = [each for each in labels if low <= each.get_position()[0] <= high and each.get_text()]
    gap = 0.5 * max((float(each.get_fontsize()) for each in shown), default=0.0) * figure.dpi / 72
    boxes = sorted((_extent(each) for each in shown), key=lambda box: box.x0)
    return all(one.x1 + gap <= other.x0 for one, other in itertools.pairwise(boxes))


def _room(ax: Axes, figure: Figure) -> float:
    """Return how far a title may reach from the left edge of a panel: to the next panel or to the edge."""
    box = ax.bbox
    others = [other.bbox for other in figure.axes if other.get_label() != "<colorbar>"]
    beside = [each.x0 for each in others if each.x0 >= box.x1 and each.y0 < box.y1 and each.y1 > box.y0]
    legends = [_extent(each).x0 for each in figure.legends if worn().legend == "right"]
    return min([figure.bbox.width, *beside, *legends]) - box.x0


def _extent(artist: Any) -> Any:
    return artist.get_window_extent(artist.get_figure(root=True).canvas.get_renderer())


def _width(text: Text, line: str) -> float:
    """Return how wide a line is in the font of a text, px."""
    kept = text.get_text()
    text.set_text(line)
    width = float(_extent(text).width)
    text.set_text(kept)
    return width


def _height(text: Text) -> float:
    return float(_extent(text).height)
