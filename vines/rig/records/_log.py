"""The MCAP log of a run of a rig, for the viewer: thinned so that no impact is lost from sight."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from vines.logs import Sensor, extremes, write_rig
from vines.rig.ingest import find_tone
from vines.rig.recording import Recording, Sampled
from vines.schema import numpy_dtype

__all__ = ["LOG_RATE", "write_log"]

LOG_RATE = 2048.0
"""Samples a second that a channel has in a log at most, unless more are asked for."""


def write_log(path: Path, recording: Recording, provenance: Mapping[str, object], log_rate: float = LOG_RATE) -> Path:
    """Write a recording as the rig's log.

    Parameters
    ----------
    path : Path
        Where.
    recording : Recording
        The run.
    provenance : mapping
        Where it comes from.
    log_rate : float
        Samples a second of each channel at most. Of each group of samples the one farthest from the mean of the group
        is kept, with its own time, so that the shock of an impact stays visible; 0 keeps all.
    """
    sensors = {}
    for name, channel in recording.channels.items():
        kept = _kept(channel, log_rate)
        samples = np.zeros(len(kept), numpy_dtype("vines.v1.SensorSample"))
        samples["t"] = channel.start + kept / channel.rate
        samples["value"] = channel.values[kept]
        samples["valid"] = channel.valid[kept]
        about = {**channel.about, "rate": repr(channel.rate)}
        if len(kept) < len(channel.values):
            about["thinned"] = f"{len(kept)} of {len(channel.values)} samples; all are in the raw file"
        sensors[name] = Sensor(samples[samples["t"] >= 0], about)
    info = recording.run
    stated = {"M [kg]": info.M.value, "m [kg]": info.m.value, "b [m]": info.b.value}
    commanded = {"f_cmd [Hz]": info.f_cmd, "E_cmd [m]": info.E_cmd}
    return write_rig(
        path,
        sensors=sensors,
        base=_base(recording),
        provenance={**provenance, "raw_sha256": recording.sha256},
        parameters=stated | {name: value for name, value in commanded.items() if value is not None},
        name=info.run_id,
    )


def _kept(channel: Sampled, log_rate: float) -> np.ndarray:
    """Return the places of the samples that a log keeps."""
    group = 1 if log_rate <= 0 else max(1, int(np.ceil(channel.rate / log_rate)))
    return extremes(channel.values, group) if len(channel.values) >= group else np.arange(len(channel.values))


def _base(recording: Recording) -> np.ndarray:
    """Return the motion of the base at the samples of its channel that are kept, with the phase of its fundamental."""
    rows = np.zeros(0, numpy_dtype("vines.v1.BaseMotion"))
    channel = recording.role("base_disp")
    if channel is None or recording.run.protocol == "ringdown":
        return rows
    tone = find_tone(channel.values, channel.valid, channel.rate, channel.start)
    if tone is None:
        return rows
    group = max(1, int(np.ceil(channel.rate / LOG_RATE)))
    values = np.where(channel.valid, channel.values, np.nan)
    count = len(values) // group
    rows = np.zeros(count, rows.dtype)
    rows["t"] = channel.start + (np.arange(count) * group + (group - 1) / 2) / channel.rate
    mean = float(channel.values[channel.valid].mean())
    rows["displacement"] = values[: count * group].reshape(count, group).mean(axis=1) - mean
    rows["velocity"] = rows["acceleration"] = np.nan
    rows["phase"] = (2 * np.pi * tone.f * rows["t"] + tone.phase) % (2 * np.pi)
    return rows[rows["t"] >= 0]
