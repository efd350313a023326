"""How far orbits of balls in parallel that stick are from ceasing to be ones: clearance, contact force, its fall."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants, derivatives, flight, pull, turn
from vines.dynamics.kernels import rows as col
from vines.dynamics.parallel.kernels import R_V2, R_X2, frame_with
from vines.kernels import linked_njit, njit
from vines.orbits._release_of_balls import falling
from vines.orbits._survey import NO_TURNING, inspect_flight

__all__ = ["clearance_of_balls", "fall_of_balls", "least_of_balls"]

Floats = npt.NDArray[np.float64]

_SHORT = 1e-4
"""Flights shorter than this turn once, away from the wall; after a release the ball has hardly left the wall before."""

_PARTS = 64
"""Parts of a spell in which a minimum of the contact force is looked for."""


def clearance_of_balls(p: Any, rows: Floats) -> float:
    """Return the least distance of a turning point of a flight to the wall that it points at."""
    c, least = constants(p), NO_TURNING
    loaded = {0.0: c}
    for row, tau in zip(rows[:-1], rows[1:, col.TAU].tolist(), strict=True):
        if tau <= 2 * _SHORT:
            continue
        mode = float(row[col.MODE])
        if mode not in loaded:
            loaded[mode] = c._replace(free=frame_with(c, mode))
        o = loaded[mode]
        motion = flight(o, o.free, row[col.X1], row[col.A_V1], row[col.PHASE], 0.0)
        x1, v1, _, _, _ = derivatives(o.free, o.Omega, *turn(o.free, o.Omega, *motion, _SHORT))
        for k in range(p.balls):
            if int(abs(mode)) >> k & 1:
                continue
            x2 = row[R_X2 + 2 * k] + _SHORT * (row[R_V2 + 2 * k] - 0.5 * p.G * _SHORT)
            v2 = row[R_V2 + 2 * k] - p.G * _SHORT
            phase = row[col.PHASE] + p.Omega * _SHORT
            distance, _, _ = inspect_flight(o, p.beta[k], 0, x1, v1, x2, v2, phase, tau - _SHORT)
            least = min(least, float(distance))
    return least


@njit
def _push(c, o, motion, side, tau):
    """Return side (x1'' + G) of the loaded frame, and its derivative."""
    _, _, a, j, _ = derivatives(o, c.Omega, *turn(o, c.Omega, *motion, tau))
    return side * pull(c, a), side * j


@linked_njit
def _least_of_ride(c, row, tau):
    """Return the least side (x1'' + G) at a minimum within a time tau after a row where balls ride, inf if none."""
    side = 1.0 if row[col.MODE] > 0.0 else -1.0
    o = frame_with(c, row[col.MODE])
    motion = flight(c, o, row[col.X1], row[col.A_V1], row[col.PHASE], 0.0)
    least = math.inf
    before = _push(c, o, motion, side, 0.0)[1]
    for k in range(1, _PARTS + 1):
        here = _push(c, o, motion, side, tau * k / _PARTS)[1]
        if before < 0.0 <= here:
            low, high = tau * (k - 1) / _PARTS, tau * k / _PARTS
            for _ in range(60):
                middle = 0.5 * (low + high)
                if _push(c, o, motion, side, middle)[1] < 0.0:
                    low = middle
                else:
                    high = middle
            least = min(least, _push(c, o, motion, side, 0.5 * (low + high))[0])
        before = here
    return least


def least_of_balls(p: Any, row: Floats, tau: float) -> float:
    """Return the least side (x1'' + G) at a minimum within a time after a row where balls ride, inf if none."""
    return float(_least_of_ride(constants(p), row, tau))


def fall_of_balls(p: Any, row: Floats) -> float:
    """Return the rate at which the contact force falls at a row where balls are let go."""
    return abs(falling(p, float(row[col.PHASE]), float(row[col.V1])))
