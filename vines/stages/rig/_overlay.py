"""Logs of a measured run and of the model beside it, on one clock, for the viewer: phase zero at a multiple of T."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.dynamics import simulate
from vines.logs import write_run
from vines.schema import numpy_dtype

if TYPE_CHECKING:
    from vines.dynamics import Trajectory
    from vines.rig import Comparison, Reconstruction

__all__ = ["overlay_logs"]

_PER_PERIOD = 200


def overlay_logs(folder: Path, found: Comparison, periods: int, provenance: Mapping[str, object]) -> dict[str, str]:
    """Write ``<run>.measured.mcap`` and ``<run>.model.mcap``: a run as reconstructed, and its nearest branch.

    Both are dimensionless, with the same parameters, and at every time the same phase of the forcing.

    Parameters
    ----------
    folder : Path
        Where the logs go.
    found : Comparison
        A run beside its branches.
    periods : int
        Forcing periods from the second complete one of the record on.
    provenance : mapping
        As for :func:`vines.logs.write_run`.

    Returns
    -------
    dict of str to str
        File of each log by its name, ``<run>/measured`` and ``<run>/model``; empty if there is no branch.
    """
    run = found.run
    whole = min(periods, len(run.periods.words) - 2)
    if not found.branches or whole < 1:
        return {}
    about: Any = {"provenance": provenance, "parameters": found.params.as_dict(), "bare": False}
    states, impacts = _measured(found, whole)
    name = run.run.run_id
    files = {f"{name}/{what}": f"{name}.{what}.mcap" for what in ("measured", "model")}
    write_run(
        folder / files[f"{name}/measured"],
        states=states,
        impacts=impacts,
        sticks=np.zeros(0, numpy_dtype("vines.v1.Stick")),
        name=f"{name} measured",
        attractor=run.pattern.name,
        **about,
    )
    model = _model(found, states, whole)
    branch = found.branches[0].predicted.candidate.name
    write_run(
        folder / files[f"{name}/model"],
        states=model.sample(per_period=_PER_PERIOD, at_events=True),
        impacts=model.impacts,
        sticks=model.sticks,
        name=f"{name} model {branch}",
        attractor=branch,
        **about,
    )
    return files


def _measured(found: Comparison, periods: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the reconstructed motion as rows of State and Impact."""
    run, p = found.run, found.params
    begin, end = run.track.periods_begin(run.periods, np.array([1, 1 + periods]))
    hits = run.impacts[(run.impacts["t"] >= begin) & (run.impacts["t"] < end)]
    grid = np.linspace(begin, end, periods * _PER_PERIOD + 1)
    # The motion has corners at impacts: a sample just before each and one just after.
    late = run.track.t[np.searchsorted(run.track.t, begin) : np.searchsorted(run.track.t, end)]
    t = np.sort(np.concatenate([grid, late - 1e-6, late + 1e-6]))
    b, omega0 = run.quantities["b"].value, run.quantities["omega0"].value
    w, w_dot = run.track.w(t)
    x1, v1 = run.track.motion.at(t), run.track.motion.at(t, 1)
    phase = run.track.phase[0] + run.track.motion.omega * (t - run.track.t[0])
    start = _start(run)
    rows = np.zeros(len(t), numpy_dtype("vines.v1.State"))
    for name in rows.dtype.names or ():
        if name != "stuck":
            rows[name] = np.nan  # the running energies are not measured
    rows["t"] = (phase - start) / p.Omega
    rows["x1"], rows["v1"], rows["w"], rows["w_dot"] = x1 / b, v1 / (b * omega0), w / b, w_dot / (b * omega0)
    rows["x2"], rows["v2"] = rows["x1"] - rows["w"], rows["v1"] - rows["w_dot"]
    rows["phase"] = np.mod(phase, 2 * math.pi)
    rows["base"] = p.A * np.sin(phase)
    rows["kinetic_1"], rows["kinetic_2"] = rows["v1"] ** 2 / 2, p.mu * rows["v2"] ** 2 / 2
    rows["potential"] = (rows["x1"] - rows["base"]) ** 2 / 2
    impacts = np.zeros(len(hits), numpy_dtype("vines.v1.Impact"))
    turned = run.track.phase[0] + run.track.motion.omega * (late - run.track.t[0])
    impacts["t"] = (turned - start) / p.Omega
    impacts["side"], impacts["phase"], impacts["index"] = hits["side"], hits["phase"], np.arange(len(hits))
    for name in ("x1", "x2"):
        impacts[name] = hits[name] / b
    for name in ("v1", "v2", "w_dot", "v1_after", "v2_after"):
        impacts[name] = hits[name] / (b * omega0)
    return rows, impacts


def _start(run: Reconstruction) -> float:
    """Return the phase that is time zero: the last multiple of a turn before the second complete period."""
    first = run.periods.cut + 2 * math.pi * (run.periods.first + 1)
    return 2 * math.pi * math.floor(first / (2 * math.pi))


def _model(found: Comparison, measured: np.ndarray, periods: int) -> Trajectory:
    """Return the nearest branch over the same time; of a pattern of p periods the turn that lies nearest."""
    p = found.params
    start = found.branches[0].predicted.candidate.start
    begin, end = float(measured["t"][0]), float(measured["t"][-1])
    runs = []
    for turn in range(found.run.pattern.p):
        # Whole periods before the window, so that the start has the phase that belongs to it.
        t = start["phase"] / p.Omega - (turn + 1) * p.period
        x1, v1, x2, v2 = (start[name] for name in ("x1", "v1", "x2", "v2"))
        s = simulate(p, x1=x1, v1=v1, x2=x2, v2=v2, t=t, periods=(begin - t) / p.period).final
        span = (end - begin) / p.period
        runs.append(simulate(p, x1=s["x1"], v1=s["v1"], x2=s["x2"], v2=s["v2"], t=begin, periods=span))
    times = np.linspace(begin, end, 8 * periods + 1)[1:-1]
    own = np.interp(times, measured["t"], measured["w"])

    def apart(run: Trajectory) -> float:
        samples = run.sample(per_period=_PER_PERIOD, at_events=True)
        return float(np.mean((np.interp(times, samples["t"], samples["w"]) - own) ** 2))

    return min(runs, key=apart)
