"""The layout of a text: found from its lines, but for what is stated; what fits two ways is refused, not guessed."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vines.errors import RigError
from vines.rig.formats._csv._cells import conforms, is_number, kinds_of, split_line
from vines.rig.formats._csv._dialect import DECIMALS, SEPARATORS
from vines.rig.formats._csv._head import Name, head_cells, read_name, units_row
from vines.rig.formats._csv._lines import COMMENTS, Lines

__all__ = ["COUNTS", "Layout", "find_layout"]

_SHORTEST = 2
_ROWS_IN_A_HEAD = 3
"""So many lines that look like samples above one that does not: it is damage among samples, not the end of a head.
Where rows have several fields one is enough; a number alone may stand in a head."""
_NAMES = ("tracename", "trace name", "channel name", "signal name", "name", "channel", "ch")
_UNITS = ("vunit", "unit", "units")
"""Labels of rows of names and of units, where the first column is one of labels, as Yokogawa writes them."""
_SCALES = frozenset(
    {
        "scale",
        "scales",
        "scaling",
        "scale factor",
        "factor",
        "slope",
        "lsb",
        "skalierung",
        "faktor",
        "skalierungsfaktor",
    }
)
"""Labels of rows of scales."""
COUNTS = frozenset(
    {
        "no",
        "no.",
        "number",
        "nr",
        "nr.",
        "index",
        "#",
        "sample",
        "samples",
        "scan",
        "reading",
        "point",
        "n",
        "idx",
        "record",
    }
)
"""What columns are called that number the rows."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Where samples stand and what their columns are.

    Attributes
    ----------
    separator, decimal : str
        The characters; a blank for any number of blanks.
    head, units, data : int
        Lines, counted from 1; 0 for none.
    kinds : tuple of str
        What each column is: number, stamp, date, word, text with digits, empty.
    names : tuple of Name
        What each is called: by its number where there is no head.
    trailing : bool
        Whether rows end with a separator that the head does not have.
    measured : frozenset of int
        Columns of numbers, from 0, whose cells hold their unit too.
    scales : tuple of int and tuple of str
        Line that states a scale for each column, and its cells; 0 and none if there is none.
    """

    separator: str
    decimal: str
    head: int
    units: int
    data: int
    kinds: tuple[str, ...]
    names: tuple[Name, ...]
    trailing: bool
    measured: frozenset[int] = frozenset()
    scales: tuple[int, tuple[str, ...]] = (0, ())


def find_layout(lines: Lines, stated: Mapping[str, Any]) -> Layout:
    """Return the layout of a text.

    Parameters
    ----------
    lines : Lines
        Of its beginning and end.
    stated : mapping
        What `stated_dialect` returned; it is used as it is.

    Raises
    ------
    RigError
        If there are no rows of numbers, a row is not like the others, names and columns are not equally many, or two
        layouts fit; one line with the number of the line.
    """
    if len(lines.last) < _SHORTEST:
        raise RigError("no rows of samples")
    separators = [SEPARATORS[stated["separator"]]] if "separator" in stated else [",", ";", "\t", "|", "", " "]
    decimals = [DECIMALS[stated["decimal"]]] if "decimal" in stated else [".", ","]
    fitting: list[tuple[int, Layout]] = []
    refused: list[tuple[int, RigError]] = []
    for separator in separators:
        if separator == " " and any(score > 0 for score, _ in (*fitting, *refused)):
            # Dates hold blanks: who parts cells by another sign does not part them by blanks.
            continue
        read = [(kinds, decimal) for decimal in decimals if (kinds := _kinds(lines.last, separator, decimal))]
        read = [(kinds, decimal) for kinds, decimal in read if _score(kinds) >= 0]
        if not read:
            continue
        # Of whole numbers both signs make the same: the point, which comes first.
        kinds, decimal = max(read, key=lambda one: _score(one[0]))
        try:
            fitting.append((_score(kinds), _placed(lines, separator, decimal, kinds, stated)))
        except RigError as error:
            refused.append((_score(kinds), error))
    worse = max((score for score, _ in refused), default=-1)
    # Where a layout that fits better holds damage, one that leaves digits unread is no way out.
    fitting = [one for one in fitting if one[0] >= worse or "text" not in one[1].kinds]
    if fitting:
        return _the_one([layout for _, layout in sorted(fitting, key=lambda one: -one[0])], lines, stated)
    if refused:
        raise max(refused, key=lambda one: one[0])[1]
    raise RigError(f"no rows of numbers; its end is {_short(lines.last[-1])}")


_FRACTION = re.compile(r"\d+([eE][+-]?\d+)?")
"""What may stand behind a decimal comma."""


def _the_one(fitting: list[Layout], lines: Lines, stated: Mapping[str, Any]) -> Layout:
    """Return the layout with most columns of numbers, unless its commas may be decimal signs as well."""
    best = fitting[0]
    single = next((each for each in fitting if not each.separator and each.decimal == ","), None)
    if single is not None and single.head and single.names[0].unit and not best.head:
        return single
    rows = [split_line(line, ",") for line in lines.last[-_SHORTEST:]]
    count = len(best.kinds) - (best.kinds[-1] == "empty")
    pairs = count % 2 == 0 and all(_FRACTION.fullmatch(cell) for row in rows for cell in row[1:count:2])
    if best.separator != "," or best.head or "decimal" in stated or not pairs:
        return best
    raise RigError(
        f"a comma in {_short(lines.last[-1])} may part two columns or be a decimal sign: write decimal=point with "
        "separator=comma, or decimal=comma with separator=none, into the column dialect of channels.tsv"
    )


def _kinds(rows: Sequence[str], separator: str, decimal: str) -> tuple[str, ...] | None:
    """Return what the columns of the last rows are; None if they are no rows of numbers with these signs."""
    cells = [split_line(row, separator) for row in rows]
    # A short text shows its head here, too.
    cells = [row for row in cells if len(row) == len(cells[-1])][-max(_SHORTEST, len(cells) // 2) :]
    kinds = kinds_of(cells, decimal)
    if len(cells) < _SHORTEST or not {"number", "measure"} & set(kinds) or not conforms(cells[-1], kinds, decimal):
        return None
    return tuple(kinds)


def _score(kinds: Sequence[str]) -> int:
    """Return how well signs part rows: columns of numbers and times count; other digits show that they don't."""
    return sum(kind in ("number", "measure", "stamp") for kind in kinds) - 2 * kinds.count("text")


def _placed(lines: Lines, separator: str, decimal: str, kinds: tuple[str, ...], stated: Mapping[str, Any]) -> Layout:
    """Return the layout with these signs."""
    data = stated.get("data") or _first_row(lines, separator, decimal, kinds)
    measured = frozenset(k for k, kind in enumerate(kinds) if kind == "measure")
    kinds = tuple("number" if kind == "measure" else kind for kind in kinds)
    scales = _scale_row(lines, data, separator, decimal, kinds)
    head, units = (
        (_Row(), _Row()) if data == 1 else _named_rows(lines, data, separator, decimal, kinds, stated, scales.line)
    )
    numbers = [str(k + 1) for k in range(len(kinds))]
    names = [
        read_name(cell) if cell else Name(number, None, False)
        for number, cell in zip(numbers, head.cells or numbers, strict=False)
    ]
    names += [Name(number, None, False) for number in numbers[len(names) :]]
    for k, cell in enumerate(units.cells):
        if kinds[k] == "number" and cell.strip('"-[]() ') and cell.casefold() not in COUNTS:
            names[k] = Name(names[k].name, cell.strip('"[]()<> '), names[k].time)
    trailing = kinds[-1] == "empty" and 0 < len(head.cells) < len(kinds)
    return Layout(
        separator,
        decimal,
        head.line,
        units.line,
        data,
        kinds,
        tuple(names),
        trailing,
        measured,
        (scales.line, scales.cells),
    )


@dataclass(frozen=True, slots=True)
class _Row:
    """A line above the samples and its cells; none of both if there is none."""

    line: int = 0
    cells: tuple[str, ...] = ()


def _scale_row(lines: Lines, data: int, separator: str, decimal: str, kinds: Sequence[str]) -> _Row:
    """Return the row above the samples that is labelled as scales and holds a number for a column, if there is one."""
    for place in range(data - 1, 0, -1):
        cells = split_line(lines.first[place - 1].lstrip("#% "), separator)
        label = cells[0].strip('": ').casefold()
        given = [cell for cell in cells[1:] if cell]
        if label in _SCALES and len(cells) == len(kinds) and given and all(is_number(cell, decimal) for cell in given):
            return _Row(place, ("", *cells[1:]))
    return _Row()


def _named_rows(
    lines: Lines, data: int, separator: str, decimal: str, kinds: Sequence[str], stated: Mapping[str, Any], scales: int
) -> tuple[_Row, _Row]:
    """Return the rows of names and of units; the line `scales` is none of them."""
    if "head" in stated or "units" in stated:
        places = [stated.get("head", 0), stated.get("units", 0)]
        if max(places) > len(lines.first):
            raise RigError(f"line {max(places)} is stated to be of the head, but the text is shorter")
        found = []
        for place in places:
            cells, names = _head(lines.first[place - 1], separator, kinds) if place else ([], 0)
            if cells is None:
                raise RigError(_unequal(lines, place, names, kinds))
            found.append(_Row(place, tuple(cells)))
        return found[0], found[1]
    near = [k for k in range(data - 1, 0, -1) if lines.first[k - 1].strip() and k != scales]
    if kinds[0] == "empty":
        # The first column holds labels, each of a row of the head.
        rows = [(k, _head(lines.first[k - 1], separator, kinds)[0]) for k in near]
        labelled = {cells[0].casefold(): _Row(k, ("", *cells[1:])) for k, cells in rows if cells}
        names = next((labelled[label] for label in _NAMES if label in labelled), None)
        if names is not None:
            return names, next((labelled[label] for label in _UNITS if label in labelled), _Row())
    rows = [(k, *_head(lines.first[k - 1], separator, kinds)) for k in near[:2]]
    if not rows:
        return _Row(), _Row()
    place, cells, names = rows[0]
    if cells is None:
        if names > 1:
            raise RigError(_unequal(lines, place, names, kinds))
        parts = [cell for cell in split_line(lines.first[place - 1], separator) if cell]
        if parts and set(kinds_of([parts], decimal)) <= {"number", "stamp"}:
            raise RigError(_odd(lines, place))
        return _Row(), _Row()
    counted = [cell for cell, kind in zip(cells, kinds, strict=False) if kind in ("number", "stamp")]
    figures = sum(is_number(cell, decimal) for cell in counted)
    words = rows[1][1] if len(rows) > 1 else None
    # A head may hold numbers, but hardly below another that holds none: it is a row that was damaged.
    below = words is not None and not any(is_number(cell, decimal) for cell in words)
    if figures == len(counted) or (figures and below):
        raise RigError(_odd(lines, place))
    if units_row([cell for cell, kind in zip(cells, kinds, strict=False) if kind == "number"]):
        above = rows[1] if len(rows) > 1 else None
        named = _Row(above[0], tuple(above[1])) if above is not None and above[1] is not None else _Row()
        return named, _Row(place, tuple(cells))
    return _Row(place, tuple(cells)), _Row()


def _odd(lines: Lines, place: int) -> str:
    return f"line {place} is no row like those below it, and no head: {_short(lines.first[place - 1])}"


def _unequal(lines: Lines, place: int, names: int, kinds: Sequence[str]) -> str:
    line = _short(lines.first[place - 1])
    return f"line {place} has {names} names, but rows have {len(kinds)} fields: {line}"


def _head(line: str, separator: str, kinds: Sequence[str]) -> tuple[list[str] | None, int]:
    """Return the cells of a line that may name the columns, else none and how many names it seems to have."""
    comment = line.lstrip().startswith(COMMENTS)
    counts = [len(kinds), len(kinds) - 1] if kinds[-1] == "empty" else [len(kinds)]
    if not (comment and len(kinds) == 1):
        for count in counts:
            cells = head_cells(line, separator, count)
            if cells is not None:
                return cells, count
    parts = re.split(r"\s{2,}|\t", line.strip()) if separator == " " else split_line(line, separator)
    words = not comment and all(parts) and not any(is_number(cell, mark) for cell in parts for mark in ".,")
    return None, len(parts) if words else 0


def _first_row(lines: Lines, separator: str, decimal: str, kinds: Sequence[str]) -> int:
    """Return the line of the first row of samples."""
    told = [
        (place, conforms(split_line(line, separator), kinds, decimal))
        for place, line in enumerate(lines.first, 1)
        if line.strip() and not line.lstrip().startswith(COMMENTS)
    ]
    odd = max((k for k, (_, row) in enumerate(told) if not row), default=-1)
    above = [row for _, row in told[: odd + 1]]
    most = _ROWS_IN_A_HEAD if len(kinds) == 1 else 1
    if sum(above) >= most:
        place = next(place for k, (place, row) in enumerate(told) if not row and sum(above[:k]) >= most)
        raise RigError(f"line {place} is no row like those about it: {_short(lines.first[place - 1])}")
    if odd + 1 >= len(told):
        raise RigError(f"no rows of samples in its first {len(lines.first)} lines")
    return told[odd + 1][0]


def _short(line: str) -> str:
    """Return a line as it is quoted in a message."""
    text = " ".join(line.split())
    return repr(text if len(text) <= 60 else text[:57] + "...")
