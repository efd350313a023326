"""From the name of a log to its file, and where recordings of logs are kept."""

from __future__ import annotations

import os
from pathlib import Path

from vines.errors import FileMissingError, UnknownNameError, nearest
from vines.stages.api._home import Home, current
from vines.store import Store

__all__ = ["all_logs", "find_logs", "recordings_folder"]


def recordings_folder(*, study: Home | None = None) -> Path:
    """Return the folder of recordings (.rrd) that can be made again from their logs."""
    return (study or current()).cache / "rrd"


def all_logs(*, study: Home | None = None) -> list[Path]:
    """Return the MCAP files of all logs of the catalogue.

    Raises
    ------
    UnknownNameError
        If nothing with logs has been run.
    """
    found = [path for logs in _pinned((study or current()).store).values() for path in logs.values()]
    if not found:
        raise UnknownNameError("there are no logs: nothing with logs has been run here; try 'vines run quickstart'")
    return list(dict.fromkeys(found))


def _pinned(store: Store) -> dict[str, dict[str, Path]]:
    """Return for each stage that is pinned its logs by their points."""
    return {
        f"{pipeline}.{stage}": store.result(pin["result"]).logs
        for pipeline, stages in store.readable_pins()[0].items()
        for stage, pin in stages.items()
        if store.has(pin["result"]) and store.result(pin["result"]).logs
    }


def find_logs(name: str, *, study: Home | None = None) -> list[Path]:
    """Return the MCAP files of a log name.

    Parameters
    ----------
    name : str
        ``<pipeline>.<stage>`` (all its logs), ``<pipeline>.<stage>/<point>`` (all of that point), a log id, or a path.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Raises
    ------
    FileMissingError
        If it is a path and there is no such file.
    UnknownNameError
        If there is no such pipeline, stage or log, or if it has not been run.
    """
    path = Path(name)
    # What is no regular file is told as what it is where it is read.
    if name.endswith(".mcap") or (os.path.lexists(path) and not path.is_dir()):
        if not os.path.lexists(path):
            raise FileMissingError(
                f"{name}: there is no such file; 'vines query \"select * from logs\"' lists the logs"
            )
        return [path]
    logs = _pinned((study or current()).store)
    stage, _, point = name.partition("/")
    if stage in logs:
        if not point:
            return list(logs[stage].values())
        found = [path for key, path in logs[stage].items() if key.startswith(point)]
        # A run of a rig has several logs: as measured, and of the model.
        own = [path for key, path in logs[stage].items() if key.startswith(f"{point}/")]
        if len(found) == 1 or own:
            return own or found
        raise UnknownNameError(
            f"stage {stage!r} has {len(found)} logs of point {point!r}: {nearest(point, logs[stage])}"
        )
    by_id = {key: path for paths in logs.values() for key, path in paths.items()}
    if name in by_id:
        return [by_id[name]]
    if not logs:
        raise UnknownNameError(f"no log {name!r}: nothing with logs has been run here; try 'vines run quickstart'")
    raise UnknownNameError(f"no log {name!r}: {nearest(name, logs)}")
