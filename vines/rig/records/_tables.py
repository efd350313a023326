"""Rows of the tables ``rig_runs`` and ``rig_channels``: what a run folder states, and what its channels hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from vines.rig.ingest import Ingested
from vines.rig.recording import Sampled

__all__ = ["channel_rows", "refused_row", "run_row"]


def run_row(run: Ingested) -> dict[str, Any]:
    """Return the row of a run in ``rig_runs``."""
    info = run.recording.run
    channels = run.recording.channels.values()
    return {
        "point_id": info.run_id,
        "run_id": info.run_id,
        "start_utc": info.start_utc,
        "protocol": info.protocol,
        "status": "ok",
        "ball": info.ball,
        "f_cmd": info.f_cmd,
        "E_cmd": info.E_cmd,
        "settle": info.settle,
        "duration": max(len(each.values) / each.rate for each in channels),
        "mass": info.M.value,
        "mass_u": info.M.u,
        "ball_mass": info.m.value,
        "ball_mass_u": info.m.u,
        "b": info.b.value,
        "b_u": info.b.u,
        "temperature_before": info.temperature[0],
        "temperature_after": info.temperature[1],
        "ringdown": " ".join(info.ringdown),
        "channels": len(run.recording.channels),
        "compared": "; ".join(run.compared),
        "came_from": _grouped(run.folder.came_from) if run.folder else "",
        "overruled": "; ".join(run.folder.overruled) if run.folder else "",
        "sha256": run.recording.sha256,
    }


def refused_row(run_id: str, reason: str, told: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row of a run that cannot be read in ``rig_runs``.

    Parameters
    ----------
    run_id : str
        By which it is known.
    reason : str
        Why not, in one line.
    told : mapping
        Entries of its ``run.json``, as far as that can be read.
    """
    start, protocol = told.get("start_utc"), told.get("protocol")
    return {
        "point_id": run_id,
        "run_id": run_id,
        "status": "failed",
        "reason": reason,
        "start_utc": start if isinstance(start, str) else None,
        "protocol": protocol if isinstance(protocol, str) else None,
    }


def channel_rows(run: Ingested) -> list[dict[str, Any]]:
    """Return the rows of a run in ``rig_channels``."""
    rows = []
    for name, channel in run.recording.channels.items():
        row = run.rows[name]
        clock = run.clocks[row.recorder]
        rows.append(
            {
                "point_id": run.recording.run.run_id,
                "run_id": run.recording.run.run_id,
                "channel": name,
                "role": channel.role,
                "quantity": channel.about["quantity"],
                "si_unit": channel.about["unit"],
                "file": row.file,
                "file_field": row.field,
                "sha256": run.sums.get(f"raw/{row.file}", ""),
                "sensor": row.sensor,
                "serial": row.serial,
                "sensitivity": channel.about["sensitivity"],
                "u_gain": channel.u_gain,
                "recorder": row.recorder,
                "clock_offset": clock.offset,
                "clock_ppm": 1e6 * (clock.pace - 1),
                "u_time": channel.u_time,
                "rate": channel.rate,
                "start": channel.start,
                "samples": len(channel.values),
                "clipped": run.clipped[name],
                "read_as": run.read_as[name],
                "came_from": _grouped(run.folder.cells_from.get(name, {})) if run.folder else "",
                "overruled": "; ".join(filter(None, (_campaign_said(run, name), run.overruled[name]))),
                "remarks": run.remarks[name],
                **_range(channel),
            }
        )
    return rows


def _campaign_said(run: Ingested, name: str) -> str:
    return run.folder.cells_overruled.get(name, "") if run.folder else ""


def _grouped(came_from: Mapping[str, str]) -> str:
    """Return where entries come from, by source.

    Examples
    --------
    >>> _grouped({"M": "rig.json", "f_cmd": "run.json", "b": "rig.json"})
    'rig.json: M, b; run.json: f_cmd'
    """
    sources = dict.fromkeys(came_from.values())
    return "; ".join(f"{each}: {', '.join(key for key, of in came_from.items() if of == each)}" for each in sources)


def _range(channel: Sampled) -> dict[str, float]:
    good = channel.values if channel.valid.all() else channel.values[channel.valid]
    if not len(good):
        return dict.fromkeys(("least", "largest", "mean", "rms"), float("nan"))
    return {
        "least": float(good.min()),
        "largest": float(good.max()),
        "mean": float(good.mean()),
        "rms": float(np.std(good)),
    }
