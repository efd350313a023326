"""Cells of a line, and what each is: a number, a time of the day, a sample that was lost, or words."""

from __future__ import annotations

import csv
import functools
import re
from collections import Counter
from collections.abc import Sequence

from vines.errors import RigError
from vines.rig.units import si_factor

__all__ = ["MEASURE", "STAMP", "conforms", "is_number", "kinds_of", "split_line"]

_NUMBER = {
    mark: re.compile(rf"[+-]?(?:\d+{re.escape(mark)}?\d*|{re.escape(mark)}\d+)(?:[eE][+-]?\d+)?") for mark in ".,"
}
_LOST = re.compile(
    r"nan|na|[-+]?∞|n/a|null|none|[+-]?inf(?:inity)?|[-+*#?]+|ol|over\w*|[+-]?1\.#\w+|#n/a|#num!|burn ?out|invalid"
    r"|no data",
    re.IGNORECASE,
)
"""What loggers write for a sample that they don't have."""

STAMP = (
    r"^\s*(?:[0-9A-Za-z]+[-/. ][0-9A-Za-z]+[-/. ]\d+[T ,]\s*)?"
    r"(?:(?P<h>\d+):)?(?P<m>\d\d?):(?P<s>\d\d?)(?:[.,:](?P<f>\d+))?"
    r"\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*(?:Z|UTC|GMT|[+-]\d\d:?\d\d)?\s*$"
)
"""A time of the day, behind a date maybe: 2026-03-02T09:00:00.25Z, 02.03.2026 09:00:00,250, 9:00:00.25 AM, 01:02.5."""

MEASURE = r"^(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<unit>[^\d\s.,:;/+-][^\d,:;]*(?:\^?-?\d)?)$"
"""A number with a unit behind it in one cell: 1.2 mV, 3.4e-3V, 9.81 m/s^2."""

_MEASURE = re.compile(MEASURE)
_STAMP = re.compile(STAMP)
_DATE = re.compile(r"\s*\d{1,4}[-/.]\w{1,3}[-/.]\d{1,4}\s*")


@functools.cache
def is_known(unit: str) -> bool:
    """Say whether a text behind a number is a unit that is known."""
    try:
        si_factor(unit)
    except RigError:
        return False
    return True


def split_line(line: str, separator: str) -> list[str]:
    """Return the cells of a line without blanks and quotes around them.

    Examples
    --------
    >>> split_line('"Time, s"; 1 ;', ";"), split_line("  1   2 ", " "), split_line("1 2", "")
    (['Time, s', '1', ''], ['1', '2'], ['1 2'])
    """
    if separator == " ":
        return line.split()
    if not separator:
        return [line.strip().strip('"')]
    if '"' in line:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    else:
        cells = line.split(separator)
    return [cell.strip() for cell in cells]


def is_number(cell: str, decimal: str) -> bool:
    """Say whether a cell is a number with this decimal sign, and without signs that part thousands.

    Examples
    --------
    >>> is_number("+1.5e-3", "."), is_number("1,5", ","), is_number("1.234,5", ",")
    (True, True, False)
    """
    return _NUMBER[decimal].fullmatch(cell) is not None


def _kind(cell: str, decimal: str) -> str:
    if not cell:
        return "empty"
    if is_number(cell, decimal):
        return "number"
    if ":" in cell and (found := _STAMP.match(cell)):
        # 01:02 alone may be hours and minutes or minutes and seconds.
        return "stamp" if found["h"] or found["f"] else "text"
    if _LOST.fullmatch(cell):
        return "lost"
    if _DATE.fullmatch(cell):
        return "date"
    measure = _MEASURE.match(cell.replace(decimal, "."))
    if measure and is_known(measure["unit"]):
        return "measure"
    # Digits among other signs are what numbers look like that were parted wrongly.
    return "text" if any(map(str.isdigit, cell)) else "word"


def kinds_of(rows: Sequence[Sequence[str]], decimal: str) -> list[str]:
    """Return what each column is: what most of its cells are that say anything."""
    kinds = []
    for column in zip(*rows, strict=True):
        counts = Counter(_kind(cell, decimal) for cell in column)
        meanings = ("number", "measure", "stamp", "date", "text", "word")
        said = sum(counts[kind] for kind in meanings)
        most = max(meanings, key=lambda kind: counts[kind])
        kinds.append(most if said else "number" if counts["lost"] else "empty")
    return kinds


def conforms(cells: Sequence[str], kinds: Sequence[str], decimal: str) -> bool:
    """Say whether a line is one of samples: its columns are of these kinds, and one says something."""
    if len(cells) != len(kinds):
        return False
    numbers = 0
    for cell, kind in zip(cells, kinds, strict=True):
        if kind in ("number", "measure", "stamp"):
            found = _kind(cell, decimal)
            if found not in (kind, "lost", "empty"):
                return False
            numbers += found == kind
        elif kind == "empty" and cell:
            return False
    return numbers > 0
