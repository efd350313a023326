"""How far orbits of a ball that slides with friction are from where a turn becomes a stop, or a stop something else.

Where w' = 0 the frame pulls at the ball with (1 + mu) (x1'' + G), `draws` here, and friction holds it up to (1 + mu) f.
The ends of families at which this limit is met have the names of piecewise smooth systems (docs/orbits.md, "Orbits that
stop"), in which what is at rest here is called sliding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants, room_of, segment_state
from vines.dynamics.kernels import rows as col
from vines.orbits._contacts import completes
from vines.orbits._orbit import Orbit
from vines.orbits._release_of_balls import force_slope, run_round
from vines.orbits._slid import first_impact
from vines.orbits._slid_round import SlidRound

__all__ = ["RESTS", "rest_margins"]

Floats = npt.NDArray[np.float64]

CROSSING = "crossing_sliding"
SWITCHING = "switching_sliding"
ADDING = "adding_sliding"
TOUCHING = "grazing_sliding"

RESTS: tuple[str, ...] = (CROSSING, SWITCHING, ADDING, TOUCHING)
"""Types of ends of families with friction: a turn becomes a stop, or a stop a turn; a ball stops that turned first, and
stopped soon after; friction is only just enough inside a stop; the ball stops on its way, and goes on."""

_PARTS = 48
"""Parts of a stop, or of a slide, in which an extremum is looked for."""


def rest_margins(orbit: Orbit) -> dict[str, float]:
    """Return how far the force on a ball at rest is from the limit of friction, or |w'| from zero, by type of end.

    They are inf where there is no such place, or no friction.
    """
    found = dict.fromkeys(RESTS, math.inf)
    if not getattr(orbit.params, "f", 0.0) > 0:
        return found
    for kind, margin in _margins(orbit.params, _rows(orbit)):
        found[kind] = min(found[kind], margin)
    return found


def _rows(orbit: Orbit) -> Floats:
    p = orbit.params
    if not orbit.word.sticking:
        return SlidRound(orbit.word, p, first_impact(orbit), len(orbit.word)).rows
    section, z = orbit.release
    ran = run_round(p, section, orbit.period, z, section)
    return np.empty((0, col.ROW)) if ran is None else ran.rows


def _margins(p: Any, rows: Floats) -> Iterator[tuple[str, float]]:
    held, room, c = (1.0 + p.mu) * p.f, room_of(p), constants(p)

    def pull(row: Floats, tau: float) -> float:
        x1, v1, _, _, phase = segment_state(c, row, tau)
        return float(room.push(p, x1, v1, phase))

    def speed(row: Floats, tau: float) -> float:
        _, v1, _, v2, _ = segment_state(c, row, tau)
        return v1 - v2

    for i, (row, following) in enumerate(pairwise(rows)):
        lasts = float(following[col.TAU])
        if row[col.KIND] == col.STOP:
            kind, against = _met(p, row, row[col.SIDE], pull(row, 0.0))
            yield kind, held - against
            yield TOUCHING, held + against
            for sign in (1.0, -1.0):
                yield ADDING, held - _largest(lambda tau, row=row, sign=sign: sign * pull(row, tau), lasts)
        elif row[col.KIND] == col.SLIDE and row[col.RUN] == 0.0 and not _of_chatter(rows, i):
            kind, against = _met(p, row, -row[col.SIDE], pull(row, 0.0))
            yield kind, against - held
        if row[col.MODE] == 0.0 and lasts > 0.0:
            sense = math.copysign(1.0, speed(row, 0.5 * lasts))
            yield TOUCHING, -_largest(lambda tau, row=row, sense=sense: -sense * speed(row, tau), lasts)


def _of_chatter(rows: Floats, i: int) -> bool:
    """Say whether a turn is that of a hop of a chatter which completes: that ends in its own way."""
    return bool(rows[i - 1, col.KIND] == col.IMPACT and completes(rows, len(rows), i - 1))


def _met(p: Any, row: Floats, came: float, pull: float) -> tuple[str, float]:
    """Return what it is if the pull on a ball that comes to rest is at the limit, and the pull against its motion."""
    a = pull / (1.0 + p.mu) - p.G
    rate = force_slope(p, float(row[col.PHASE])) - p.lam * a - float(row[col.V1])
    # A pull that grows takes the ball along soon, and a stop is short; one that falls lets it stop soon if it turned.
    return (CROSSING if -came * rate > 0.0 else SWITCHING), -came * pull


def _largest(function: Callable[[float], float], lasts: float) -> float:
    """Return the largest value of a function at a maximum inside (0, lasts), -inf if there is none."""
    values = [function(lasts * k / _PARTS) for k in range(_PARTS + 1)]
    largest = -math.inf
    for k in range(1, _PARTS):
        if values[k - 1] < values[k] >= values[k + 1]:
            largest = max(largest, _peak(function, lasts * (k - 1) / _PARTS, lasts * (k + 1) / _PARTS))
    return largest


def _peak(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the maximum of a function with one between two places, by golden section."""
    share = 0.5 * (math.sqrt(5.0) - 1.0)
    a, b = high - share * (high - low), low + share * (high - low)
    left, right = function(a), function(b)
    while high - low > 1e-8:
        if left > right:
            high, b, right = b, a, left
            a = high - share * (high - low)
            left = function(a)
        else:
            low, a, left = a, b, right
            b = low + share * (high - low)
            right = function(b)
    return max(left, right)
