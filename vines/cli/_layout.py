"""Plain columns for a terminal, without loading rich."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Sequence

import click


def print_rows(head: Sequence[str], rows: Sequence[Sequence[object]], *, wrap: int = -2) -> None:
    """Print rows under a head in aligned columns.

    Parameters
    ----------
    head : sequence of str
        Column names.
    rows : sequence of sequences
        Cells; ``None`` prints as nothing.
    wrap : int
        Index of the column that is wrapped when the terminal is too narrow.
    """
    cells = [[_text(cell) for cell in row] for row in rows]
    widths = [max([len(h), *(len(row[i]) for row in cells)]) for i, h in enumerate(head)]
    room = shutil.get_terminal_size((120, 24)).columns
    excess = sum(widths) + 2 * (len(widths) - 1) - room
    wrap %= len(widths)
    if excess > 0:
        widths[wrap] = max(20, widths[wrap] - excess)
    click.secho("  ".join(h.ljust(w) for h, w in zip(head, widths, strict=True)).rstrip(), bold=True)
    for row in cells:
        pieces = textwrap.wrap(row[wrap], widths[wrap]) or [""]
        for k, piece in enumerate(pieces):
            shown = [piece if i == wrap else (cell if k == 0 else "") for i, cell in enumerate(row)]
            click.echo("  ".join(cell.ljust(w) for cell, w in zip(shown, widths, strict=True)).rstrip())


def _text(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_text(v) for v in value) + "]"
    return str(value)
