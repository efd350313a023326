"""Making a run folder or a campaign: empty, from recordings, or like another run."""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from vines.errors import FileMissingError, RigError, StoreError
from vines.rig.formats import FORMATS, RawFile, read_file
from vines.rig.ingest._channel_table import COLUMNS, Cells, read_cells, spread_all
from vines.rig.ingest._init_rows import differing_rows, like_rows, shared_rows
from vines.rig.ingest._propose import Known, known_channels, known_run
from vines.rig.ingest._run_folder import CAMPAIGN, RunFolder, read_folder
from vines.rig.ingest._run_form import Proposal
from vines.rig.ingest._run_json import read_json
from vines.rig.ingest._template import RUN, SHARED, campaign_readme, json_text, run_readme, table_text

__all__ = ["Written", "init_campaign", "init_run"]

_AGAIN = ("start_utc", "E_cmd", "E_meas", "temperature_before", "temperature_after", "ringdown")
"""What of a run is another one's never: when it was, at which amplitude, how warm it was."""

_SAME_COMMAND = 5e-3
"""Relative difference of a line in the spectrum and a command within which ingest takes them for one."""


@dataclass(frozen=True, slots=True)
class Written:
    """What was made.

    Attributes
    ----------
    files : tuple of Path
        Forms that were written.
    remarks : tuple of str
        What a person has to know: what a recording is, where it differs from what is described.
    todo : dict of Path to int
        Entries that are left to be filled in, by file.
    """

    files: tuple[Path, ...]
    remarks: tuple[str, ...] = ()
    todo: dict[Path, int] = field(default_factory=dict)


def init_run(
    folder: Path, recordings: Sequence[Path] = (), like: Path | None = None, protocol: str | None = None
) -> Written:
    """Write a run folder: a commented template, filled in as far as recordings or another run say.

    Parameters
    ----------
    folder : Path
        Where; it may exist, but must not have a ``run.json`` or ``channels.tsv``. Beside a ``rig.json`` it gets only
        what is the run's own.
    recordings : sequence of Path
        Its files, or folders of them; they are copied into ``raw/``.
    like : Path, optional
        A run folder, whose description is taken but for what is of its day: start, amplitude, temperatures.
    protocol : str, optional
        What was done, if a recording need not be asked.

    Raises
    ------
    StoreError
        If there is a run already; nothing is overwritten.
    FileMissingError, RigError
        If a recording or the other run cannot be read.
    """
    _free(folder, ("run.json", "channels.tsv", "README.md"))
    recordings = _expanded(recordings)
    files = _read(recordings)
    other = read_folder(like) if like is not None else None
    shared = folder.absolute().parent / CAMPAIGN
    if shared.is_file():
        return _in_campaign(folder, recordings, files, other, protocol, shared)
    entries, notes = dict(RUN), {}
    entries["run_id"] = _name(folder.name) if files or other else RUN["run_id"]
    rows: list[dict[str, str]] = []
    for name, file in files.items():
        found, by = known_channels(name, file)
        rows += found
        notes |= by
    remarks: list[str] = []
    if other is not None:
        entries |= _of(other)
        notes |= {key: Proposal(entries[key], f"{other.form.run_id}, which it is like") for key in _of(other)}
        rows, by, remarks = like_rows(other, rows, notes)
        notes = by
    known = Known()
    if files:
        entries |= dict.fromkeys(("start_utc", "protocol", "f_cmd", "E_cmd"))
        theirs = {key: value for key, value in _of(other).items() if key in entries} if other else {}
        known = _without(known_run(files, [Cells(row, "") for row in rows], protocol), theirs)
        entries |= theirs | known.entries
    if protocol is not None:
        entries["protocol"] = protocol
    if entries["protocol"] == "ringdown":
        entries |= {"ball": False, "settle": 0.0, "f_cmd": None, "E_cmd": None}
    _make(folder, recordings)
    kept = {key: note for key, note in {**notes, **known.notes}.items() if "." in key or entries.get(key) == note.value}
    texts = {
        "run.json": json_text(entries, known.said, kept),
        "channels.tsv": table_text(rows),
        "README.md": run_readme(),
    }
    return _write(folder, texts, (*known.said, *remarks))


def init_campaign(folder: Path, recordings: Sequence[Path] = (), protocol: str | None = None) -> Written:
    """Write a campaign: ``rig.json`` and ``channels.tsv`` for all runs, and a run folder for each recording.

    Parameters
    ----------
    folder : Path
        Where. One that is a campaign already gets the runs.
    recordings : sequence of Path
        One a run, which is called as it; a folder stands for those in it.
    protocol : str, optional
        What was done in all of them.

    Raises
    ------
    StoreError
        If there are runs of these names, or other files in the way; nothing is overwritten.
    FileMissingError, RigError
        If a recording cannot be read.
    """
    recordings = _expanded(recordings)
    names = [_name(path.stem) for path in recordings]
    for name, path in zip(names, recordings, strict=True):
        if names.count(name) > 1:
            raise RigError(f"{path}: two of the recordings would be called {name!r}; add one with 'init RUN --from'")
        _free(folder / name, ("run.json", "channels.tsv"))
    written: list[Path] = []
    remarks: list[str] = []
    todo: dict[Path, int] = {}
    if not (folder / CAMPAIGN).is_file():
        _free(folder, (CAMPAIGN, "run.json", "channels.tsv", "README.md"))
        files = _read(recordings)
        rows, notes = shared_rows(files)
        folder.mkdir(parents=True, exist_ok=True)
        texts = {
            CAMPAIGN: json_text(SHARED, (), notes),
            "channels.tsv": table_text(rows),
            "README.md": campaign_readme(),
        }
        made = _write(folder, texts, ())
        written += made.files
        todo |= made.todo
    for name, path in zip(names, recordings, strict=True):
        made = init_run(folder / name, (path,), None, protocol)
        written += made.files
        remarks += made.remarks
        todo |= made.todo
    return Written(tuple(written), tuple(remarks), todo)


def _in_campaign(
    folder: Path,
    recordings: Sequence[Path],
    files: Mapping[str, RawFile],
    other: RunFolder | None,
    protocol: str | None,
    shared: Path,
) -> Written:
    """Write what is a run's own."""
    table = shared.parent / "channels.tsv"
    base = spread_all(read_cells(table)) if table.is_file() else ()
    own, placed, remarks = differing_rows(base, files)
    known = known_run(files, placed, protocol) if files else Known()
    entries: dict[str, Any] = dict.fromkeys(("start_utc", "protocol", "f_cmd", "E_cmd"))
    notes: dict[str, Proposal] = {}
    if other is not None:
        said = read_json(other.path / "run.json")
        theirs = {key: value for key, value in _of(other).items() if key in said or not other.inherits}
        entries |= theirs
        notes = {key: Proposal(value, f"{other.form.run_id}, which it is like") for key, value in theirs.items()}
    known = _without(known, entries)
    entries |= known.entries
    notes |= known.notes
    if protocol is not None:
        entries["protocol"] = protocol
    if entries["protocol"] == "ringdown":
        entries = {key: value for key, value in entries.items() if key not in ("f_cmd", "E_cmd", "settle")}
    elif entries["f_cmd"] is None:
        entries.pop("f_cmd")
    entries |= {"temperature_before": None, "temperature_after": None}
    kept = {key: note for key, note in notes.items() if entries.get(key) == note.value}
    _make(folder, recordings)
    texts = {"run.json": json_text(entries, known.said, kept)}
    if own:
        used = [name for name in COLUMNS if any(row.get(name) for row in own)]
        texts["channels.tsv"] = table_text(own, used)
    return _write(folder, texts, (*known.said, *(f"{folder.name}: {each}" for each in remarks)))


def _without(known: Known, theirs: Mapping[str, Any]) -> Known:
    """Return what is known less what a like run says better: which way a sweep went, and a command that fits."""
    entries = dict(known.entries)
    if entries.get("protocol") == "dwell" and theirs.get("protocol") in ("sweep_up", "sweep_down"):
        del entries["protocol"]
    f, command = entries.get("f_cmd"), theirs.get("f_cmd")
    if f and command and abs(f / command - 1) < _SAME_COMMAND:
        del entries["f_cmd"]
    return Known(entries, {key: note for key, note in known.notes.items() if key in entries}, known.said)


def _of(other: RunFolder) -> dict[str, Any]:
    """Return what another run says that may hold for this one too."""
    told = msgspec.to_builtins(other.form)
    return {key: told[key] for key in RUN if key not in (*_AGAIN, "run_id")}


def _expanded(recordings: Sequence[Path]) -> tuple[Path, ...]:
    """Return the recordings, those in a folder for the folder: what has the suffix of a format and no other beside."""
    suffixes = {suffix for each in FORMATS.all().values() for suffix in each.suffixes}
    found: list[Path] = []
    for path in recordings:
        if not path.is_dir():
            found.append(path)
            continue
        held = sorted(each for each in path.iterdir() if each.is_file() and each.suffix.lower() in suffixes)
        if not held:
            raise FileMissingError(f"{path}: no recording in it; read are files with {', '.join(sorted(suffixes))}")
        found += held
    return tuple(found)


def _read(recordings: Sequence[Path]) -> dict[str, RawFile]:
    names = [path.name for path in recordings]
    for path in recordings:
        if names.count(path.name) > 1:
            raise RigError(f"two recordings are called {path.name}; raw/ holds one of a name: rename one")
    return {path.name: read_file(path) for path in recordings}


def _name(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", text).strip("_.-") or "run_001"


def _free(folder: Path, names: Sequence[str]) -> None:
    if folder.exists() and not folder.is_dir():
        raise StoreError(f"{folder} is a file; choose another name for the folder")
    for name in names:
        if (folder / name).exists():
            raise StoreError(f"{folder / name} exists already; nothing is overwritten: choose another folder")


def _make(folder: Path, recordings: Sequence[Path]) -> None:
    """Make the folders, and copy recordings with their sidecars into ``raw/``."""
    for name in ("raw", "derived"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for path in recordings:
        for each in (path, path.with_name(path.name + ".json")):
            kept = folder / "raw" / each.name
            if not each.is_file() or (kept.exists() and kept.samefile(each)):
                continue
            if kept.exists():
                raise StoreError(f"{kept} exists already; raw files are never overwritten: choose another folder")
            shutil.copy2(each, kept)


def _write(folder: Path, texts: Mapping[str, str], remarks: Sequence[str]) -> Written:
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    # Whether another instrument gave the amplitude is the laboratory's to say.
    empty = {name: text.count(": null") - text.count('"E_meas": null') for name, text in texts.items()}
    todo = {folder / name: count for name, count in empty.items() if name.endswith(".json")}
    return Written(tuple(folder / name for name in texts), tuple(remarks), {k: n for k, n in todo.items() if n})
