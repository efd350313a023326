"""How a periodic orbit changes with its parameters, and with forces on the ball that the model does not have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound, ParameterError
from vines.model import PARAMETER_NAMES, V1, V2, X2
from vines.rig.fit import Motion, forced_response, free_part, root

if TYPE_CHECKING:
    from vines.model import Params
    from vines.orbits import Orbit

__all__ = ["Numbers", "pushed", "sensitivity"]

Floats = npt.NDArray[np.float64]

_FORCES = ("friction", "tilt")
"""On the ball, in units of b omega0^2."""

_STEP = 1e-4
"""Relative step of a parameter."""

_STEPS = 2000
"""Steps of a flight in the integrals of the force; friction jumps where the sliding turns."""


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """Numbers of an orbit by which it is compared, or their derivative.

    Attributes
    ----------
    phase : ndarray, shape (N,)
        Omega t of each impact in canonical order [rad].
    max_abs_x1, kinetic_ratio : float
        Largest |x1| and K2/K1.
    """

    phase: Floats
    max_abs_x1: float
    kinetic_ratio: float


def sensitivity(orbit: Orbit) -> Mapping[str, Numbers]:
    """Return the derivatives of an orbit's numbers by its parameters, where neighbours are found, and by small forces.

    Notes
    -----
    By a parameter: differences of two neighbouring orbits. By a force: see `pushed`; tilt accelerates the ball to the
    right, friction slows its sliding against the cavity and drives the oscillator with mu times the opposite.
    """
    found = {}
    for name in PARAMETER_NAMES:
        step = _STEP * max(getattr(orbit.params, name), _STEP)
        pair = [_moved(orbit, orbit.params.replace(**{name: getattr(orbit.params, name) + e})) for e in (-step, step)]
        if pair[0] is not None and pair[1] is not None:
            found[name] = _slope(pair[0], pair[1], step)
    for name in _FORCES:
        change = pushed(orbit, name)
        step = 1e-6 / max(float(np.abs(change).max()), 1.0)
        found[name] = _slope(_numbers(orbit, -step * change), _numbers(orbit, step * change), step)
    return found


def _moved(orbit: Orbit, p: Params) -> Numbers | None:
    from vines.orbits import find_orbit

    try:
        return _numbers(find_orbit(orbit.word, p, guess=orbit), np.zeros((len(orbit.t), 4)))
    except (OrbitNotFound, ParameterError):
        return None


def _slope(low: Numbers, high: Numbers, step: float) -> Numbers:
    turn = np.angle(np.exp(1j * (high.phase - low.phase)))
    return Numbers(
        turn / (2 * step),
        (high.max_abs_x1 - low.max_abs_x1) / (2 * step),
        (high.kinetic_ratio - low.kinetic_ratio) / (2 * step),
    )


def _numbers(orbit: Orbit, change: Floats) -> Numbers:
    """Return the numbers of an orbit whose states (v1, v2, x2, t) before impacts have changed."""
    p = orbit.params
    v1, v2 = orbit.states[:, V1] + change[:, 0], orbit.states[:, V2] + change[:, 1]
    x2, t = orbit.states[:, X2] + change[:, 2], orbit.t + change[:, 3]
    after = v1 - p.mu * (1 + p.r) / (1 + p.mu) * (v1 - v2)
    stop = float(t[0] + orbit.period)
    s = root(1.0, p.lam)
    c = forced_response(-1j * p.A, p.Omega, s)
    x = x2 + orbit.side - np.real(c * np.exp(1j * p.Omega * t))
    v = after - np.real(1j * p.Omega * c * np.exp(1j * p.Omega * t))
    motion = Motion(s, p.Omega, np.array([c]), t, free_part(x, v, s), stop)
    time = np.diff(t, append=stop)
    ball = np.diff(x2, append=x2[0]) / time
    square = float(motion.mean_square_velocity(np.array([t[0], stop]))[0])
    return Numbers(
        p.Omega * t, float(motion.peaks()[1].max()), p.mu * float(np.sum(ball**2 * time)) / (stop - t[0]) / square
    )


def pushed(orbit: Orbit, force: str) -> Floats:
    """Return the derivative of an orbit's states (v1, v2, x2, t) before its impacts by a small force, shape (N, 4).

    Parameters
    ----------
    orbit : Orbit
    force : {"tilt", "friction"}

    Notes
    -----
    Derived here: if g_k is what the force does to the state at the end of flight k, and J_k the Jacobian of the map
    from one impact to the next, the change y of the orbit solves y_{k+1} = J_k y_k + g_k around the period. With dx and
    dv the changes of positions and velocities at the old time of arrival, the impact comes by dt = (dx2 - dx1)/w' later
    when v1 has changed by dv1 + x1'' dt and x2 by dx2 + v2 dt.
    """
    arrivals = [_arrival(orbit, k, force) for k in range(len(orbit.t))]
    whole, end = np.eye(4), np.zeros(4)
    for jacobian, own in zip(orbit.jacobians, arrivals, strict=True):
        whole, end = jacobian @ whole, jacobian @ end + own
    change = [np.linalg.solve(np.eye(4) - whole, end)]
    for jacobian, own in zip(orbit.jacobians[:-1], arrivals[:-1], strict=True):
        change.append(jacobian @ change[-1] + own)
    return np.asarray(change, dtype=np.float64)


def _arrival(orbit: Orbit, k: int, force: str) -> Floats:
    """Return what a unit of the force in flight k changes of the state at its end."""
    p, impact = orbit.params, cast(Any, orbit.impacts[k])
    v2, stop = float(impact["v2_after"]), float(orbit.flight_times[k])
    s = root(1.0, p.lam)
    c = forced_response(-1j * p.A, p.Omega, s) * np.exp(1j * p.Omega * orbit.t[k])
    x, v = float(impact["x1"]) - c.real, float(impact["v1_after"]) - (1j * p.Omega * c).real
    motion = Motion(s, p.Omega, np.array([c]), np.zeros(1), np.array([free_part(x, v, s)]), stop)
    h = stop / _STEPS
    tau = np.asarray((np.arange(_STEPS) + 0.5) * h, dtype=np.float64)
    push = np.ones(_STEPS) if force == "tilt" else np.sign(motion.at(tau, 1) - v2)
    left = stop - tau
    dx2, dv2 = float(left @ push) * h, float(np.sum(push)) * h
    dx1 = dv1 = 0.0
    if force == "friction":
        back, kick = -p.mu * push, np.exp(s * left) / s.imag
        dx1, dv1 = float(kick.imag @ back) * h, float((s * kick).imag @ back) * h
    speed, turn = (float(motion.at(np.array([stop]), order)[0]) for order in (1, 2))
    dt = (dx2 - dx1) / (speed - v2)
    return np.array([dv1 + turn * dt, dv2, dx2 + v2 * dt, dt])
