"""Plain columns for a terminal, without loading rich."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Sequence

import click

_LEAST = 20
"""Characters that a column keeps which is wrapped."""


def print_rows(head: Sequence[str], rows: Sequence[Sequence[object]], *, wrap: int | Sequence[int] | None = -2) -> None:
    """Print rows under a head in aligned columns; see `lines`."""
    first, *rest = lines(head, rows, wrap=wrap)
    click.secho(first, bold=True)
    for line in rest:
        click.echo(line)


def lines(head: Sequence[str], rows: Sequence[Sequence[object]], *, wrap: int | Sequence[int] | None) -> list[str]:
    """Return rows under a head in aligned columns.

    Parameters
    ----------
    head : sequence of str
        Column names.
    rows : sequence of sequences
        Cells; ``None`` prints as nothing.
    wrap : int, sequence of int or None
        Index of the column that is wrapped when the terminal is too narrow, or of several of which the widest gives way
        first; ``None`` lets lines run on.

    Examples
    --------
    >>> lines(["A", "name"], [[0.015, "1:1"], [0.023, None]], wrap=None)
    ['A      name', '0.015  1:1', '0.023']
    """
    cells = [[_text(cell) for cell in row] for row in rows]
    widths = [max([len(h), *(len(row[i]) for row in cells)]) for i, h in enumerate(head)]
    wrapped = [] if wrap is None else [place % len(widths) for place in ([wrap] if isinstance(wrap, int) else wrap)]
    if wrapped:
        excess = sum(widths) + 2 * (len(widths) - 1) - shutil.get_terminal_size((120, 24)).columns
        for _ in range(excess):
            widest = max(wrapped, key=widths.__getitem__)
            widths[widest] = max(_LEAST, widths[widest] - 1)
    written = [_join(head, widths)]
    for row in cells:
        pieces = [textwrap.wrap(cell, widths[i]) if i in wrapped else [cell] for i, cell in enumerate(row)]
        for k in range(max([1, *map(len, pieces)])):
            written.append(_join([each[k] if k < len(each) else "" for each in pieces], widths))
    return written


def _join(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip()


def _text(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_text(v) for v in value) + "]"
    return str(value)
