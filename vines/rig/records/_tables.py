"""Rows of the tables ``rig_runs`` and ``rig_channels``: what a run folder states, and what its channels hold."""

from __future__ import annotations

from typing import Any

import numpy as np

from vines.rig.ingest import Ingested
from vines.rig.recording import Sampled

__all__ = ["channel_rows", "run_row"]


def run_row(run: Ingested) -> dict[str, Any]:
    """Return the row of a run in ``rig_runs``."""
    info = run.recording.run
    channels = run.recording.channels.values()
    return {
        "point_id": info.run_id,
        "run_id": info.run_id,
        "start_utc": info.start_utc,
        "protocol": info.protocol,
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
        "sha256": run.recording.sha256,
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
                "overruled": run.overruled[name],
                "remarks": run.remarks[name],
                **_range(channel),
            }
        )
    return rows


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
