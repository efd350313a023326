"""What stands above the samples: names, units, and lines of text that state a rate or a start."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from vines.errors import RigError
from vines.rig.formats._csv._cells import is_number, split_line
from vines.rig.formats._csv._lines import COMMENTS
from vines.rig.units import si_factor

__all__ = ["Name", "Notes", "head_cells", "is_unit", "read_name", "read_notes", "units_row"]

_BRACKETS = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<a>[^\]]*)\]|\((?P<b>(?:[^()]|\([^()]*\))*)\)|<(?P<c>[^>]*)>)\s*$")
_PARTED = re.compile(r"^(?P<name>.*?\S)(?:\s*/\s*|\s+in\s+|\s*,\s*)(?P<unit>\S.*)$", re.IGNORECASE)
_TIME = re.compile(
    r"^(?:t|x|x[- _]?axis|x[- _]?value|dt|sec\w*|seconds?)$"
    r"|(?:^|[^a-z])(?:time\w*|zeit\w*|uhrzeit|temps|elapsed|date\W?time)",
    re.IGNORECASE,
)
_TIME_TAIL = re.compile(r"[_ ](?P<unit>m?sec|[mµun]?s|seconds|millis|micros)$", re.IGNORECASE)
_CLOCKS = {"millis": "ms", "micros": "us", "ms": "ms", "us": "us", "µs": "us", "msec": "ms", "usec": "us"}
"""Names that are units: those of the clocks of an Arduino among them."""

_NOTE = re.compile(r"^\s*(?P<key>[^:=]{1,60}?)\s*[:=]\s*(?P<value>.+?)\s*$")
_SIZE = re.compile(r"^(?P<number>[+-]?[\d.,]+(?:[eE][+-]?\d+)?)\s*(?P<unit>.*)$")
_RATES = {
    "sampling rate", "sample rate", "samplerate", "sampling frequency", "sample frequency", "fs", "rate", "scan rate",
    "abtastrate", "messrate",
}  # fmt: skip
_STEPS = {
    "sampling interval", "sample interval", "interval", "dt", "delta t", "time step", "delta x", "x increment", "xinc",
    "hresolution", "time interval", "sampling period", "increment", "abtastintervall",
}  # fmt: skip
_STARTS = {"started", "start time", "startzeit", "trigger time", "trigger date", "date/time", "start date", "timestamp"}
_TIME_UNITS = {"horizontal units", "x units", "x unit", "hunit", "time units", "time unit"}


@dataclass(frozen=True, slots=True)
class Name:
    """A cell of the head.

    Attributes
    ----------
    name : str
    unit : str or None
        As written.
    time : bool
        Whether it is called as times are.
    """

    name: str
    unit: str | None
    time: bool


@dataclass(frozen=True, slots=True)
class Notes:
    """What the lines of text state.

    Attributes
    ----------
    rate : float or None
        Samples a second.
    start : float or None
        Start of the channels [s].
    started : str or None
        When the recorder was started, as written.
    time_unit : str
        Unit of the axis of time, empty if not stated.
    remarks : tuple of str
        What is stated, but not so that it can be used.
    """

    rate: float | None
    start: float | None
    started: str | None
    time_unit: str
    remarks: tuple[str, ...]


def is_unit(text: str) -> bool:
    """Say whether a text is a unit that is known."""
    try:
        si_factor(text)
    except RigError:
        return False
    return True


def read_name(cell: str) -> Name:
    """Return name and unit of a cell of the head.

    Examples
    --------
    >>> [(each.name, each.unit) for each in map(read_name, ("lo [V]", "base (m/(s^2))", "t/s", "Weg in mm", "time_ms"))]
    [('lo', 'V'), ('base', 'm/(s^2)'), ('t', 's'), ('Weg', 'mm'), ('time_ms', 'ms')]
    """
    text = " ".join(cell.strip().strip('"').split())
    found = _BRACKETS.match(text)
    if found and found["name"]:
        unit = next(part for part in (found["a"], found["b"], found["c"]) if part is not None).strip()
        return Name(found["name"], unit or None, _TIME.search(found["name"]) is not None)
    parted = _PARTED.match(text)
    if parted and is_unit(parted["unit"]):
        return Name(parted["name"], parted["unit"], _TIME.search(parted["name"]) is not None)
    if text.casefold() in _CLOCKS:
        return Name(text, _CLOCKS[text.casefold()], True)
    time = _TIME.search(text) is not None
    tail = _TIME_TAIL.search(text) if time else None
    return Name(text, _CLOCKS.get(tail["unit"].casefold(), "s") if tail else None, time)


def head_cells(line: str, separator: str, count: int) -> list[str] | None:
    """Return the cells of a line that could be the head of so many columns, without comment signs; else None."""
    text = line.strip("\n")
    for mark in COMMENTS:
        text = text.removeprefix(mark)
    if separator == " ":
        # Names may hold single blanks, and a blank may part a name and its unit.
        joined = re.sub(r"\s+(?=[\[(<])", "", text)
        choices = [re.split(r"\s{2,}|\t", text.strip()), text.split(), joined.split()]
    else:
        choices = [split_line(text, separator)]
    for cells in choices:
        while len(cells) > count and not cells[-1]:
            cells.pop()
        if len(cells) == count and any(cells):
            return cells
    return None


def units_row(cells: Sequence[str]) -> bool:
    """Say whether these are units and nothing else: in brackets each, or known for the most part.

    Examples
    --------
    >>> units_row(["(s)", "(V)", ""]), units_row(["Second", "Volt"]), units_row(["s", "lo", "base"])
    (True, True, False)
    """
    said = [cell.strip('"') for cell in cells if cell.strip('"- ')]
    if not said:
        return False
    bracketed = all(cell[0] in "([<" and cell[-1] in ")]>" for cell in said)
    return bracketed or 2 * sum(map(is_unit, said)) > len(said)


def read_notes(lines: Sequence[str], separator: str, decimal: str) -> Notes:
    """Return what lines of text state: ``key: value``, ``key = value``, or key and value parted as the columns are."""
    pairs: list[tuple[str, str]] = []
    for line in lines:
        text = line.strip()
        for mark in COMMENTS:
            text = text.removeprefix(mark).strip()
        cells = [cell for cell in split_line(text, separator if separator.strip() else "\t") if cell]
        parted = _NOTE.match(text.strip('"'))
        if len(cells) >= 2 and not cells[0].endswith(":"):
            pairs.append((cells[0], cells[1]))
        elif parted:
            pairs.append(
                (parted["key"], parted["value"].strip('"' + separator + " ") if separator else parted["value"])
            )
    told = [(*_key(key), value) for key, value in pairs]
    time_unit = next((value for key, _, value in told if key in _TIME_UNITS and _is_time(value)), "")
    rate, remarks = None, []
    for (raw, _), (key, unit, value) in zip(pairs, told, strict=True):
        if rate is not None or (key not in _RATES and key not in _STEPS):
            continue
        found = _SIZE.match(value)
        if found is None:
            continue
        number = found["number"].replace(",", ".") if decimal == "," else found["number"]
        # The key with an underscore is that of docs/rig.md, where it is in Hz.
        noted = "Hz" if raw == "sampling_rate" else time_unit if key in _STEPS else ""
        of = found["unit"].strip() or unit or noted
        wanted = "frequency" if key in _RATES else "time"
        if is_number(number, ".") and float(number) > 0 and is_unit(of) and si_factor(of)[0] == wanted:
            size = float(number) * si_factor(of)[1]
            rate = size if wanted == "frequency" else 1.0 / size
        else:
            remarks.append(f"{raw!r} is {value!r}: without a unit of {wanted} it is not used")
    start = next((value for key, _, value in told if key == "start" and is_number(value, ".")), None)
    started = next((value for key, _, value in told if key in _STARTS), None)
    return Notes(rate, None if start is None else float(start), started, time_unit, tuple(remarks))


def _key(text: str) -> tuple[str, str]:
    """Return a key in lower case, and the unit that stands in it."""
    name = read_name(text.replace("_", " "))
    return name.name.casefold(), name.unit or ""


def _is_time(unit: str) -> bool:
    return is_unit(unit) and si_factor(unit)[0] == "time"
