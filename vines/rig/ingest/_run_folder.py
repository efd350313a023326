"""A run folder in the manner of BIDS: ``run.json``, ``channels.tsv``, ``raw/`` untouched, ``derived/``.

Run folders that lie in one folder with a ``rig.json`` are a campaign: what that and a ``channels.tsv`` beside it say
holds for all of them.
"""

from __future__ import annotations

import fnmatch
import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from vines.errors import FileMissingError, RigError
from vines.rig.ingest._channel_table import Cells, check_rows, laid_over, read_cells, row_of, spread_all
from vines.rig.ingest._run_form import ChannelRow, Proposal, RunForm
from vines.rig.ingest._run_json import stated_run
from vines.rig.recording import RunInfo, Uncertain

__all__ = [
    "CAMPAIGN",
    "SUMS",
    "RunFolder",
    "check_sums",
    "find_runs",
    "raw_sums",
    "read_folder",
    "run_info",
    "stated_files",
]

SUMS = "SHA256SUMS"
"""File beside ``raw/`` with the SHA-256 of each raw file, in the form that ``sha256sum --check`` reads."""

CAMPAIGN = "rig.json"
"""File beside run folders with what they share."""


@dataclass(frozen=True, slots=True)
class RunFolder:
    """A run folder as it was read.

    Attributes
    ----------
    path : Path
        The folder.
    form : RunForm
        What ``run.json`` says, with what it takes from its campaign.
    rows : tuple of ChannelRow
        What ``channels.tsv`` says, likewise.
    stated : tuple of Path
        The files that say so.
    came_from : mapping of str to str
        Where the entries of `form` stand; without a campaign what ``vines rig init`` filled in.
    overruled : tuple of str
        What of ``rig.json`` the run overrules, with the reasons.
    cells_from, cells_overruled : mapping
        The same of the cells of each channel, by its name.
    """

    path: Path
    form: RunForm
    rows: tuple[ChannelRow, ...]
    stated: tuple[Path, ...] = ()
    came_from: Mapping[str, str] = field(default_factory=dict)
    overruled: tuple[str, ...] = ()
    cells_from: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    cells_overruled: Mapping[str, str] = field(default_factory=dict)

    @property
    def info(self) -> RunInfo:
        """The run as the rest of the room knows it."""
        return run_info(self.form)

    @property
    def inherits(self) -> bool:
        """Whether it belongs to a campaign."""
        return any(path.name == CAMPAIGN for path in self.stated)

    @property
    def home(self) -> Path:
        """The run folder that has the raw files: its own, or that of the recording that it is a part of."""
        return _home(self.path, self.form)

    @property
    def raw_files(self) -> tuple[Path, ...]:
        """The files that the channels name, each once, in their order."""
        return tuple(dict.fromkeys(self.home / "raw" / row.file for row in self.rows))

    @property
    def sidecars(self) -> tuple[Path, ...]:
        """The sidecars of the raw files that have one: ``<file>.json``."""
        beside = (path.with_name(path.name + ".json") for path in self.raw_files)
        return tuple(path for path in beside if path.is_file())


def _home(folder: Path, form: RunForm) -> Path:
    return folder if form.part is None else folder / form.part.of


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

    A folder with ``raw/`` or ``channels.tsv`` counts: where its ``run.json`` is missing, that is said of this run.

    Raises
    ------
    FileMissingError
        If there is none.
    """
    if (folder / "run.json").is_file():
        return (folder,)
    found = tuple(sorted(path for path in folder.glob("*/") if _is_run(path)))
    if not found:
        raise FileMissingError(
            f"{folder}: no run folder and none in it: there is no run.json; 'vines rig init DIR' makes a template"
        )
    return found


def _is_run(path: Path) -> bool:
    return (path / "run.json").exists() or (path / "channels.tsv").exists() or (path / "raw").is_dir()


def read_folder(folder: Path) -> RunFolder:
    """Read ``run.json`` and ``channels.tsv``, with what they take from the two forms of the campaign, beside the run.

    Raises
    ------
    FileMissingError
        If one of them, or a raw file that they name, does not exist.
    RigError
        If they don't say what they must; one line.
    """
    told, table = folder / "run.json", folder / "channels.tsv"
    above = folder.absolute().parent
    shared = above / CAMPAIGN if (above / CAMPAIGN).is_file() else None
    base = above / table.name if shared and (above / table.name).is_file() else None
    if not told.is_file():
        raise FileMissingError(f"{told} is missing; 'vines rig init DIR' makes a template")
    if not table.is_file() and base is None:
        beside = "" if shared is None else f", and so is {above / table.name}"
        raise FileMissingError(f"{table} is missing{beside}; 'vines rig init DIR' makes a template")
    run = stated_run(told, shared)
    own = read_cells(table) if table.is_file() else ()
    if base is None:
        cells, cells_from, notes = spread_all(own), {}, {}
    else:
        cells, cells_from, notes = laid_over(own, read_cells(base), run.form.overrule)
    where = str(table if base is None or own else base)
    if not cells:
        raise RigError(f"{where}: no channels; it needs one row a channel")
    home = _home(folder, run.form)
    if run.form.part is not None and not (home / "raw").is_dir():
        raise FileMissingError(f"{told}: it is a part of {run.form.part.of}, and there is no {home / 'raw'}")
    rows = tuple(row_of(_with_file(row, home)) for row in cells)
    cells_from = {row.name: _proposed(row, dict(cells_from.get(row.name, {})), run.form.proposed) for row in cells}
    check_rows(rows, where)
    stated = tuple(path for path in (told, table if own else None, shared, base) if path is not None)
    found = RunFolder(folder, run.form, rows, stated, run.came_from, run.overruled, cells_from, notes)
    for path in found.raw_files:
        if not path.resolve().is_relative_to((home / "raw").resolve()):
            raise RigError(f"{where}: file {path.name!r} is not below raw/; raw files are kept there")
        if not path.is_file():
            raise FileMissingError(f"{path} is missing; {where} names it")
    return found


def stated_files(folder: Path) -> tuple[Path, ...]:
    """Return every file that a run folder consists of and that can be read, whether the run can or not."""
    above = folder.absolute().parent
    forms = [folder / "run.json", folder / "channels.tsv", folder / SUMS]
    forms += [above / CAMPAIGN, above / "channels.tsv"] if (above / CAMPAIGN).is_file() else []
    files = [*forms, *sorted((_raw_of(folder)).rglob("*"))]
    return tuple(path for path in files if path.is_file() and os.access(path, os.R_OK))


def _raw_of(folder: Path) -> Path:
    """Return where the raw files of a run folder are, whether it can be read or not."""
    try:
        return read_folder(folder).home / "raw"
    except (RigError, FileMissingError):
        return folder / "raw"


def _proposed(row: Cells, came_from: dict[str, str], notes: Mapping[str, Proposal]) -> dict[str, str]:
    """Return where the cells of a row come from, with those that ``vines rig init`` filled in."""
    for key, text in row.cells.items():
        note = notes.get(f"{row.name}.{key}")
        if note is not None and note.value == text:
            came_from[key] = f"proposed by {note.by}"
    return came_from


def _with_file(row: Cells, folder: Path) -> Cells:
    """Return a row whose file is one of the run, where it names it by a pattern."""
    pattern = row.cells.get("file", "")
    if not any(sign in pattern for sign in "*?["):
        return row
    raw = folder / "raw"
    names = sorted(path.relative_to(raw).as_posix() for path in raw.rglob("*") if path.is_file())
    beside = {name for name in names if name.endswith("_index") or name.removesuffix(".json") in set(names) - {name}}
    held = [name for name in names if name not in beside]
    fits = [name for name in held if fnmatch.fnmatchcase(name, pattern)]
    if not fits:
        has = f"there is {', '.join(held)}" if held else "it is empty"
        raise FileMissingError(f"{raw}: no file fits {pattern!r}, by which {row.where} names it; {has}")
    if len(fits) > 1:
        raise RigError(
            f"{raw}: {len(fits)} files fit {pattern!r}, by which {row.where} names one: {', '.join(fits)}; "
            "write a row with its file into channels.tsv of the run"
        )
    return Cells({**row.cells, "file": fits[0]}, row.where)


def raw_sums(folder: RunFolder) -> dict[str, str]:
    """Return the SHA-256 of each raw file by its path in the run folder.

    Raises
    ------
    RigError
        If one cannot be read.
    """
    sums = {}
    for path in (*folder.raw_files, *folder.sidecars):
        try:
            with path.open("rb") as stream:
                digest = hashlib.file_digest(stream, "sha256").hexdigest()
        except OSError as error:
            raise RigError(f"run {folder.form.run_id}: {path} cannot be read: {error.strerror}") from None
        sums[path.relative_to(folder.home).as_posix()] = digest
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
