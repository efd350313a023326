"""One period of a periodic orbit as an MCAP log, which the viewer shows going round."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vines.dynamics import simulate
from vines.errors import StateError
from vines.logs import write_run
from vines.model import STATE_NAMES
from vines.schema import numpy_dtype

if TYPE_CHECKING:
    from vines.orbits import Orbit

__all__ = ["orbit_log"]

_CLOSES = 1e-6
"""Largest difference between the two ends of the stored period; an unstable orbit drifts by its multiplier."""


def orbit_log(orbit: Orbit, path: str | os.PathLike[str], *, per_period: int = 600, bare: bool = True) -> Path:
    """Write one period of an orbit as a log, beginning in the middle of its longest flight.

    Parameters
    ----------
    orbit : Orbit
        An admissible orbit, stable or not.
    path : path-like
        Where; an existing file is replaced.
    per_period : int
        Samples in a forcing period, besides those just before and after each impact.
    bare : bool
        Whether the log also carries what a viewer without vines understands.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    StateError
        If the orbit is not admissible: its ball would pass through a wall, so there is no motion to show. Or if its
        two ends do not meet, because it is too unstable to be followed for a period.
    FileMissingError
        If the folder does not exist.

    Examples
    --------
    >>> import tempfile, vines
    >>> from vines import logs
    >>> orbit = vines.find_orbit("LR", vines.Params(mu=0.01, A=0.02, Omega=1.0, r=0.65))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     log = logs.read(orbit_log(orbit, f"{folder}/orbit.mcap"))
    ...     log.kind, log.word, log.impacts.num_rows
    ('orbit', 'LR', 2)
    """
    if not orbit.admissible:
        raise StateError(
            f"orbit {orbit.word} is not admissible: it meets side {orbit.violation_side:+d} "
            f"at t = {orbit.violation_time:.6g}, so there is no motion to log"
        )
    p = orbit.params
    longest = int(np.argmax(orbit.flight_times))
    after = orbit.impacts[longest]
    begun = simulate(
        p,
        x1=float(after["x1"]),
        v1=float(after["v1_after"]),
        x2=float(after["x2"]),
        v2=float(after["v2_after"]),
        t=float(after["t"]),
        periods=float(orbit.flight_times[longest]) / 2 / p.period,
    ).final
    # Times of the log run from 0 or a little later: t modulo the period, which leaves the phase as it is.
    t = begun["t"] % orbit.period
    state = {name: begun[name] for name in STATE_NAMES}
    phi = (begun["phase"] - p.Omega * t) % (2 * math.pi)
    run = simulate(
        p, x1=state["x1"], v1=state["v1"], x2=state["x2"], v2=state["v2"], t=t, phi=phi, periods=orbit.word.p
    )
    gap = max(abs(run.final[name] - state[name]) for name in state)
    if not gap < _CLOSES or len(run.impacts) != len(orbit.t):
        raise StateError(
            f"orbit {orbit.word} does not close when it is followed for a period: its ends differ by {gap:.2g} "
            f"with {len(run.impacts)} of {len(orbit.t)} impacts; its largest multiplier is {orbit.max_multiplier:.3g}"
        )
    return write_run(
        path,
        states=run.sample(per_period=per_period, at_events=True),
        impacts=run.impacts,
        sticks=run.sticks,
        provenance={"kind": "orbit", "orbit_id": orbit.orbit_id},
        parameters=p.as_dict(),
        name=orbit.name,
        orbit=_row(orbit, t),
        word=str(orbit.word),
        attractor=orbit.name if orbit.stable else None,
        bare=bare,
    )


def _row(orbit: Orbit, t: float) -> np.ndarray:
    """Return the message ``vines.v1.Orbit``."""
    row = np.zeros(1, numpy_dtype("vines.v1.Orbit"))
    m = orbit.measures
    values: dict[str, float] = {
        "t": t,
        "period": orbit.period,
        "p": orbit.word.p,
        "left": int((orbit.side == 1).sum()),
        "right": int((orbit.side == -1).sum()),
        "symmetric": orbit.symmetric,
        "stable": orbit.stable,
        "admissible": orbit.admissible,
        "kinetic_ratio": m.kinetic_ratio,
        "max_abs_x1": m.max_abs_x1,
        "base_work": m.base_work,
        "damper_loss": m.damper_loss,
        "impact_loss": m.impact_loss,
        "min_clearance": orbit.min_clearance,
        "residual": orbit.residual,
    }
    for number, value in enumerate(orbit.multipliers, 1):
        values[f"multiplier_{number}_re"] = float(value.real)
        values[f"multiplier_{number}_im"] = float(value.imag)
    for name, value in values.items():
        row[name] = value
    return row
