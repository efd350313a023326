"""LabVIEW measurement files: text with a head of keys for the file and one a segment (NI white paper 4139)."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.formats._csv import to_utf8
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile
from vines.rig.units import si_factor

__all__ = ["FORMAT", "read"]

_BEGINNING = b"LabVIEW Measurement"
_END_OF_HEAD = "***End_of_Header***"
_SPECIAL, _END_OF_SPECIAL = "***Start_Special***", "***End_Special***"
_HEAD = 40
_EMPTY = " \t,"
_STEP_AGREES = 1e-3
"""[samples] By which a segment may begin off the end of the one before and still go on from it."""


@dataclass(frozen=True, slots=True)
class _Segment:
    """A head and the rows below it; `line` is that of the names, from 1."""

    keys: Mapping[str, Sequence[str]]
    names: Sequence[str]
    rows: Sequence[str]
    line: int


def read(path: Path) -> RawFile:
    """Read a file; a channel is called as in the head. Segments that go on from each other are put together.

    Raises
    ------
    RigError
        If it has no samples, a row is not like the others, or a segment does not go on from the one before.
    """
    text, _ = to_utf8(path.read_bytes())
    lines = text.decode().split("\n")
    # The line that names the separator is parted by it.
    separator = "," if any(line.startswith("Separator,") for line in lines[:_HEAD]) else "\t"
    head, place = _keys(lines, 0, separator)
    decimal = (head.get("Decimal_Separator") or ["."])[0] or "."
    columns = (head.get("X_Columns") or ["One"])[0]
    channels: list[RawChannel] = []
    for number, segment in enumerate(_segments(lines, place, separator), 1):
        found = _channels(segment, separator, decimal, columns)
        channels = _joined(channels, found, number, segment.line) if channels else found
    day, time = (" ".join((head.get(key) or [""])[0].split()) for key in ("Date", "Time"))
    return RawFile("LabVIEW LVM", tuple(channels), f"{day} {time}".strip() or None)


def _keys(lines: Sequence[str], place: int, separator: str) -> tuple[dict[str, list[str]], int]:
    """Return the keys of a head that begins at a line, and the line behind it."""
    keys: dict[str, list[str]] = {}
    for k in range(place, len(lines)):
        cells = [cell.strip() for cell in lines[k].split(separator)]
        if cells[0].startswith(_END_OF_HEAD):
            return keys, k + 1
        if cells[0]:
            keys[cells[0]] = cells[1:]
    raise RigError(f"line {place + 1}: a head without {_END_OF_HEAD}")


def _segments(lines: Sequence[str], place: int, separator: str) -> list[_Segment]:
    """Return the segments behind the head of the file."""
    found = []
    while True:
        while place < len(lines) and not lines[place].strip(_EMPTY):
            place += 1
        if place >= len(lines):
            break
        if lines[place].startswith(_SPECIAL):
            ends = (k for k in range(place, len(lines)) if lines[k].startswith(_END_OF_SPECIAL))
            place = next(ends, len(lines)) + 1
            continue
        keys: dict[str, list[str]] = {}
        if lines[place].startswith("Channels"):
            keys, place = _keys(lines, place, separator)
        names = [cell.strip() for cell in lines[place].split(separator)]
        first = place + 1
        place = first
        # A row begins with its time, or with nothing where times are not kept; words begin the next head.
        while place < len(lines) and lines[place].strip(_EMPTY) and not lines[place][:1].isalpha():
            place += 1
        found.append(_Segment(keys, names, lines[first:place], first))
    if not any(segment.rows for segment in found):
        raise RigError("no segment with samples")
    return found


def _channels(segment: _Segment, separator: str, decimal: str, columns: str) -> list[RawChannel]:
    """Return the channels of a segment."""
    count = len(segment.names)
    comment = segment.names[-1:] == ["Comment"]
    width = count - comment
    own = columns.casefold() == "multi"
    table = _table(segment, separator, decimal, width)
    found: list[RawChannel] = []
    for k in range(1, width, 2 if own else 1):
        place = len(found)
        values = table[:, k]
        told = ~np.isnan(values)
        # The channels of a segment need not be equally long.
        values = values[: int(np.flatnonzero(told)[-1]) + 1] if told.any() else values[:0]
        if len(values) < 2:
            continue
        step, start = _number(segment, "Delta_X", place, decimal), _number(segment, "X0", place, decimal)
        axis = _text(segment, "X_Dimension", place) or "Time"
        if axis != "Time":
            raise RigError(f"line {segment.line}: {segment.names[k]!r} is over {axis}, not over time")
        x = table[: len(values), k - 1 if own else 0]
        tick = si_factor(_text(segment, "X_Unit_Label", place) or "s")[1]
        stamped = not step and columns.casefold() != "no"
        found.append(
            RawChannel(
                name=segment.names[k],
                values=values,
                unit=_text(segment, "Y_Unit_Label", place) or None,
                rate=1.0 / (step * tick) if step else None,
                start=(start or 0.0) * tick if step else None,
                times=x * tick if stamped else None,
            )
        )
    return found


def _table(segment: _Segment, separator: str, decimal: str, width: int) -> npt.NDArray[np.float64]:
    """Return the numbers of a segment, NaN where a cell is empty; the column of comments is left out."""
    rows = []
    for k, row in enumerate(segment.rows):
        cells = row.split(separator)
        if len(cells) > width + 1 or (len(cells) == width + 1 and segment.names[-1] != "Comment" and cells[-1].strip()):
            raise RigError(f"line {segment.line + k + 1} has {len(cells)} fields, the head {len(segment.names)} names")
        cells = [cell.strip().replace(decimal, ".") or "nan" for cell in cells[:width]]
        rows.append(",".join([*cells, *["nan"] * (width - len(cells))]))
    try:
        return np.loadtxt(io.StringIO("\n".join(rows)), delimiter=",", ndmin=2)
    except ValueError as broken:
        raise RigError(f"rows below line {segment.line} cannot be read: {' '.join(str(broken).split())}") from None


def _text(segment: _Segment, key: str, place: int) -> str:
    cells = segment.keys.get(key, ())
    return cells[place] if place < len(cells) else ""


def _number(segment: _Segment, key: str, place: int, decimal: str) -> float | None:
    text = _text(segment, key, place).replace(decimal, ".")
    try:
        return float(text)
    except ValueError:
        return None


def _joined(channels: list[RawChannel], more: list[RawChannel], number: int, line: int) -> list[RawChannel]:
    """Return channels with those of the next segment behind them."""
    joined = []
    for one, other in zip(channels, more, strict=False):
        same = (one.name, one.unit, one.rate) == (other.name, other.unit, other.rate) and len(channels) == len(more)
        rate = one.rate or 0.0
        apart = ((other.start or 0.0) - (one.start or 0.0)) * rate - len(one.values)
        if not same or not rate or abs(apart) > _STEP_AGREES:
            raise RigError(
                f"segment {number} (line {line}) does not go on from the one before: it has other channels or another "
                "rate, or begins at another time; part them into files of their own"
            )
        joined.append(replace(one, values=np.concatenate([one.values, other.values])))
    return joined


def _begins(head: bytes, suffix: str) -> bool:
    del suffix
    return head.lstrip(b"\xef\xbb\xbf").startswith(_BEGINNING)


FORMAT = Format(
    name="lvm",
    label="LabVIEW LVM",
    summary="names, `Y_Unit_Label`, `X0`, `Delta_X`; segments that go on from each other",
    suffixes=(".lvm",),
    read=read,
    begins=_begins,
)
