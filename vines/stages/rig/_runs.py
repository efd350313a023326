"""Run folders of a needed stage, their ring-downs, and reconstructions that are kept for the next time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

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
from vines.store import key_of

__all__ = ["Work", "free_decay", "kept_runs", "make", "ring_downs_of", "wanted"]


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


def ring_downs_of(runs: Mapping[str, tuple[Path, RunInfo]]) -> dict[str, tuple[str, ...]]:
    """Return for each run with the ball the names of the ring-downs that belong to it.

    Raises
    ------
    RigError
        If a run has none.
    """
    known = [info for _, info in runs.values()]
    return {name: match_ring_downs(info, known) for name, (_, info) in runs.items() if info.protocol != "ringdown"}


def free_decay(folder: Path) -> RingDown:
    """Return omega0 and lam of the ring-down in a run folder."""
    return ring_down(read_run(folder).recording)


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
        "files": {**raw_sums(held), "run": (folder / "run.json").read_text("utf-8")},
        "channels": (folder / "channels.tsv").read_text("utf-8-sig"),
        "ring_downs": [repr(one) for one in ring_downs],
    }
    return Work(folder, tuple(ring_downs), seed, cache / "rig" / f"{key_of(form)[:32]}.npz")


def make(work: Work) -> str:
    """Reconstruct a run and keep it, unless it is kept already; return why that cannot be done, empty if it can."""
    if work.kept.is_file():
        return ""
    try:
        found = reconstruct(read_run(work.folder).recording, work.ring_downs, seed=work.seed)
    except RigError as refused:
        return str(refused)
    work.kept.parent.mkdir(parents=True, exist_ok=True)
    partial = work.kept.with_suffix(".part")
    save_reconstruction(found, partial)
    partial.replace(work.kept)
    return ""
