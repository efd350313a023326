"""From a run folder to a `Recording`: every channel in SI, on one clock, checked against the others."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from vines.errors import RigError
from vines.rig.formats import RawChannel, RawFile, read_file
from vines.rig.ingest._agreement import check_agreement
from vines.rig.ingest._calibrate import U_CORNER, Calibrated, calibrate
from vines.rig.ingest._clock import Clock, align_clocks
from vines.rig.ingest._frames import whole_frames
from vines.rig.ingest._overrule import Overruling
from vines.rig.ingest._run_folder import RunFolder, check_sums, raw_sums, read_folder, run_info
from vines.rig.ingest._run_form import RECORDING, ChannelRow, Part, RunForm
from vines.rig.ingest._run_json import holding
from vines.rig.ingest._sampling import check_starts
from vines.rig.recording import ROLES, Recording, Sampled

__all__ = ["Ingested", "assemble", "read_run"]

_LEAST = 16


@dataclass(frozen=True, slots=True, eq=False)
class Ingested:
    """A run as it was read, and what was found on the way.

    Attributes
    ----------
    recording : Recording
        The run in SI.
    rows : mapping of str to ChannelRow
        What ``channels.tsv`` says of each channel.
    clipped : mapping of str to int
        Samples of each channel that are at the end of its range.
    clocks : mapping of str to Clock
        How the clock of each recorder runs.
    sums : mapping of str to str
        SHA-256 of each raw file.
    compared : tuple of str
        What was compared, in words.
    read_as : mapping of str to str
        Format of the file of each channel, with the layout of a text.
    overruled : mapping of str to str
        What of its file was overruled for each channel, with the reasons.
    remarks : mapping of str to str
        What was found in reading each channel and has to be known.
    folder : RunFolder or None
        Its run folder, where it was read from one.
    """

    recording: Recording
    rows: Mapping[str, ChannelRow]
    clipped: Mapping[str, int]
    clocks: Mapping[str, Clock]
    sums: Mapping[str, str]
    compared: tuple[str, ...]
    read_as: Mapping[str, str] = field(default_factory=dict)
    overruled: Mapping[str, str] = field(default_factory=dict)
    remarks: Mapping[str, str] = field(default_factory=dict)
    folder: RunFolder | None = None


def read_run(path: Path) -> Ingested:
    """Read a run folder; nothing is written.

    Parameters
    ----------
    path : Path
        The folder with ``run.json``.

    Raises
    ------
    FileMissingError
        If a file is missing.
    RigError
        If the run can't be used as it is; one line says why.
    """
    folder = read_folder(path)
    sums = raw_sums(folder)
    check_sums(folder, sums)
    with _named(folder.form.run_id):
        files = {name: _read(folder, name) for name in dict.fromkeys(row.file for row in folder.rows)}
    return replace(assemble(folder.form, folder.rows, files, sums), folder=folder)


def _read(folder: RunFolder, name: str) -> RawFile:
    """Read a file as its rows state it."""
    rows = [row for row in folder.rows if row.file == name]
    stated = {row.dialect for row in rows if row.dialect}
    channels = ", ".join(row.name for row in rows)
    if len(stated) > 1:
        raise RigError(f"{channels} (raw/{name}): their rows state {len(stated)} dialects of one file; write one")
    try:
        return read_file(folder.home / "raw" / name, next(iter(stated), ""))
    except RigError as error:
        raise RigError(f"{channels}: raw/{error}") from None


@contextmanager
def _named(run: str) -> Iterator[None]:
    """Name the run in what is refused."""
    try:
        yield
    except RigError as error:
        raise RigError(f"run {run}: {error}") from None


def assemble(
    form: RunForm, rows: tuple[ChannelRow, ...], files: Mapping[str, RawFile], sums: Mapping[str, str]
) -> Ingested:
    """Return a run from its description and what its files hold.

    Parameters
    ----------
    form, rows
        ``run.json`` and ``channels.tsv``.
    files : mapping of str to RawFile
        By their path below ``raw/``.
    sums : mapping of str to str
        SHA-256 of the raw files by their path in the run folder.

    Raises
    ------
    RigError
        If the run can't be used as it is.
    """
    with _named(form.run_id):
        return _assemble(form, rows, files, sums)


def _assemble(
    form: RunForm, rows: tuple[ChannelRow, ...], files: Mapping[str, RawFile], sums: Mapping[str, str]
) -> Ingested:
    info = run_info(form)
    raw = [(row, _field(row, files[row.file]), Overruling(row.overrule)) for row in rows]
    raw = [(row, whole_frames(each) if row.role == "ball_cam" else each, why) for row, each, why in raw]
    calibrated = [
        calibrate(row, channel, max_clipped=form.max_clipped, overruling=reasons) for row, channel, reasons in raw
    ]
    check_starts(raw)
    clocks = align_clocks(calibrated, max_offset=form.max_offset, ringdown=info.protocol == "ringdown")
    channels = [_on_the_clock(channel, clocks[channel.row.recorder]) for channel in calibrated]
    if form.part is not None:
        channels = [_cut(channel, form.part) for channel in channels]
    if not any(channel.role in ("lo_disp", "lo_vel", "lo_acc") for channel in channels):
        raise RigError("no channel measures the oscillator (roles lo_disp, lo_vel, lo_acc)")
    if info.protocol != "ringdown" and not any(channel.role.startswith("base") for channel in channels):
        raise RigError("no channel measures the base (base_disp, base_vel, base_acc); a command is no measurement")
    measured = [key for key, note in holding(form).items() if note.by.startswith(RECORDING)]
    compared = check_agreement(info, channels, [key for key in measured if key in ("f_cmd", "E_cmd")])
    together = hashlib.sha256(
        "".join(f"{value}  {name}\n" for name, value in sorted(sums.items())).encode()
    ).hexdigest()
    return Ingested(
        recording=Recording(info, {channel.name: channel for channel in channels}, together),
        rows={row.name: row for row in rows},
        clipped={channel.row.name: channel.clipped for channel in calibrated},
        clocks=clocks,
        sums=dict(sums),
        compared=compared,
        read_as={row.name: f"{files[row.file].form} {files[row.file].dialect}".strip() for row in rows},
        overruled={row.name: "; ".join(reasons.used) for row, _, reasons in raw},
        remarks={
            channel.row.name: "; ".join((*files[channel.row.file].remarks, *channel.remarks)) for channel in calibrated
        },
    )


def _cut(channel: Sampled, part: Part) -> Sampled:
    """Return a stretch of a channel."""
    first = max(round((part.begin - channel.start) * channel.rate), 0)
    last = min(round((part.end - channel.start) * channel.rate), len(channel.values))
    if last - first < _LEAST:
        raise RigError(
            f"{channel.where}: it has {max(last - first, 0)} samples from {part.begin:g} to {part.end:g} s, the part "
            "that run.json asks for; a run needs more"
        )
    kept = slice(first, last)
    return replace(
        channel,
        start=channel.start + first / channel.rate,
        values=channel.values[kept],
        valid=channel.valid[kept],
    )


def _field(row: ChannelRow, file: RawFile) -> RawChannel:
    """Return what the file holds of a channel."""
    try:
        return file.channel(row.field)
    except RigError as missing:
        raise RigError(f"{row.where}: {missing}") from None


def _on_the_clock(channel: Calibrated, clock: Clock) -> Sampled:
    """Return a channel on the clock of the run."""
    row = channel.row
    quantity, unit = ROLES[row.role]
    told = {
        "quantity": quantity,
        "unit": unit,
        "sign": "positive to the right",
        "role": row.role,
        "dof": row.dof,
        "sensor": row.sensor,
        "serial": row.serial,
        "calibrated": row.calibrated,
        "sensitivity": "scaled" if row.sensitivity == "scaled" else f"{row.sensitivity:g} {row.sensitivity_unit}",
        "file": row.file,
        "field": row.field,
        "recorder": row.recorder,
        "clock": clock.how,
        "bursts": channel.bursts,
    }
    return Sampled(
        name=row.name,
        role=row.role,
        rate=channel.rate / clock.pace,
        start=clock.offset + clock.pace * channel.start,
        values=channel.values,
        valid=channel.valid,
        u_gain=row.u_sensitivity,
        u_time=(clock.u**2 + row.u_delay**2) ** 0.5,
        u_high_pass=U_CORNER * row.high_pass,
        about={key: text for key, text in told.items() if text},
    )
