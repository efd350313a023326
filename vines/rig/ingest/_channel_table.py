"""``channels.tsv``: its cells, those that a run takes from the table of its campaign, and the rows that they make."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from vines.errors import RigError, nearest
from vines.rig.ingest._overrule import Overruling
from vines.rig.ingest._run_form import ChannelRow
from vines.rig.recording import ROLES

__all__ = ["ALL", "COLUMNS", "Cells", "channels_text", "check_rows", "laid_over", "read_cells", "row_of", "spread_all"]

ALL = "*"
"""Name of the row whose cells hold for every channel that leaves them empty."""
COLUMNS = tuple(field.name for field in msgspec.structs.fields(ChannelRow))
_OF_A_FILE = ("name", "file", "field", "dialect", "overrule")
"""Columns in which runs differ without a reason: where samples lie, and what one file says wrongly."""

_WHY = {
    "role": f"no role: write what it measures: {', '.join(ROLES)}",
    "file": "no file: write its name below raw/",
    "field": "no field: write the name of the channel in its file; 'vines rig inspect FILE' lists them",
    "unit": "no unit: write the unit of the numbers in the file",
    "sign": "no sign: write +1 if the signal rises for motion to the right, the direction of x1, else -1",
    "fs": "no sampling rate: write fs in Hz, or file if the file states it",
    "sensitivity": "no sensitivity: write that of the calibration sheet, or scaled if the file holds mechanical units",
    "u_sensitivity": "no uncertainty of the sensitivity: write the relative standard uncertainty of the calibration",
    "range": "no range: write the largest value that the recorder can hold, so that clipping is seen",
    "group_delay": "no group delay: write that of sensor, conditioner and filters, 0 if it is negligible",
}
_NUMBERS = (
    "sensitivity", "u_sensitivity", "scale", "offset", "fs", "t0", "range", "group_delay", "u_delay", "high_pass",
    "anti_alias",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Cells:
    """A row as it is written.

    Attributes
    ----------
    cells : mapping of str to str
        By column; empty ones are not in it.
    where : str
        File and line.
    """

    cells: Mapping[str, str]
    where: str

    @property
    def name(self) -> str:
        """Name of the channel, empty if there is none."""
        return self.cells.get("name", "")


def read_cells(path: Path) -> tuple[Cells, ...]:
    """Read the rows of a table as they are written.

    Raises
    ------
    RigError
        If it is no such table, or two rows have one name.
    """
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except UnicodeDecodeError as broken:
        raise RigError(f"{path} is not UTF-8: {broken}") from None
    except OSError as error:
        raise RigError(f"{path} cannot be read: {error.strerror}") from None
    kept = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(kept) < 2:
        raise RigError(f"{path}: no channels; it needs a row of column names and one row a channel")
    cells = list(csv.reader((line for _, line in kept), delimiter="\t"))
    head = [name.strip() for name in cells[0]]
    for name in head:
        if name not in COLUMNS:
            hint = "" if "\t" in kept[0][1] else "; columns are parted by tabs"
            raise RigError(f"{path}: unknown column {name!r}: {nearest(name, COLUMNS)}{hint}")
    rows = []
    for (number, _), row in zip(kept[1:], cells[1:], strict=True):
        if len(row) > len(head):
            raise RigError(f"{path} line {number}: {len(row)} cells, but {len(head)} columns")
        given = {key: text.strip() for key, text in zip(head, row, strict=False) if text.strip() not in ("", "n/a")}
        rows.append(Cells(given, f"{path} line {number} ({given.get('name', '?')})"))
    names = [row.name for row in rows]
    for name in names:
        if name and names.count(name) > 1:
            raise RigError(f"{path}: two channels are called {name!r}; names must differ")
    return tuple(rows)


def spread_all(rows: Sequence[Cells]) -> tuple[Cells, ...]:
    """Return the rows with the cells of the row ``*`` in every one that leaves them empty, and without that row.

    Examples
    --------
    >>> shared = [Cells({"name": "*", "range": "10", "sign": "+1"}, ""), Cells({"name": "lo", "sign": "-1"}, "")]
    >>> [dict(row.cells) for row in spread_all(shared)]
    [{'name': 'lo', 'range': '10', 'sign': '-1'}]
    """
    common: Mapping[str, str] = next((row.cells for row in rows if row.name == ALL), {})
    return tuple(Cells({**common, **row.cells}, row.where) for row in rows if row.name != ALL)


def laid_over(
    own: Sequence[Cells], shared: Sequence[Cells], reasons: Mapping[str, str]
) -> tuple[tuple[Cells, ...], dict[str, dict[str, str]], dict[str, str]]:
    """Return the rows of a run over those of its campaign.

    Parameters
    ----------
    own, shared : sequence of Cells
        Of the run and of the campaign.
    reasons : mapping of str to str
        Why the run differs, by ``CHANNEL.COLUMN``, or ``*.COLUMN``.

    Returns
    -------
    rows : tuple of Cells
        Of every channel, those of the campaign first.
    came_from : dict
        Of each channel, whether a cell is the run's or the campaign's.
    overruled : dict of str to str
        What the campaign says of a channel, what is taken, and why.

    Raises
    ------
    RigError
        If a cell differs and no reason is given.
    """
    common: Mapping[str, str] = next((row.cells for row in own if row.name == ALL), {})
    common = {key: text for key, text in common.items() if key != "name"}
    given = {row.name: row for row in own if row.name != ALL}
    rows, came_from, overruled = [], {}, {}
    for base in spread_all(shared):
        row = given.pop(base.name, None)
        mine = {**common, **(row.cells if row else {})}
        notes = []
        for key, text in mine.items():
            before = base.cells.get(key)
            if before in (None, text) or key in _OF_A_FILE or _same_number(before, text):
                continue
            reason = reasons.get(f"{base.name}.{key}") or reasons.get(f"{ALL}.{key}")
            if not reason:
                where = row.where if row and key in row.cells else f"{next(r.where for r in own if r.name == ALL)}"
                raise RigError(
                    f"{where}: {key} is {text}, but the campaign's channels.tsv says {before} for {base.name}; write "
                    f'why into run.json, "overrule": {{"{base.name}.{key}": "..."}}, or leave the cell empty'
                )
            notes.append(f"{key}: the campaign says {before}, {text} is taken: {reason}")
        overruled[base.name] = "; ".join(notes)
        came_from[base.name] = dict.fromkeys(base.cells, "campaign") | dict.fromkeys(mine, "run")
        rows.append(Cells({**base.cells, **mine}, row.where if row else base.where))
    for row in given.values():
        rows.append(Cells({**common, **row.cells}, row.where))
        came_from[row.name] = dict.fromkeys(rows[-1].cells, "run")
        overruled[row.name] = ""
    return tuple(rows), came_from, overruled


def _same_number(one: str, other: str) -> bool:
    try:
        return float(one) == float(other)
    except ValueError:
        return False


def row_of(row: Cells) -> ChannelRow:
    """Return a row of the table, its numbers read.

    Raises
    ------
    RigError
        If it doesn't say what it must; one line.
    """
    for name, why in _WHY.items():
        if name not in row.cells:
            raise RigError(f"{row.where}: {why}")
    form: dict[str, Any] = dict(row.cells)
    if form["role"] in ROLES:
        form.setdefault("quantity", ROLES[form["role"]][0])
    for name in _NUMBERS:
        if name in form and form[name] not in ("scaled", "file"):
            try:
                form[name] = float(form[name])
            except ValueError:
                raise RigError(f"{row.where}: {name} is {form[name]!r}, which is no number") from None
    try:
        Overruling(form.get("overrule", ""))
    except RigError as unfit:
        raise RigError(f"{row.where}: {unfit}") from None
    if "bits" in form and form["bits"].isdigit():
        form["bits"] = int(form["bits"])
    if form["sign"] == "1":
        form["sign"] = "+1"
    try:
        return msgspec.convert(form, ChannelRow)
    except msgspec.ValidationError as unfit:
        raise RigError(f"{row.where}: {unfit}") from None


def check_rows(rows: Sequence[ChannelRow], where: str) -> None:
    """Refuse channels that contradict themselves.

    Raises
    ------
    RigError
        One line.
    """
    for row in rows:
        quantity, _ = ROLES[row.role]
        if row.quantity != quantity:
            raise RigError(f"{where}: {row.name}: role {row.role} is a {quantity}, but quantity is {row.quantity}")
        if not row.scale:
            raise RigError(f"{where}: {row.name}: scale is 0: write what one count is, or nothing")
        if row.sensitivity != "scaled" and not row.sensitivity_unit:
            raise RigError(f"{where}: {row.name}: no sensitivity unit: write it, such as mV/g or V/mm")


def channels_text(rows: Sequence[ChannelRow]) -> str:
    """Return the text of ``channels.tsv``."""
    lines = ["\t".join(COLUMNS)]
    for row in rows:
        values = (getattr(row, name) for name in COLUMNS)
        lines.append("\t".join("n/a" if value in (None, "") else _cell(value) for value in values))
    return "\n".join(lines) + "\n"


def _cell(value: object) -> str:
    return repr(value) if isinstance(value, float) else str(value)
