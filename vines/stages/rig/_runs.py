"""Run folders of a needed stage, their ring-downs, and reconstructions that are kept for the next time."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vines.errors import RigError
from vines.pipeline import Input
from vines.rig import (
    RingDown,
    RunInfo,
    find_runs,
    match_ring_downs,
    read_folder,
    read_run,
    reconstruct,
    ring_down,
    save_reconstruction,
)
from vines.rig.ingest import raw_sums
from vines.stages.rig._refused import reason_of
from vines.store import key_of

__all__ = ["Work", "free_decay", "kept_runs", "make", "refused_runs", "ring_downs_of", "wanted"]


@dataclass(frozen=True, slots=True)
class Work:
    """A run to be reconstructed; travels to a worker process.

    Attributes
    ----------
    folder : Path
        The run folder.
    ring_downs : tuple of RingDown
        Those that belong to it.
    seed : int
        Of the draws for uncertainties.
    kept : Path
        File of its reconstruction, named by everything that it depends on.
    """

    folder: Path
    ring_downs: tuple[RingDown, ...]
    seed: int
    kept: Path


def kept_runs(inputs: Mapping[str, Input]) -> dict[str, tuple[Path, RunInfo]]:
    """Return folder and description of each run that stages of kind ``ingest`` kept, by its name.

    Raises
    ------
    RigError
        If two runs have one name.
    """
    found: dict[str, tuple[Path, RunInfo]] = {}
    for stage in inputs.values():
        for path in find_runs(stage.folder / "runs"):
            info = read_folder(path).info
            if info.run_id in found:
                raise RigError(f"two of the needed stages have a run {info.run_id!r}; run_id must be unique")
            found[info.run_id] = (path, info)
    return found


def refused_runs(inputs: Mapping[str, Input]) -> list[dict[str, Any]]:
    """Return the rows of ``rig_runs`` of runs that stages of kind ``ingest`` could not read, but for ring-downs."""
    rows = [row for stage in inputs.values() for row in stage.table("rig_runs").to_pylist()]
    return [row for row in rows if row["status"] == "failed" and row["protocol"] != "ringdown"]


def ring_downs_of(
    runs: Mapping[str, tuple[Path, RunInfo]], usable: Collection[str]
) -> tuple[dict[str, tuple[str, ...]], dict[str, str]]:
    """Return for each run with the ball the names of the ring-downs that belong to it, and why some have none.

    Parameters
    ----------
    runs : mapping
        As `kept_runs` gives them.
    usable : collection of str
        Ring-downs that gave omega0 and lam; a run that names another has none.
    """
    known = [info for name, (_, info) in runs.items() if name in usable]
    found, lost = {}, {}
    for name, (_, info) in runs.items():
        if info.protocol == "ringdown":
            continue
        try:
            found[name] = match_ring_downs(info, known)
        except RigError as missing:
            lost[name] = str(missing)
    return found, lost


def free_decay(folder: Path) -> RingDown | str:
    """Return omega0 and lam of the ring-down in a run folder, or why there are none."""
    try:
        return ring_down(read_run(folder).recording)
    except Exception as error:
        return reason_of(error)


def wanted(folder: Path, ring_downs: Sequence[RingDown], seed: int, code: str, cache: Path) -> Work:
    """Return the work of a run; its file is named by the digest of the code, of the run folder and of the ring-downs.

    Parameters
    ----------
    folder : Path
        The run folder.
    ring_downs : sequence of RingDown
        Those that belong to it.
    seed : int
        Of the draws for uncertainties.
    code : str
        Digest of the code that reconstructs.
    cache : Path
        Folder for what can be made again.
    """
    held = read_folder(folder)
    form = {
        "code": code,
        "seed": seed,
        "files": raw_sums(held),
        "stated": [path.read_text("utf-8-sig") for path in held.stated],
        "ring_downs": [repr(one) for one in ring_downs],
    }
    return Work(folder, tuple(ring_downs), seed, cache / "rig" / f"{key_of(form)[:32]}.npz")


def make(work: Work) -> str:
    """Reconstruct a run and keep it, unless it is kept already; return why that cannot be done, empty if it can."""
    if work.kept.is_file():
        return ""
    try:
        found = reconstruct(read_run(work.folder).recording, work.ring_downs, seed=work.seed)
    except Exception as error:
        # Whatever one run makes the methods stumble over is its own; the campaign goes on.
        return reason_of(error)
    work.kept.parent.mkdir(parents=True, exist_ok=True)
    partial = work.kept.with_suffix(".part")
    save_reconstruction(found, partial)
    partial.replace(work.kept)
    return ""
