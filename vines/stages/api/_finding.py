"""From the name of a log to its file, and where recordings of logs are kept."""

from __future__ import annotations

import os
import warnings
from pathlib import Path

from vines.errors import DamageError, DamageWarning, FileMissingError, UnknownNameError, nearest
from vines.stages.api._home import Home, current
from vines.stages.api._uncomputed import uncomputed
from vines.store import Store

__all__ = ["all_logs", "find_logs", "recordings_folder", "stages_of_logs"]


def recordings_folder(*, study: Home | None = None) -> Path:
    """Return the folder of recordings (.rrd) that can be made again from their logs."""
    return (study or current()).cache / "rrd"


def all_logs(*, study: Home | None = None) -> list[Path]:
    """Return the MCAP files of all logs of the catalogue; a `DamageWarning` names what is without its logs.

    Raises
    ------
    UnknownNameError
        If nothing with logs has been run.
    """
    pinned, absent = _pinned((study or current()).store)
    found = [path for logs in pinned.values() for path in logs.values()]
    for why in absent.values():
        warnings.warn(f"{why}; its logs are left out", DamageWarning, stacklevel=2)
    if not found:
        raise UnknownNameError("there are no logs: nothing with logs has been run here; try 'vines run quickstart'")
    return list(dict.fromkeys(found))


def stages_of_logs(*, study: Home | None = None) -> dict[Path, str]:
    """Return ``<pipeline>.<stage>`` of each log of the catalogue by its file; the first of several that share one."""
    pinned, _ = _pinned((study or current()).store)
    found: dict[Path, str] = {}
    for stage, logs in pinned.items():
        for path in logs.values():
            found.setdefault(path.resolve(), stage)
    return found


def _pinned(store: Store) -> tuple[dict[str, dict[str, Path]], dict[str, str]]:
    """Return for each stage that is pinned its logs by their points, and why a stage or pipeline has none to give."""
    from vines.catalogue import stage_results

    results, absent = stage_results(store)
    logs: dict[str, dict[str, Path]] = {}
    for pipeline, stage, result in results:
        if not result.logs:
            continue
        problem = store.problem(result.key, {log["file"] for log in result.manifest["logs"]})
        if problem:
            absent[f"{pipeline}.{stage}"] = f"{result.folder}: {problem}; 'vines run {pipeline}' mends it"
        else:
            logs[f"{pipeline}.{stage}"] = result.logs
    return logs, absent


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
    DamageError
        If it is there and its pin, its result or one of its logs is damaged.
    """
    path = Path(name)
    # What is no regular file is told as what it is where it is read.
    if name.endswith(".mcap") or (os.path.lexists(path) and not path.is_dir()):
        if not os.path.lexists(path):
            raise FileMissingError(
                f"{name}: there is no such file; 'vines query \"select * from logs\"' lists the logs"
            )
        return [path]
    logs, absent = _pinned((study or current()).store)
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
    for where in (stage, stage.partition(".")[0]):
        if where in absent:
            raise DamageError(f"log {name!r}: {absent[where]}")
    if why := uncomputed(name, study or current()):
        raise UnknownNameError(why)
    if absent:
        raise DamageError(f"no log {name!r} among those that can be read; {next(iter(absent.values()))}")
    if not logs:
        raise UnknownNameError(f"no log {name!r}: nothing with logs has been run here; try 'vines run quickstart'")
    raise UnknownNameError(f"no log {name!r}: {nearest(name, logs)}")
