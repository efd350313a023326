"""A run folder in the manner of BIDS: ``run.json``, ``channels.tsv``, ``raw/`` untouched, ``derived/``."""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from vines.errors import FileMissingError, RigError, nearest
from vines.rig.ingest._overrule import Overruling
from vines.rig.ingest._run_form import ChannelRow, RunForm, Stated
from vines.rig.recording import ROLES, RunInfo, Uncertain

__all__ = [
    "SUMS",
    "RunFolder",
    "channels_text",
    "check_rows",
    "check_sums",
    "find_runs",
    "raw_sums",
    "read_folder",
    "run_info",
]

SUMS = "SHA256SUMS"
"""File beside ``raw/`` with the SHA-256 of each raw file, in the form that ``sha256sum --check`` reads."""

_WHY = {
    "unit": "no unit: write the unit of the numbers in the file",
    "sign": "no sign: write +1 if the signal rises for motion to the right, the direction of x1, else -1",
    "fs": "no sampling rate: write fs in Hz, or file if the file states it",
    "sensitivity": "no sensitivity: write that of the calibration sheet, or scaled if the file holds mechanical units",
    "u_sensitivity": "no uncertainty of the sensitivity: write the relative standard uncertainty of the calibration",
    "range": "no range: write the largest value that the recorder can hold, so that clipping is seen",
    "group_delay": "no group delay: write that of sensor, conditioner and filters, 0 if it is negligible",
}


@dataclass(frozen=True, slots=True)
class RunFolder:
    """A run folder as it was read.

    Attributes
    ----------
    path : Path
        The folder.
    form : RunForm
        ``run.json``.
    rows : tuple of ChannelRow
        ``channels.tsv``.
    """

    path: Path
    form: RunForm
    rows: tuple[ChannelRow, ...]

    @property
    def info(self) -> RunInfo:
        """The run as the rest of the room knows it."""
        return run_info(self.form)

    @property
    def raw_files(self) -> tuple[Path, ...]:
        """The files that the channels name, each once, in their order."""
        return tuple(dict.fromkeys(self.path / "raw" / row.file for row in self.rows))

    @property
    def sidecars(self) -> tuple[Path, ...]:
        """The sidecars of the raw files that have one: ``<file>.json``."""
        beside = (path.with_name(path.name + ".json") for path in self.raw_files)
        return tuple(path for path in beside if path.is_file())


def run_info(form: RunForm) -> RunInfo:
    """Return ``run.json`` as a `RunInfo`."""
    more = {
        "materials": form.materials,
        "licence": form.licence,
        "doi": form.doi,
        "E_meas": None if form.E_meas is None else {"value": form.E_meas.value, "u": form.E_meas.u},
        **form.more,
    }
    return RunInfo(
        run_id=form.run_id,
        start_utc=form.start_utc,
        protocol=form.protocol,
        f_cmd=form.f_cmd,
        E_cmd=form.E_cmd,
        settle=form.settle,
        M=Uncertain(form.M.value, form.M.u),
        m=Uncertain(form.m.value, form.m.u),
        b=Uncertain(form.b.value, form.b.u),
        ball=form.ball,
        temperature=(form.temperature_before, form.temperature_after),
        ringdown=form.ringdown,
        more={key: value for key, value in more.items() if value},
    )


def find_runs(folder: Path) -> tuple[Path, ...]:
    """Return the run folders at or directly below a folder, sorted by name.

    Raises
    ------
    FileMissingError
        If there is none.
    """
    if (folder / "run.json").is_file():
        return (folder,)
    found = tuple(sorted(path.parent for path in folder.glob("*/run.json")))
    if not found:
        raise FileMissingError(
            f"{folder}: no run folder and none in it: there is no run.json; 'vines rig init DIR' makes a template"
        )
    return found


def read_folder(folder: Path) -> RunFolder:
    """Read ``run.json`` and ``channels.tsv``.

    Raises
    ------
    FileMissingError
        If one of them, or a raw file that they name, does not exist.
    RigError
        If they don't say what they must; one line.
    """
    for name in ("run.json", "channels.tsv"):
        if not (folder / name).is_file():
            raise FileMissingError(f"{folder / name} is missing; 'vines rig init DIR' makes a template")
    found = RunFolder(folder, _read_run(folder / "run.json"), _read_channels(folder / "channels.tsv"))
    for path in found.raw_files:
        if not path.resolve().is_relative_to((folder / "raw").resolve()):
            raise RigError(f"{folder / 'channels.tsv'}: file {path.name!r} is not below raw/; raw files are kept there")
        if not path.is_file():
            raise FileMissingError(f"{path} is missing; {folder / 'channels.tsv'} names it")
    return found


def _read_run(path: Path) -> RunForm:
    try:
        form = json.loads(path.read_text("utf-8"))
        if not isinstance(form, dict):
            raise RigError(f"{path}: it is not an object {{...}}")
        given = {key: value for key, value in form.items() if not key.startswith("_")}
        unknown = sorted(set(given) - {field.name for field in msgspec.structs.fields(RunForm)})
        if unknown:
            known = [field.name for field in msgspec.structs.fields(RunForm)]
            raise RigError(
                f"{path}: unknown key {unknown[0]!r}: {nearest(unknown[0], known)}; anything else goes under more"
            )
        if empty := _empty(given):
            raise RigError(f"{path}: still null: {', '.join(empty)}; README.md of 'vines rig init' says what each is")
        run = _with_forces(msgspec.convert(given, RunForm))
    except (json.JSONDecodeError, UnicodeDecodeError) as broken:
        raise RigError(f"{path} is not JSON: {broken}") from None
    except msgspec.ValidationError as unfit:
        raise RigError(f"{path}: {unfit}") from None
    for name, value in (("M", run.M.value), ("m", run.m.value), ("b", run.b.value)):
        if not value > 0:
            raise RigError(f"{path}: {name} is {value:g}, allowed is {name} > 0")
    return run


def _with_forces(run: RunForm) -> RunForm:
    """Return a run whose friction and tilt, under more, are numbers with uncertainties, or not there if null."""
    more = dict(run.more)
    for name in ("friction", "tilt"):
        stated = more.get(name)
        if stated is None or (isinstance(stated, Mapping) and all(part is None for part in stated.values())):
            more.pop(name, None)
            continue
        try:
            msgspec.convert(stated, Stated)
        except msgspec.ValidationError as unfit:
            wanted = '{"value": ..., "u": ...} in m/s^2, or null if it was not measured'
            raise msgspec.ValidationError(f"more.{name}: {unfit}; allowed is {wanted}") from None
    return msgspec.structs.replace(run, more=more)


def _empty(form: Mapping[str, Any]) -> list[str]:
    """Return the keys that are null and must not be."""
    command = ("f_cmd", "E_cmd")
    found = []
    for key, value in form.items():
        if value is None and key in command and form.get("protocol") != "ringdown":
            found.append(f"{key} (null for protocol ringdown only)")
        elif value is None and key not in (*command, "E_meas"):
            found.append(key)
        elif key in ("M", "m", "b", "E_meas") and isinstance(value, Mapping):
            found += [f"{key}.{part}" for part, number in value.items() if number is None]
    return found


def _read_channels(path: Path) -> tuple[ChannelRow, ...]:
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except UnicodeDecodeError as broken:
        raise RigError(f"{path} is not UTF-8: {broken}") from None
    kept = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(kept) < 2:
        raise RigError(f"{path}: no channels; it needs a row of column names and one row a channel")
    cells = list(csv.reader((line for _, line in kept), delimiter="\t"))
    head = [name.strip() for name in cells[0]]
    known = [field.name for field in msgspec.structs.fields(ChannelRow)]
    for name in head:
        if name not in known:
            hint = "" if "\t" in kept[0][1] else "; columns are parted by tabs"
            raise RigError(f"{path}: unknown column {name!r}: {nearest(name, known)}{hint}")
    rows = []
    for (number, _), row in zip(kept[1:], cells[1:], strict=True):
        if len(row) > len(head):
            raise RigError(f"{path} line {number}: {len(row)} cells, but {len(head)} columns")
        given = {key: text.strip() for key, text in zip(head, row, strict=False) if text.strip() not in ("", "n/a")}
        rows.append(_channel(given, f"{path} line {number} ({given.get('name', '?')})"))
    check_rows(rows, str(path))
    return tuple(rows)


def _channel(given: Mapping[str, str], where: str) -> ChannelRow:
    """Return a row of the table, its numbers read."""
    for name, why in _WHY.items():
        if name not in given:
            raise RigError(f"{where}: {why}")
    form: dict[str, Any] = dict(given)
    for name in (
        "sensitivity",
        "u_sensitivity",
        "scale",
        "offset",
        "fs",
        "t0",
        "range",
        "group_delay",
        "u_delay",
        "high_pass",
        "anti_alias",
    ):
        if name in form and form[name] not in ("scaled", "file"):
            try:
                form[name] = float(form[name])
            except ValueError:
                raise RigError(f"{where}: {name} is {form[name]!r}, which is no number") from None
    try:
        Overruling(form.get("overrule", ""))
    except RigError as unfit:
        raise RigError(f"{where}: {unfit}") from None
    if "bits" in form and form["bits"].isdigit():
        form["bits"] = int(form["bits"])
    if form["sign"] == "1":
        form["sign"] = "+1"
    try:
        return msgspec.convert(form, ChannelRow)
    except msgspec.ValidationError as unfit:
        raise RigError(f"{where}: {unfit}") from None


def check_rows(rows: Sequence[ChannelRow], where: str) -> None:
    """Refuse channels that contradict themselves or each other.

    Raises
    ------
    RigError
        One line.
    """
    names = [row.name for row in rows]
    for name in names:
        if names.count(name) > 1:
            raise RigError(f"{where}: two channels are called {name!r}; names must differ")
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
    names = [field.name for field in msgspec.structs.fields(ChannelRow)]
    lines = ["\t".join(names)]
    for row in rows:
        values = (getattr(row, name) for name in names)
        lines.append("\t".join("n/a" if value in (None, "") else _cell(value) for value in values))
    return "\n".join(lines) + "\n"


def _cell(value: object) -> str:
    return repr(value) if isinstance(value, float) else str(value)


def raw_sums(folder: RunFolder) -> dict[str, str]:
    """Return the SHA-256 of each raw file by its path in the run folder."""
    sums = {}
    for path in (*folder.raw_files, *folder.sidecars):
        with path.open("rb") as stream:
            sums[path.relative_to(folder.path).as_posix()] = hashlib.file_digest(stream, "sha256").hexdigest()
    return sums


def check_sums(folder: RunFolder, sums: Mapping[str, str]) -> bool:
    """Compare raw files with ``SHA256SUMS``; return whether they were noted before.

    Raises
    ------
    RigError
        If a raw file is no longer what it was.
    """
    path = folder.path / SUMS
    if not path.is_file():
        return False
    pairs = (line.split(maxsplit=1) for line in path.read_text("utf-8").splitlines() if line.strip())
    noted = {name: value for value, name in pairs}
    for name, value in sums.items():
        if name in noted and noted[name] != value:
            raise RigError(
                f"{folder.path / name} is not the file that was recorded: its SHA-256 is {value[:12]}..., "
                f"{SUMS} says {noted[name][:12]}...; raw files are never changed: restore it"
            )
    return set(sums) <= set(noted)
