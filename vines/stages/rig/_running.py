"""Ingesting run folders by hand: a pipeline of one stage, so that it is kept, keyed and asked for like every other."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from vines.errors import FileMissingError, RigError, RunFailed
from vines.pipeline import Declaration
from vines.rig import find_runs
from vines.stages.api._asking import query
from vines.stages.api._home import Home, current
from vines.stages.api._running import run, status

if TYPE_CHECKING:
    from vines.pipeline import RunSummary

__all__ = ["IngestedFolder", "ingest_folder", "pipeline_of"]


@dataclass(frozen=True, slots=True)
class IngestedFolder:
    """What became of a folder of runs.

    Attributes
    ----------
    name : str
        Of the pipeline that holds them; its stage is ``ingest``.
    runs : tuple of str
        The run folders.
    summary : RunSummary or None
        What was done; ``None`` if all were there already.
    refused : mapping of str to str
        Why runs could not be read, by name.
    """

    name: str
    runs: tuple[str, ...]
    summary: RunSummary | None
    refused: Mapping[str, str]


def pipeline_of(folder: Path, root: Path) -> str:
    """Return the name of the pipeline under which a folder's runs are kept: of its path, as other folders may be alike.

    Parameters
    ----------
    folder : Path
        Its path below the root of the project counts; elsewhere its name.
    root : Path
        That root.

    Examples
    --------
    >>> root = Path("study")
    >>> [pipeline_of(root / each, root) for each in ("march/Run 12", "rig_a", "demo/runs")]
    ['rig_march_run_12', 'rig_a', 'rig_demo_runs']
    """
    root, place = root.resolve(), folder.resolve()
    path = place.relative_to(root).as_posix() if place.is_relative_to(root) else place.name
    name = re.sub(r"[^a-z0-9]+", "_", path.casefold()).strip("_") or "runs"
    return name if name.startswith("rig_") else f"rig_{name}"


def ingest_folder(folder: Path, *, log_rate: float = 2048.0, study: Home | None = None) -> IngestedFolder:
    """Ingest the run folders at or directly below a folder; one that cannot be read leaves the others.

    Parameters
    ----------
    folder : Path
        A run folder, or one with run folders in it.
    log_rate : float
        Samples a second of a channel in the logs at most; 0 keeps all.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Raises
    ------
    FileMissingError
        If there is no run folder.
    RigError
        If no run can be read; the message says why. Nothing is stored then.
    """
    if not folder.is_dir():
        raise FileMissingError(f"{folder}: there is no such folder; 'vines rig init {folder}' makes a template")
    runs = tuple(path.name for path in find_runs(folder))
    study = study or current()
    root, place = study.root, folder.resolve()
    told = place.relative_to(root) if place.is_relative_to(root) else place
    name = pipeline_of(folder, root)
    declared = Declaration(name, title=f"Runs of {folder.resolve().name}", source="docs/rig.md")
    declared.stage("ingest", "ingest", folder=told.as_posix(), log_rate=log_rate)
    if all(plan.state == "up_to_date" for plan in status(declared, study=study)):
        return IngestedFolder(name, runs, None, _refused(name, study))
    try:
        return IngestedFolder(name, runs, run(declared, study=study), _refused(name, study))
    except RunFailed as failure:
        # The engine says what a stage of many points needs to hear; here the reason alone is the message.
        reason = str(failure).partition("RigError: ")[2].partition("; the rest is stored")[0]
        if not reason:
            raise
        raise RigError(f"{folder}: {reason}") from None


def _refused(name: str, study: Home) -> dict[str, str]:
    asked = f"select run_id, reason from rig_runs where pipeline = '{name}' and status = 'failed'"
    return {row["run_id"]: row["reason"] for row in query(asked, study=study).to_pylist()}
