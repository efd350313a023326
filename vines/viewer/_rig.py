"""A run of a rig: a curve a sensor, and the motion of the base."""

from __future__ import annotations

import re

import numpy as np
import rerun as rr

from vines.errors import ViewerError
from vines.logs import Log
from vines.viewer._clock import Clock
from vines.viewer._layout import Shown
from vines.viewer._style import BASE, LINE

__all__ = ["is_rig", "send_rig", "shown_rig"]

_MOTION = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s²"}


def is_rig(log: Log) -> bool:
    """Return whether a log is drawn as one of a rig: as it says, or by what it holds where nothing says so."""
    return log.kind == "rig" or (log.kind == "foreign" and not log.states.num_rows)


def shown_rig(root: str, log: Log) -> Shown:
    """Return what the layout must know of the log of a rig.

    Raises
    ------
    ViewerError
        If it holds no samples.
    """
    curves = _curves(log)
    if not curves:
        raise ViewerError(f"{log.path} holds no samples of sensors or of the base, so there is nothing to show")
    start = min(float(t[0]) for t, _, _ in curves.values())
    end = max(float(t[-1]) for t, _, _ in curves.values())
    return Shown(root, log.name, start, end, start, end, period=1.0, kind="rig", parts=tuple(curves))


def send_rig(rec: rr.RecordingStream, root: str, log: Log) -> None:
    """Send the curves of a rig; its times are seconds."""
    clock = Clock(0.0, 0.0, None)
    for part, (t, values, name) in _curves(log).items():
        colour = BASE if part.startswith("base") else LINE
        path = f"{root}/{part}/curve"
        # A mean over the samples of a pixel would hide shocks and shrink what swings fast.
        line = rr.SeriesLines(colors=colour, widths=1.2, names=name, aggregation_policy="MinMax")
        rec.log(path, line, static=True)
        rec.send_columns(path, indexes=clock.columns(t), columns=rr.Scalars.columns(scalars=values))


def _curves(log: Log) -> dict[str, tuple[np.ndarray, np.ndarray, str]]:
    """Return times, values and name of each curve that has samples; what is not to be trusted is left out."""
    found: dict[str, tuple[np.ndarray, np.ndarray, str]] = {}
    for name, unit in _MOTION.items():
        if log.base.num_rows:
            values = log.base[name].to_numpy()
            if np.isfinite(values).any():
                found[f"base_{name}"] = (log.base["t"].to_numpy(), values, f"base {name} [{unit}], {_reach(values)}")
    for name, samples in log.sensors.items():
        if samples.num_rows:
            about = {key.decode(): text.decode() for key, text in (samples.schema.metadata or {}).items()}
            values = np.where(samples["valid"].to_numpy() == 1, samples["value"].to_numpy(), np.nan)
            part = "sensor_" + re.sub(r"[^A-Za-z0-9]+", "_", name)
            label = f"{name}: {about['quantity']} [{about['unit']}], {_reach(values)}, {about['sign']}"
            found[part] = (samples["t"].to_numpy(), values, label)
    return found


def _reach(values: np.ndarray) -> str:
    """Return from where to where values go: Rerun writes few numbers on an axis that is low.

    Examples
    --------
    >>> _reach(np.array([-2.0, np.nan, 3.14159]))
    '−2 to 3.14'
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "nothing valid"
    return f"{finite.min():.3g} to {finite.max():.3g}".replace("-", "−")
