"""How far orbits that stick, of one ball on which more than the walls acts, are from ceasing to be ones."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants, room_of
from vines.dynamics.kernels import rows as col
from vines.orbits._motions import move_on
from vines.orbits._release_of_one import release_on
from vines.orbits._slid import clearance_of_rests
from vines.orbits._survey import NO_TURNING, inspect_row

__all__ = ["clearance_of_one", "fall_of_one", "least_of_one", "only_held"]

Floats = npt.NDArray[np.float64]

_SHORT = 1e-4
"""Flights shorter than this turn once, away from the wall; after a release the ball has hardly left the wall before."""

_NEWTON = 8

_PARTS = 64
"""Parts of a spell in which a minimum of the contact force is looked for."""


def clearance_of_one(p: Any, rows: Floats) -> float:
    """Return the least distance of a turning point of a flight to the wall that it points at."""
    if p.system.stops:
        return clearance_of_rests(rows)
    c, least = constants(p), NO_TURNING
    for row, tau in zip(rows[:-1], rows[1:, col.TAU].tolist(), strict=True):
        if tau <= 2 * _SHORT or row[col.MODE] != 0.0:
            continue
        later = row.copy()
        move_on(c, later, _SHORT)
        # A series begins at the gap that stands for the wall.
        later[col.SIDE] = later[col.X1] - later[col.X2]
        least = min(least, float(inspect_row(c, 0, later, tau - _SHORT)[0]))
    return least


def _force(p: Any, row: Floats, tau: float) -> tuple[float, float]:
    """Return the contact force of a spell over that with which a frame at rest would press, and its derivative."""
    room, side = room_of(p), int(row[col.MODE])
    section, here = release_on(p, side), row.copy()
    move_on(constants(p), here, tau)
    x1, v1, phase = (float(each) for each in here[[col.X1, col.A_V1, col.PHASE]])
    beside = section.beside(here)
    beyond = float(room.pushed(p, x1, v1, phase, beside)) - room.let_go(p, side)
    slopes = room.slopes(p, x1, v1, phase, beside)
    # Where the wall presses the frame is slower than the push alone would have it, and what moves beside feels that.
    share = 1.0 / (1.0 + room.law(p, 1).ratio)
    rate = section.rate(p, v1, slopes) + beyond * (
        share * slopes.by_state[1] - (1.0 - share) * slopes.by_state[2:] @ slopes.blown
    )
    return side * beyond, side * float(rate)


def least_of_one(p: Any, row: Floats, tau: float) -> float:
    """Return the least contact force at a minimum within a time after a row where the ball rides, inf if none."""
    least, before = math.inf, _force(p, row, 0.0)[1]
    for k in range(1, _PARTS + 1):
        here = _force(p, row, tau * k / _PARTS)[1]
        if before < 0.0 <= here:
            low, high = tau * (k - 1) / _PARTS, tau * k / _PARTS
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if _force(p, row, middle)[1] < 0.0 else (low, middle)
            least = min(least, _force(p, row, 0.5 * (low + high))[0])
        before = here
    return least


def fall_of_one(p: Any, row: Floats) -> float:
    """Return the rate at which the contact force falls at the row of a release."""
    section = release_on(p, int(row[col.SIDE]))
    return abs(section.falling(p, section.read(row)))


def only_held(p: Any, spell: npt.NDArray[np.void]) -> float:
    """Return how long before the end of a spell the ball stays on the wall by friction alone.

    A ball that left the wall then would not come back: a chatter has to be complete before.
    """
    force = 2.0 * (1.0 + p.mu) * getattr(p, "f", 0.0)
    if force == 0.0:
        return 0.0
    row = np.zeros(col.ROW)
    row[col.MODE], row[col.PHASE] = spell["side"], spell["phase_release"]
    row[[col.X1, col.X2]] = spell["x1"], spell["x1"] - spell["side"]
    row[[col.A_V1, col.A_V2]] = spell["v1"]
    early = force / float(spell["falls"])
    for _ in range(_NEWTON):
        here, rate = _force(p, row, -early)
        early += (here - force) / rate
    return early
