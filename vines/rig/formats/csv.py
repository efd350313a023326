"""CSV: a column a channel, its unit in the head as ``name [unit]`` or ``name (unit)``; a time column maybe."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from vines.errors import RigError
from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile
from vines.rig.units import si_factor

__all__ = ["FORMAT", "read", "write"]

_HEAD = re.compile(r"^\s*(?P<name>.*?)\s*(?:\[(?P<square>[^\]]*)\]|\((?P<round>[^)]*(?:\([^)]*\))?[^)]*)\))?\s*$")
_TIME = ("time", "t", "zeit", "timestamp", "time stamp")
_NOTES = re.compile(r"^#\s*(?P<key>[a-z_]+)\s*[:=]\s*(?P<value>.*?)\s*$")


def read(path: Path) -> RawFile:
    """Read a file whose first line without # is the head; parted by commas, semicolons or tabs."""
    need("pandas")
    import pandas as pd

    skipped, notes, head = _top(path)
    if head is None:
        raise RigError("no line of column names")
    part = max(",;\t", key=head.count)
    names = [cell.strip().strip('"') for cell in head.split(part)]
    if all(_is_number(cell) for cell in names if cell):
        raise RigError(
            "the first line holds numbers; a line of column names with units, such as 'lo_acc [V]', is needed"
        )
    try:
        table = pd.read_csv(
            path, sep=part, skiprows=skipped + 1, header=None, names=names, decimal="." if part != ";" else ","
        )
    except (pd.errors.ParserError, UnicodeDecodeError) as broken:
        raise RigError(f"its rows cannot be read: {' '.join(str(broken).split())}") from None
    times = None
    channels: list[RawChannel] = []
    other: list[str] = []
    rate = float(notes["sampling_rate"]) if "sampling_rate" in notes else None
    for column in names:
        found = _HEAD.match(column)
        name = found["name"] if found else column
        unit = (found["square"] or found["round"]) if found else None
        values = table[column].to_numpy()
        if values.dtype.kind not in "iuf" or len(values) < 2:
            other.append(f"column {column!r}")
            continue
        if times is None and not channels and name.casefold() in _TIME:
            times = np.asarray(values, np.float64) * (si_factor(unit)[1] if unit else 1.0)
            continue
        channels.append(RawChannel(name, values, unit or None, rate, notes_start(notes), times))
    return RawFile("CSV", tuple(channels), notes.get("started"), tuple(other))


def notes_start(notes: dict[str, str]) -> float | None:
    """Return the start that the notes above the head give."""
    return float(notes["start"]) if "start" in notes else None


def _top(path: Path) -> tuple[int, dict[str, str], str | None]:
    """Return how many lines stand above the head, what they note, and the head."""
    notes: dict[str, str] = {}
    skipped = 0
    with path.open(encoding="utf-8-sig") as stream:
        for line in stream:
            if line.startswith("#") or not line.strip():
                found = _NOTES.match(line)
                if found:
                    notes[found["key"]] = found["value"]
                skipped += 1
                continue
            return skipped, notes, line.rstrip("\r\n")
    return skipped, notes, None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write channels of one rate and start with their units in the head and the rate in a note above, see `Format`."""
    import pyarrow as pa
    import pyarrow.csv as pc

    names = [f"{each.name} [{each.unit}]" if each.unit else each.name for each in channels]
    columns = [np.asarray(each.values, np.float64) * float(each.about.get("slope", "1")) for each in channels]
    with path.open("wb") as stream:
        stream.write(f"# started: {started}\n# sampling_rate: {channels[0].rate!r}\n".encode())
        stream.write((",".join(names) + "\n").encode())
        options = pc.WriteOptions(include_header=False)
        pc.write_csv(pa.table(columns, names=names), stream, write_options=options)


FORMAT = Format(
    name="csv",
    label="CSV",
    summary="a head `name [unit]` or `name (unit)`; a time column; `# sampling_rate:` above the head",
    suffixes=(".csv", ".tsv", ".txt"),
    read=read,
    write=write,
)
