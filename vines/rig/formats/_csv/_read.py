"""A file of text as channels."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from vines.rig.formats._csv._cells import split_line
from vines.rig.formats._csv._dates import start_of
from vines.rig.formats._csv._dialect import DECIMALS, SEPARATORS, Dialect, stated_dialect
from vines.rig.formats._csv._encoding import to_utf8
from vines.rig.formats._csv._head import read_notes
from vines.rig.formats._csv._layout import Layout, find_layout
from vines.rig.formats._csv._lines import take_lines, whole_lines
from vines.rig.formats._csv._table import measures, numbers, read_rows
from vines.rig.formats._csv._times import TimeColumn, counts_rows, time_columns, times_of
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["read"]


def read(path: Path, dialect: str = "") -> RawFile:
    """Read a file of text as loggers write it.

    Parameters
    ----------
    path : Path
        The file.
    dialect : str
        What ``channels.tsv`` states of its layout; the rest is found.

    Raises
    ------
    RigError
        If its layout cannot be found, fits two ways, or a row is not like the others; one line.
    """
    stated = stated_dialect(dialect)
    text, encoding = to_utf8(path.read_bytes(), stated.get("encoding", ""))
    text, cut = whole_lines(text)
    lines = take_lines(text)
    layout = find_layout(lines, stated)
    table, comments = read_rows(text, layout)
    above = [
        line
        for k, line in enumerate(lines.first[: layout.data - 1], 1)
        if k not in (layout.head, layout.units, layout.scales[0])
    ]
    notes = read_notes([line for line in above if line.strip()], layout.separator, layout.decimal)
    remarks = [*notes.remarks, *_remarks(layout, lines.first, cut, comments)]
    timed = time_columns(layout, stated.get("time"))
    known: dict[tuple[int, ...], TimeColumn] = {}
    for places in dict.fromkeys(tuple(places) for places in timed.values() if places):
        known[places], said = times_of(table, layout, places, stated.get("time_unit", ""), notes.time_unit)
        remarks += said
    channels: list[RawChannel] = []
    labels = _unique([name.name for name in layout.names])
    for k, places in timed.items():
        unit = layout.names[k].unit
        if k in layout.measured:
            values, lost, unit = measures(table.column(k), layout.decimal, layout.names[k])
        else:
            values, lost = numbers(table.column(k), layout.decimal)
        about = {"no number": lost} if lost else {}
        scale = _scale(layout, k)
        if scale is not None:
            # Whether the numbers are scaled already the file does not say: no unit is taken from it.
            told = f" {unit}" if unit else ""
            about |= {"scale": repr(scale)} | ({"scale_unit": unit} if unit else {})
            remarks.append(
                f"line {layout.scales[0]} states the scale {scale}{told} of {labels[k]!r}: it is not applied"
            )
            unit = "count" if bool((np.nan_to_num(values) % 1 == 0).all()) else None
        times = known.get(tuple(places))
        channels.append(
            RawChannel(
                name=labels[k],
                values=values,
                unit=unit,
                rate=notes.rate,
                start=notes.start if times is None else None,
                times=None if times is None else times.times,
                tick=None if times is None else times.tick,
                about=about,
            )
        )
    clocks = {place for places in known for place in places}
    other = [
        f"column {labels[k]!r}" for k, kind in enumerate(layout.kinds)
        if k not in timed and k not in clocks and (kind != "empty" or layout.names[k].name != str(k + 1))
    ]  # fmt: skip
    remarks += _counts(table, layout, labels, [k for k in range(len(labels)) if k not in timed and k not in clocks])
    main = next(iter(known.values()), None)
    found = Dialect(
        encoding=encoding,
        separator=next(word for word, sign in SEPARATORS.items() if sign == layout.separator),
        decimal=next(word for word, sign in DECIMALS.items() if sign == layout.decimal),
        head=layout.head,
        units=layout.units,
        data=layout.data,
        time=0 if main is None else main.column,
        time_unit="unknown" if main is None else main.unit.replace(" ", ""),
    )
    began = start_of(table.column(main.column - 1)[0].as_py()) if main is not None and main.unit == "stamp" else None
    return RawFile("CSV", tuple(channels), began or notes.started, tuple(other), str(found), tuple(remarks))


def _scale(layout: Layout, k: int) -> float | None:
    """Return the scale that a row above the samples states for a column; None if there is none but 1."""
    cells = layout.scales[1]
    cell = cells[k] if k < len(cells) else ""
    scale = float(cell.replace(",", ".") if layout.decimal == "," else cell) if cell else 1.0
    return None if scale == 1.0 else scale


def _remarks(layout: Layout, first: tuple[str, ...], cut: str, comments: int) -> list[str]:
    """Return what is to be said of the rows."""
    said = []
    if not layout.head:
        said.append("no line of names: columns are called by their numbers")
    if layout.trailing:
        fields, names = len(layout.kinds), len(split_line(first[layout.head - 1], layout.separator))
        said.append(f"rows have {fields} fields, the head {names} names: the last field is empty in all and left out")
    if comments:
        said.append(f"{comments} comment{'s' if comments > 1 else ''} between rows left out")
    if cut:
        said.append(f"its last line is cut off and left out: {cut[:40]!r}")
    return said


def _counts(table: object, layout: Layout, labels: list[str], places: list[int]) -> list[str]:
    """Return where a column that numbers the rows shows that some are missing."""
    said = []
    for k in places:
        if layout.kinds[k] == "number" and counts_rows(layout, k):
            values, _ = numbers(table.column(k), layout.decimal)  # type: ignore[attr-defined]
            odd = np.flatnonzero(np.diff(values) != 1)
            if len(odd):
                said.append(f"column {labels[k]!r} does not count on at row {int(odd[0]) + 2}: rows are missing")
    return said


def _unique(names: list[str]) -> list[str]:
    """Return names of which no two are the same: the second lo is called lo (2)."""
    seen: Counter[str] = Counter()
    found = []
    for name in names:
        seen[name] += 1
        found.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return found
