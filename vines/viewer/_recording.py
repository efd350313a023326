"""From logs to a Rerun recording."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import rerun as rr
import rerun.blueprint as rrb

from vines.errors import ViewerError
from vines.logs import Log
from vines.viewer._balls import half_of, send_balls, track_labels
from vines.viewer._called import called, stops_of
from vines.viewer._clock import Clock
from vines.viewer._curves import curves
from vines.viewer._drawn import Drawn, drawn, thinning
from vines.viewer._foreign import write_foreign
from vines.viewer._impacts import dial, lanes
from vines.viewer._layout import Shown, blueprint
from vines.viewer._overlay import check_overlay, overlaid, send_overlay
from vines.viewer._remarks import is_foreign
from vines.viewer._rig import is_rig, send_rig, shown_rig
from vines.viewer._scene import DRIVEN, cavity, mass_beside, phase_plane
from vines.viewer._text import about, send_impact_log

__all__ = ["APPLICATION", "send_run", "write_recording"]

APPLICATION = "vines"
"""Application id under which the viewer keeps layouts."""


def write_recording(
    logs: Sequence[Log],
    out: Path,
    *,
    still: bool = False,
    overlay: bool = False,
    at: float | None = None,
    full: bool = False,
    stages: Sequence[str] = (),
) -> None:
    """Write runs as one recording, side by side or laid over each other, with the layout that shows them.

    Parameters
    ----------
    logs : sequence of Log
        At least one; each needs a state.
    out : Path
        The .rrd file, replaced if it exists.
    still : bool
        Whether its layout is for a picture.
    overlay : bool
        Whether the curves of all runs are in the same views.
    at : float, optional
        Time around which a long run is drawn with all its states; the middle if left out.
    full : bool
        Whether every state is drawn, however long a run is.
    stages : sequence of str
        The ``<pipeline>.<stage>`` of each log, empty where there is none.

    Raises
    ------
    ViewerError
        If there is no log, a log without a state, or if runs that cannot be laid over each other shall be.
    """
    if not logs:
        raise ViewerError("no log was named; name one or more, as in `vines view quickstart.up`")
    if overlay:
        check_overlay(logs)
    if any(map(is_foreign, logs)):
        write_foreign(logs, out)
        return
    roots = _roots([log.name for log in logs])
    shown = [_shown(root, log) for root, log in zip(roots, logs, strict=True)]
    parts = [drawn(log, at=at, full=full) for log in logs]
    rec = rr.RecordingStream(APPLICATION, recording_id=_identity(logs), send_properties=False)
    rec.save(out, default_blueprint=overlaid(shown, still=still) if overlay else blueprint(shown, still=still))
    _send_all(rec, logs, roots, parts, full=full, stages=stages)
    if overlay:
        send_overlay(rec, parts, [_columns(part.log.states) for part in parts])
    rec.flush()
    rec.disconnect()


def send_run(log: Log, begin: Callable[[str, rrb.Blueprint], rr.RecordingStream]) -> None:
    """Send a run of the simulator to a viewer, which plays it from its start.

    Parameters
    ----------
    log : Log
        The run.
    begin : callable
        ``begin(name, blueprint)`` begins a recording that is shown.

    Raises
    ------
    ViewerError
        If the log has no state.
    """
    roots = _roots([log.name])
    shown = _shown(roots[0], log)
    parts = [drawn(log, at=None, full=False)]
    rec = begin(log.name, blueprint([shown], playing=True))
    _send_all(rec, [log], roots, parts, full=False)
    rec.flush()


def _send_all(
    rec: rr.RecordingStream,
    logs: Sequence[Log],
    roots: Sequence[str],
    parts: Sequence[Drawn],
    *,
    full: bool,
    stages: Sequence[str] = (),
) -> None:
    """Send what is known and what is drawn of runs."""
    rec.send_recording_name(", ".join(log.name for log in logs))
    for group, values in _properties(logs, stages or [""] * len(logs)).items():
        rec.send_property(group, values)
    for root, log, part in zip(roots, logs, parts, strict=True):
        told = about(log, "" if full else thinning(log))
        rec.log(f"{root}/about", rr.TextDocument(told, media_type=rr.MediaType.MARKDOWN), static=True)
        _send(rec, root, part)


def _shown(root: str, log: Log) -> Shown:
    """Return what the layout must know of a log."""
    if is_rig(log):
        return shown_rig(root, log)
    if not log.states.num_rows:
        raise ViewerError(f"{log.path} holds no states, so there is nothing to show; record the run with samples")
    times = log.states["t"].to_numpy()
    period = 2 * math.pi / log.parameters.get("Omega", 1.0)
    reach = float(np.abs(log.states["x1"].to_numpy()).max())
    clock = Clock(float(times[0]), log.states["phase"][0].as_py(), 2 * math.pi / period)
    first, last = clock.cycles(times[[0, -1]]).tolist()
    names = called(log)
    widest = 1.0 if names.walls else max(1.0, float(np.abs(log.states["w"].to_numpy()).max()))
    shown = Shown(
        *(root, _title(log), float(times[0]), float(times[-1]), first, last, period, reach, log.kind),
        called=names,
        widest=widest,
    )
    if log.balls:
        longest = max(half_of(log, ball) for ball in log.balls)
        return replace(shown, parts=track_labels(log), longest=longest)
    return shown


def _title(log: Log) -> str:
    return f"{log.name} ({log.word})" if log.word else log.name


def _send(rec: rr.RecordingStream, root: str, part: Drawn) -> None:
    """Send what is drawn of one run."""
    log = part.log
    if is_rig(log):
        send_rig(rec, root, log)
        return
    states, impacts = _columns(log.states), _columns(log.impacts)
    if log.nes.num_rows:
        states |= _columns(log.nes)
    start, end = float(states["t"][0]), float(states["t"][-1])
    clock = Clock(start, float(states["phase"][0]), log.parameters.get("Omega", 1.0), impacts["t"], end)
    if log.balls:
        send_balls(rec, root, part, states, impacts, clock)
        send_impact_log(rec, f"{root}/impacts", impacts, clock)
        return
    sprung = log.system not in DRIVEN
    names, stops = called(log), stops_of(log)
    widest = 1.0 if names.walls else max(1.0, float(np.abs(states["w"]).max()))
    cavity(rec, f"{root}/cavity", states, clock, sprung=sprung, walls=names.walls, stops=stops)
    if "x3" in states:
        mass_beside(rec, f"{root}/cavity", states, clock)
    phase = f"{root}/phase"
    phase_plane(rec, phase, states, impacts, clock, part.parts, widest=widest, walls=names.walls, stops=stops)
    curves(rec, root, states, impacts, clock, sprung=sprung, names=names, stops=stops, modal=log.system == "modes")
    dial(rec, f"{root}/dial", states, impacts, clock)
    lanes(rec, f"{root}/lanes", states, impacts, clock, stops)
    send_impact_log(rec, f"{root}/impacts", impacts, clock)


def _columns(table: pa.Table) -> dict[str, np.ndarray]:
    return {name: table[name].to_numpy() for name in table.column_names}


def _roots(names: Sequence[str]) -> list[str]:
    """Return one entity path a run, readable and unlike the others.

    Examples
    --------
    >>> _roots(["fig2.a up", "fig2.a up"])
    ['/fig2_a_up', '/fig2_a_up_2']
    """
    roots: list[str] = []
    for name in names:
        base = "/" + (re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "run")
        root, number = base, 1
        while root in roots:
            number += 1
            root = f"{base}_{number}"
        roots.append(root)
    return roots


def _identity(logs: Sequence[Log]) -> str:
    """Return an id that is the same for the same logs, so that opening them twice shows them once."""
    digest = hashlib.sha256()
    for log in logs:
        digest.update(log.sha256.encode())
    return digest.hexdigest()[:32]


def _properties(logs: Sequence[Log], stages: Sequence[str]) -> dict[str, rr.AnyValues]:
    """Return what a catalogue of recordings shows as columns, in groups.

    The catalogue sorts columns by the names of their groups: these are named so that the run comes first, then its
    parameters, then its attractor and impacts, then the rest.
    """
    parts = [stage.partition(".") for stage in stages]
    parameters = dict.fromkeys(key for log in logs for key in log.parameters)
    groups: dict[str, dict[str, Any]] = {
        "from": {
            "pipeline": [pipeline for pipeline, _, _ in parts],
            "stage": [stage for _, _, stage in parts],
        },
        "given": {key: [log.parameters.get(key, math.nan) for log in logs] for key in parameters},
        "got": {
            "attractor": [log.attractor for log in logs],
            "impacts": [log.impacts.num_rows for log in logs],
            "sticks": [log.sticks.num_rows for log in logs],
        },
        "vines": {
            "name": [log.name for log in logs],
            "kind": [log.kind for log in logs],
            "log": [log.path.name for log in logs],
        },
    }
    for key in dict.fromkeys(key for log in logs for key in log.provenance):
        groups["vines"][f"provenance_{key}"] = [log.provenance.get(key, "") for log in logs]
    return {name: rr.AnyValues(**group) for name, group in groups.items() if group}
