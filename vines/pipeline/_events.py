"""What a run tells while it goes on, and what it returns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from vines.errors import RunFailed

__all__ = ["Event", "Report", "RunSummary", "StageOutcome", "silent"]


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened in a run.

    Attributes
    ----------
    what : str
        ``waiting`` (another process writes), ``up_to_date``, ``started``, ``progress`` (a chunk is stored), ``done``,
        ``failed`` (the stage has no result), ``skipped`` (a stage that it needs failed).
    stage : str
        Name of the stage; empty for ``waiting``.
    wanted, done, failed : int
        Points of the stage; those that are there by now; those among them that failed. A stage of the whole shape
        counts as one point.
    jobs : int
        Processes at work.
    text : str
        The reason why the stage runs, failed, or was skipped.
    logs : tuple of Path
        Of ``progress``, the logs that the chunk brought.
    """

    what: Literal["waiting", "up_to_date", "started", "progress", "done", "failed", "skipped"]
    stage: str = ""
    wanted: int = 0
    done: int = 0
    failed: int = 0
    jobs: int = 1
    text: str = ""
    logs: tuple[Path, ...] = ()


Report = Callable[[Event], None]


def silent(event: Event) -> None:
    """Say nothing."""
    del event


@dataclass(frozen=True, slots=True)
class StageOutcome:
    """How a stage ended.

    Attributes
    ----------
    name : str
        The stage.
    state : {"up_to_date", "computed", "failed", "skipped"}
        Whether it has a result now, and whether anything was computed for it.
    wanted, new, failed : int
        Points that it wants, that this run computed, and that are rows with status ``failed``.
    key : str
        Key of its result; empty if it has none.
    reason : str
        Why it ran, failed, or was skipped.
    remark : str
        Why a refinement ended early.
    versions : tuple of (str, str)
        Versions of the packages that computed its points.
    """

    name: str
    state: Literal["up_to_date", "computed", "failed", "skipped"]
    wanted: int = 0
    new: int = 0
    failed: int = 0
    key: str = ""
    reason: str = ""
    remark: str = ""
    versions: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class RunSummary:
    """What a run did, stage by stage, in the order in which they ran."""

    pipeline: str
    stages: tuple[StageOutcome, ...]

    @property
    def new(self) -> int:
        """Points and whole stages that this run computed."""
        return sum(stage.new for stage in self.stages)

    @property
    def ok(self) -> bool:
        """Whether every stage has a result and no point failed."""
        return not any(stage.failed or stage.state in ("failed", "skipped") for stage in self.stages)

    def check(self) -> None:
        """Raise an error if something failed; the rest is stored.

        Raises
        ------
        RunFailed
            With one line that counts what failed and gives the first reason.
        """
        if self.ok:
            return
        broken = [stage for stage in self.stages if stage.state == "failed"]
        points = sum(stage.failed for stage in self.stages)
        parts = [f"{points} points failed"] if points else []
        parts += [f"stage {stage.name} failed: {stage.reason}" for stage in broken]
        parts += [f"{stage.name} skipped" for stage in self.stages if stage.state == "skipped"]
        remedy = "the rest is stored; rows with status 'failed' give the reasons, --retry-failed tries them again"
        raise RunFailed(f"{self.pipeline}: {'; '.join(parts)}; {remedy}")
