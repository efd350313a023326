"""A recording that dwells at several levels, as run folders that share its raw files."""

from __future__ import annotations

import os
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

import msgspec
import numpy as np

from vines.errors import RigError, StoreError
from vines.rig.fit import bins_of
from vines.rig.ingest import RECORDING, SUMS, Part, Proposal, RunForm, channels_text, read_run
from vines.rig.quantities import Dwell, dwells, envelope, measure_base

__all__ = ["Piece", "split_run"]


@dataclass(frozen=True, slots=True)
class Piece:
    """A dwell that was found, and its run folder.

    Attributes
    ----------
    dwell : Dwell
        Where the base was steady; its size is E [m].
    folder : Path or None
        The run folder; None where too little is left after the settling.
    made : bool
        Whether it was written now; it was there already if not.
    begin : float
        From where it counts, after the settling [s].
    """

    dwell: Dwell
    folder: Path | None
    made: bool
    begin: float


def split_run(run: Path, out: Path | None = None, *, settle: float = 30.0, shortest: int = 20) -> tuple[Piece, ...]:
    """Find the dwells of a recording and make a run folder of each, with the raw files left where they are.

    Parameters
    ----------
    run : Path
        The run folder of the whole recording.
    out : Path, optional
        Where the run folders go, called ``NAME_1``, ``NAME_2``, …; beside the run if left out.
    settle : float
        Left out at the begin of a dwell [s]; before the first one the recording's own ``settle`` counts.
    shortest : int
        Forcing periods that must be left.

    Raises
    ------
    RigError
        If the run cannot be read, is a ring-down or a part itself, or holds less than two dwells.
    StoreError
        If a folder of that name is there and another one.
    """
    read = read_run(run)
    folder = read.folder
    assert folder is not None
    form = folder.form
    if form.protocol == "ringdown":
        raise RigError(f"run {form.run_id} is a ring-down; runs with the base moving have dwells")
    if form.part is not None:
        raise RigError(f"run {form.run_id} is a part of {form.part.of} already; split that")
    base = measure_base(read.recording)
    shape = envelope(bins_of(base.channel), base.f.value)
    found = dwells(shape)
    if len(found) < 2:
        what = "no dwell: the amplitude of the base never stays" if not found else "one dwell only"
        raise RigError(f"run {form.run_id} holds {what}; there is nothing to split")
    scale = float(abs(base.e[0]) / abs(base.fit.harmonics[0]))
    where = run.parent if out is None else out
    starts, stop = float(shape.t[0]), float(shape.t[-1])
    pieces: list[tuple[Piece, dict[str, bytes]]] = []
    number = 0
    for dwell in found:
        first = dwell.begin <= starts
        begin = dwell.begin + (max(settle - form.settle, 0.0) if first else settle)
        dwell = Dwell(dwell.begin, dwell.end, float(dwell.size * scale))  # noqa: PLW2901
        if (dwell.end - begin) * base.f.value < shortest:
            pieces.append((Piece(dwell, None, False, begin), {}))
            continue
        number += 1
        name = f"{run.resolve().name}_{number}"
        target = where / name
        texts = {
            "run.json": _form(form, dwell, begin, name, os.path.relpath(run.resolve(), target.resolve()), stop),
            "channels.tsv": channels_text(folder.rows).encode(),
            SUMS: "".join(f"{value}  {path}\n" for path, value in read.sums.items()).encode(),
        }
        pieces.append((Piece(dwell, target, not target.exists(), begin), texts))
    if not number:
        raise RigError(
            f"run {form.run_id} holds {len(found)} dwells, but none has {shortest} periods left after {settle:g} s of "
            "settling; see --settle and --shortest"
        )
    for piece, texts in pieces:
        if piece.folder is not None and not piece.made and not _same(piece.folder, texts):
            raise StoreError(f"{piece.folder} exists and is not what would be written; remove it or choose --out")
    for piece, texts in pieces:
        if piece.folder is not None and piece.made:
            _write(piece.folder, texts)
    return tuple(piece for piece, _ in pieces)


def _form(form: RunForm, dwell: Dwell, begin: float, name: str, of: str, stop: float) -> bytes:
    """Return ``run.json`` of a dwell."""
    E = float(f"{dwell.size:.5g}")
    source = f"{RECORDING}(the base in this dwell)"
    shares = np.clip([begin / stop, dwell.end / stop], 0, 1)
    warm = form.temperature_before + shares * (form.temperature_after - form.temperature_before)
    began = datetime.fromisoformat(form.start_utc.replace("Z", "+00:00")) + timedelta(seconds=max(begin, 0.0))
    made = msgspec.structs.replace(
        form,
        run_id=name,
        start_utc=began.strftime("%Y-%m-%dT%H:%M:%S.%f")[:-3] + "Z",
        E_cmd=E,
        settle=round(begin - dwell.begin, 3) if begin > dwell.begin else form.settle,
        temperature_before=round(float(warm[0]), 3),
        temperature_after=round(float(warm[1]), 3),
        E_meas=None,
        part=Part(of, round(begin, 4), round(dwell.end, 4)),
        proposed={**form.proposed, "E_cmd": Proposal(E, source)},
    )
    return msgspec.json.format(msgspec.json.encode(made), indent=2) + b"\n"


def _same(folder: Path, texts: dict[str, bytes]) -> bool:
    return all((folder / name).is_file() and (folder / name).read_bytes() == text for name, text in texts.items())


def _write(folder: Path, texts: dict[str, bytes]) -> None:
    """Write a run folder whole: under another name first."""
    partial = folder.with_name(f".{folder.name}.part")
    partial.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (partial / name).write_bytes(text)
    (partial / "derived").mkdir(exist_ok=True)
    partial.rename(folder)
