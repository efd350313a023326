"""The rows of samples as a table with a type a column; a row with more or fewer fields than the others is refused."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.formats._csv._cells import MEASURE, STAMP, split_line
from vines.rig.formats._csv._head import Name
from vines.rig.formats._csv._layout import Layout
from vines.rig.formats._csv._lines import COMMENTS
from vines.rig.units import si_factor

__all__ = ["day_seconds", "measures", "numbers", "read_rows"]

_COMMENT = re.compile(rb"(?m)^[ \t]*(?:#|%|//).*\n")
_BLANK = re.compile(rb"(?m)^[ ]+\n")
_NO_SEPARATOR = "\x1f"
_DAY = 86400.0


def read_rows(text: bytes, layout: Layout) -> tuple[Any, int]:
    """Return the rows as a table of columns ``0``, ``1``, …, and how many comments stood between them.

    Numbers are double precision; a column of them in which something else stands is one of texts.

    Raises
    ------
    RigError
        If a row has another number of fields; one line with its number and what it holds.
    """
    import pyarrow as pa
    import pyarrow.csv as pc

    place = 0
    for _ in range(layout.data - 1):
        place = text.index(b"\n", place) + 1
    comments = 0
    # A long text is copied only where something is to be taken out.
    body: bytes | memoryview = memoryview(text)[place:]
    if any(text.find(mark.encode(), place) >= 0 for mark in COMMENTS):
        body, comments = _COMMENT.subn(b"", body)
    if text.find(b"\n ", place) >= 0:
        body = _BLANK.sub(b"", body)
    if layout.separator == " ":
        body = re.sub(rb"(?m)^ | $", b"", re.sub(rb"[ \t]+", b" ", body))
    names = [str(k) for k in range(len(layout.kinds))]
    types = {
        name: pa.float64() if kind == "number" and k not in layout.measured else pa.string()
        for k, (name, kind) in enumerate(zip(names, layout.kinds, strict=True))
    }
    while True:
        try:
            table = pc.read_csv(
                pa.BufferReader(pa.py_buffer(body)),
                read_options=pc.ReadOptions(column_names=names),
                parse_options=pc.ParseOptions(delimiter=layout.separator or _NO_SEPARATOR),
                convert_options=pc.ConvertOptions(
                    column_types=types, null_values=["", " "], strings_can_be_null=False, decimal_point=layout.decimal
                ),
            )
            return table, comments
        except pa.ArrowInvalid as error:
            odd = re.search(r"In CSV column #(\d+)", str(error))
            if odd is None:
                raise _ragged(text, layout, str(error)) from None
            # What is no number is looked at cell by cell.
            types[odd[1]] = pa.string()


def _ragged(text: bytes, layout: Layout, reason: str) -> RigError:
    """Return the error that names the first row with another number of fields."""
    for place, line in enumerate(text.decode().split("\n"), 1):
        if place >= layout.data and line.strip() and not _COMMENT.match(line.encode() + b"\n"):
            count = len(split_line(line, layout.separator))
            if count != len(layout.kinds):
                short = line if len(line) <= 60 else line[:57] + "..."
                return RigError(f"line {place} has {count} fields, those above it have {len(layout.kinds)}: {short!r}")
    return RigError(f"its rows cannot be read: {' '.join(reason.split())[:160]}")


def measures(column: Any, decimal: str, name: Name) -> tuple[npt.NDArray[np.float64], str, str | None]:
    """Return a column of numbers with units behind them: numbers in one unit, the first cell that is none, the unit.

    Parameters
    ----------
    column : pyarrow.ChunkedArray of texts
    decimal : str
    name : Name
        What the head says; its unit must be that of the cells if it has one.

    Raises
    ------
    RigError
        If the cells are of several quantities, or the head says another.

    Examples
    --------
    >>> import pyarrow as pa
    >>> measures(pa.chunked_array([["1.5 mV", "2 V", "OL"]]), ".", Name("lo", None, False))
    (array([1.5e+00, 2.0e+03,     nan]), "'OL' in row 3", 'mV')
    """
    import pyarrow as pa
    import pyarrow.compute

    pc: Any = pyarrow.compute
    text = pc.utf8_trim_whitespace(pc.cast(column, pa.string()))
    text = pc.replace_substring(text, ",", ".") if decimal == "," else text
    found = pc.extract_regex(text, MEASURE)
    values = pc.cast(pc.struct_field(found, "number"), pa.float64()).to_numpy().copy()
    units = pc.utf8_trim_whitespace(pc.struct_field(found, "unit")).to_numpy()
    told = [unit for unit in dict.fromkeys(units) if unit is not None]
    unit = name.unit or told[0]
    for each in told:
        try:
            (quantity, factor), (wanted, one) = si_factor(each), si_factor(unit)
        except RigError as unknown:
            raise RigError(f"column {name.name!r}: {unknown}") from None
        if quantity != wanted:
            where = "the head says" if name.unit else "others are in"
            raise RigError(f"column {name.name!r}: cells are in {each}, {where} {unit}")
        if factor != one:
            values[units == each] *= factor / one
    bad = np.isnan(values)
    place = int(bad.argmax())
    return values, f"{column[place].as_py()!r} in row {place + 1}" if bad.any() else "", unit


def numbers(column: Any, decimal: str) -> tuple[npt.NDArray[np.float64], str]:
    """Return a column as numbers, NaN where it holds none, and the first cell that is none, quoted, with its row.

    Examples
    --------
    >>> import pyarrow as pa
    >>> numbers(pa.chunked_array([["1,5", "OVER", ""]]), ",")
    (array([1.5, nan, nan]), "'OVER' in row 2")
    """
    import pyarrow as pa
    import pyarrow.compute

    pc: Any = pyarrow.compute
    if column.type == pa.float64():
        values = column.to_numpy()
        lost = np.isnan(values)
        return values, f"'' in row {int(lost.argmax()) + 1}" if lost.any() else ""
    text = pc.utf8_trim_whitespace(column)
    if decimal == ",":
        text = pc.replace_substring(text, ",", ".")
    good = pc.match_substring_regex(text, r"^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?$")
    values = pc.cast(pc.if_else(good, text, pa.scalar(None, pa.string())), pa.float64()).to_numpy()
    bad = np.isnan(values)
    place = int(bad.argmax())
    return values, f"{column[place].as_py()!r} in row {place + 1}" if bad.any() else ""


def day_seconds(column: Any) -> npt.NDArray[np.float64]:
    """Return times of the day as seconds, counted on over midnight; NaN where there is none.

    The date is not read: day and month are written in either order.

    Examples
    --------
    >>> import pyarrow as pa
    >>> day_seconds(pa.chunked_array([["2.3.2026 11:59:59,5 PM", "3.3.2026 12:00:00,0 AM", "3.3.2026 12:00:00,5 AM"]]))
    array([86399.5, 86400. , 86400.5])
    """
    import pyarrow as pa
    import pyarrow.compute

    pc: Any = pyarrow.compute
    found = pc.extract_regex(column, STAMP)
    parts = {
        name: pc.cast(pc.if_else(pc.equal(part, ""), "0", part), pa.float64()).to_numpy()
        for name in "hms"
        for part in [pc.struct_field(found, name)]
    }
    fraction = pc.struct_field(found, "f")
    digits = pc.cast(pc.binary_join_element_wise("0.", fraction, "0", ""), pa.float64()).to_numpy()
    half = pc.utf8_slice_codeunits(pc.ascii_lower(pc.struct_field(found, "half")), 0, 1)
    hours = parts["h"]
    evening = pc.equal(half, "p").to_numpy().astype(bool)
    morning = pc.equal(half, "a").to_numpy().astype(bool)
    hours = np.where(evening & (hours < 12), hours + 12, np.where(morning & (hours == 12), 0.0, hours))
    seconds = 3600 * hours + 60 * parts["m"] + parts["s"] + digits
    steps = np.diff(seconds, prepend=seconds[:1])
    return seconds + _DAY * np.cumsum(np.where(steps < -_DAY / 2, 1, 0))
