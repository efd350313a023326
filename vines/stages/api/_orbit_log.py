"""One period of a periodic orbit as an MCAP log, which the viewer shows going round."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.dynamics import Trajectory, simulate
from vines.dynamics.kernels import room_of
from vines.dynamics.runs import IN_TURN
from vines.errors import StateError
from vines.logs import write_run
from vines.model import Params
from vines.schema import numpy_dtype

if TYPE_CHECKING:
    from vines.orbits import Orbit

__all__ = ["orbit_log"]

_CLOSES = 1e-6
"""Largest difference between the two ends of the stored period; an unstable orbit drifts by its multiplier."""
_MOST = 2000
"""Impacts in a forcing period, those of a chatter counted."""


def orbit_log(orbit: Orbit, path: str | os.PathLike[str], *, per_period: int = 600, bare: bool = True) -> Path:
    """Write one period of an orbit as a log, beginning in the middle of its longest flight.

    Parameters
    ----------
    orbit : Orbit
        An admissible orbit of any system, stable or not. Of its multipliers the first four are written.
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
    begun = _in_flight(orbit)
    # Times of the log run from 0 or a little later: t modulo the period, which leaves the phase as it is.
    t = begun["t"] % orbit.period
    state = {each.name: begun[each.name] for each in p.system.state}
    run = _run(orbit, state, t, begun["phase"], orbit.period)
    gap = max(abs(run.final[name] - state[name]) for name in state)
    # Of a chatter that ends in sticking the word has one contact, and of stops none is an impact.
    wanted = len(run.impacts) if orbit.word.sticking else int((orbit.side != 0).sum())
    if not gap < _CLOSES or len(run.impacts) != wanted:
        raise StateError(
            f"orbit {orbit.word} does not close when it is followed for a period: its ends differ by {gap:.2g} "
            f"with {len(run.impacts)} of {wanted} impacts; its largest multiplier is {orbit.max_multiplier:.3g}"
        )
    return write_run(
        path,
        states=run.sample(per_period=per_period, at_events=True),
        impacts=run.impacts,
        sticks=run.rests,
        provenance={"kind": "orbit", "orbit_id": orbit.orbit_id},
        parameters=p.as_dict(),
        name=orbit.name,
        orbit=_row(orbit, t),
        word=str(orbit.word),
        attractor=orbit.name if orbit.stable else None,
        system=None if isinstance(p, Params) else p.system.name,
        bare=bare,
    )


def _in_flight(orbit: Orbit) -> dict[str, float]:
    """Return where the orbit is in the middle of its longest flight, its time and its phase."""
    p, longest = orbit.params, int(np.argmax(orbit.flight_times))
    ahead = float(orbit.flight_times[longest]) / 2
    if p.system.balls or p.system.modes:
        at = orbit.start()
        t, phase = at.pop("t"), float(orbit.phase[0])
        ahead += float(orbit.t[longest]) - t
    else:
        after = orbit.impacts[longest]
        t, phase = float(after["t"]), float(after["phase"])
        left = [float(after[name]) for name in ("x1", "v1_after", "x2", "v2_after")]
        at = room_of(p).leave(p, left, phase, [float(after[name]) for name in room_of(p).beside])
    return _run(orbit, at, t, phase, ahead).final


def _run(orbit: Orbit, state: dict[str, float], t: float, phase: float, duration: float) -> Trajectory:
    """Run on from a state; balls that arrive together are struck as the orbit has it."""
    p = orbit.params
    phi = (phase - getattr(p, "Omega", 1.0) * t) % (2 * math.pi)
    ties = IN_TURN if orbit.release is None else orbit.release[0].ties
    at: dict[str, Any] = dict(state)
    return simulate(p, t=t, phi=phi, periods=duration / p.period, ties=ties, max_impacts_per_period=_MOST, **at)


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
    for number, value in enumerate(orbit.multipliers[:4], 1):
        values[f"multiplier_{number}_re"] = float(value.real)
        values[f"multiplier_{number}_im"] = float(value.imag)
    for name, value in values.items():
        row[name] = value
    return row
