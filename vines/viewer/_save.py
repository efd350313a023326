"""Runs as a Rerun recording. Rerun is loaded only when one is written."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from vines.errors import FileMissingError, ParameterError
from vines.logs import Log, read

__all__ = ["logs_of", "record", "replacing", "save_rrd"]


def save_rrd(
    logs: Sequence[str | os.PathLike[str] | Log],
    out: str | os.PathLike[str],
    *,
    overlay: bool = False,
    at: float | None = None,
    full: bool = False,
    stages: Sequence[str] = (),
) -> Path:
    """Write runs as one Rerun recording with its layout.

    A recording is made for one minor version of Rerun and can be made again: keep the logs.

    Parameters
    ----------
    logs : sequence of path-like or Log
        One run, or several to be shown side by side.
    out : path-like
        The .rrd file; an existing one is replaced.
    overlay : bool
        Whether the curves of all runs are in the same views.
    at : float, optional
        Time around which a long run is drawn with all its states [1/omega0]; the middle if left out.
    full : bool
        Whether every state is drawn, however long a run is; else of more than 60 000 the peaks of each curve, and all
        states in three stretches.
    stages : sequence of str
        The ``<pipeline>.<stage>`` of each log, empty where there is none; kept as properties of the recording.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileMissingError
        If a log or the folder of `out` does not exist.
    LogError
        If a log is damaged or incomplete.
    ParameterError
        If `at` lies before or after all runs.
    ViewerError
        If there is nothing to show.
    """
    with replacing(Path(out)) as partial:
        record(logs, partial, overlay=overlay, at=at, full=full, stages=stages)
    return Path(out)


def logs_of(logs: Sequence[str | os.PathLike[str] | Log]) -> list[Log]:
    """Return logs, those given by their paths read."""
    return [log if isinstance(log, Log) else read(log) for log in logs]


def record(
    logs: Sequence[str | os.PathLike[str] | Log],
    out: Path,
    *,
    still: bool = False,
    overlay: bool = False,
    at: float | None = None,
    full: bool = False,
    stages: Sequence[str] = (),
) -> None:
    """Write a recording of runs; a still one has no time that runs."""
    runs = logs_of(logs)
    if at is not None:
        _check_time(at, runs)
    os.environ.setdefault("RERUN_ANALYTICS", "0")
    from vines.viewer._recording import write_recording

    write_recording(runs, out, still=still, overlay=overlay, at=at, full=full, stages=stages)


def _check_time(at: float, runs: Sequence[Log]) -> None:
    """Refuse a time at which none of the runs shows anything."""
    times = [time for run in runs if run.states.num_rows for time in run.states["t"].to_numpy()[[0, -1]].tolist()]
    if times and not min(times) <= at <= max(times):
        raise ParameterError(
            f"at is {at:g}, allowed is {min(times):g} to {max(times):g}, the time of the run, 1/omega0"
        )


@contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """Give a file to write beside the target, which takes its place when all went well."""
    if not target.parent.is_dir():
        raise FileMissingError(f"the folder {target.parent} of {target.name} does not exist; create it first")
    partial = target.with_name(f".{target.name}.{os.getpid()}.{secrets.token_hex(4)}.part")
    try:
        yield partial
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)
