"""Restitution of impacts by the displacement of the oscillator alone, as far as it can be told at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Bins

__all__ = ["rebounds"]

Floats = npt.NDArray[np.float64]

_NEAR, _FAR = 5e-4, 3e-3
"""Seconds before and after an impact between which the oscillator's velocity is taken."""
_SOFT = 0.3
"""Part of the usual speed below which an impact tells little."""
_PLAUSIBLE = (0.05, 1.2)


def rebounds(x1: Bins, t: Floats, side: Floats, b: float, omega: float) -> tuple[Floats, Floats]:
    """Return times [s] and r of the impacts between two flights.

    Parameters
    ----------
    x1 : Bins
        Displacement [m].
    t, side : ndarray, shape (n,)
        Impacts: times [s] and sides, +1 L, -1 R.
    b : float
        Half length of the cavity less the ball's radius [m].
    omega : float
        Angular frequency of the forcing [rad/s].

    Notes
    -----
    At an impact x2 = x1 - side b, so the ball's velocity in a flight is the difference of two such over its time. A
    flight that lasts longer than one and a half periods holds an impact that was not heard.
    """
    if len(t) < 3:
        return np.empty(0), np.empty(0)
    inside = (t > x1.t[0] + 2 * _FAR) & (t < x1.t[-1] - 2 * _FAR) if len(x1.t) else np.zeros(len(t), bool)
    t, side = t[inside], side[inside]
    if len(t) < 3:
        return np.empty(0), np.empty(0)

    def at(times: Floats) -> Floats:
        return np.interp(times, x1.t, x1.mean)

    middle = at(t)
    # Brought to the impact itself by the acceleration that swinging at omega has there.
    bend = -(omega**2) * (middle - x1.mean.mean()) * 0.5 * (_FAR + _NEAR)
    before = (at(t - _NEAR) - at(t - _FAR)) / (_FAR - _NEAR) + bend
    after = (at(t + _FAR) - at(t + _NEAR)) / (_FAR - _NEAR) - bend
    x2 = middle - side * b
    length = np.diff(t)
    ball = np.diff(x2) / length
    comes = before[1:-1] - ball[:-1]
    leaves = after[1:-1] - ball[1:]
    speed = comes * side[1:-1]
    longest = 3 * np.pi / omega
    good = (speed > _SOFT * np.median(np.abs(comes))) & (length[:-1] < longest) & (length[1:] < longest)
    r = -leaves[good] / comes[good]
    plausible = (r > _PLAUSIBLE[0]) & (r < _PLAUSIBLE[1])
    return t[1:-1][good][plausible], r[plausible]
