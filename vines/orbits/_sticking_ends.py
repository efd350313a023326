"""Where a family of orbits that stick or stop ends, and why: what it needs of flights, chatters, spells runs out.

The simulator's map from release to release exists on one side of such an end only, so that no function of it changes
its sign there: the branch is followed until steps of 1e-8 fail, and the end is where the margin that runs out would
vanish (docs/sticking.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from vines.orbits._conditions import TIE, tie_margin
from vines.orbits._problem import Point
from vines.orbits._rests import RESTS, rest_margins
from vines.orbits._riding_alone import only_held

__all__ = [
    "GRAZING",
    "INCOMPLETE_CHATTER",
    "RELEASE_TANGENCY",
    "End",
    "SelfSimilar",
    "chatter_exponent",
    "end_of",
    "self_similar",
    "what_vanishes",
]

GRAZING = "grazing"
INCOMPLETE_CHATTER = "incomplete_chatter"
RELEASE_TANGENCY = "release_tangency"

_BASE = 1e-6
"""Distance of the points, in ranges of the parameter, from whose margins the end is extrapolated."""

_NEAR = 1e-4
"""Most by which the parameter may have to be moved on to the end, in ranges of the parameter."""


class End(NamedTuple):
    """The end of a family: its type, and by how much farther than the last orbit the parameter gets."""

    type: str
    beyond: float


class SelfSimilar(NamedTuple):
    """The chatter that is only just complete, to lowest order in the time s left of it.

    Attributes
    ----------
    hop : float
        Departure speed over j s², j being the rate at which the push falls.
    shrink : float
        Of the time left, from one impact to the next.
    growth : float
        Of a small deviation of `hop`.
    """

    hop: float
    shrink: float
    growth: float


def self_similar(r: float) -> SelfSimilar:
    """Return how a chatter accumulates that is only just complete, where the contact force vanishes (0 < r < 1).

    Near that place the ball is pushed by w'' = j s towards the wall, s the time left, and the hops with departure speed
    u = rho j s² repeat at rho = rho*: each leaves 1 - y of the time, with (3 - y)(1 - y)² = r (3 - 2 y). A deviation of
    rho grows at each impact (docs/sticking.md).
    """
    low, high = 0.0, 1.0
    for _ in range(200):
        y = 0.5 * (low + high)
        if (3 - y) * (1 - y) ** 2 > r * (3 - 2 * y):
            low = y
        else:
            high = y
    y = 0.5 * (low + high)
    grows = r * ((1 / 2 - 2 * y / 3) / (1 - y) ** 2 + 2 * (y / 2 - y * y / 3) / (1 - y) ** 3) / (1 / 2 - y / 3)
    return SelfSimilar(y / 2 - y * y / 6, 1 - y, grows)


def chatter_exponent(r: float) -> float:
    """Return the power of the distance to the end with which the stick after a chatter vanishes there.

    Once a deviation has grown as large as rho itself the chatter is over, complete or not, after a number of impacts
    that is the logarithm of the distance to the end over that of its growth. What is left then is the stick.

    Examples
    --------
    >>> print(f"{chatter_exponent(0.35):.4f} {chatter_exponent(0.65):.4f}")
    0.6068 0.6012
    """
    limit = self_similar(r)
    return math.log(1 / limit.shrink) / math.log(limit.growth)


def _speeds(point: Point) -> float:
    orbit = point.orbit
    # A ball that stops in mid-cavity has no speed, and always so.
    speeds = (orbit.side * orbit.w_dot)[orbit.side != 0]
    return float(min(np.min(speeds), np.min(orbit.spells["slowest"], initial=math.inf)))


def _stick(point: Point) -> float:
    """Return the length of the shortest spell, to the power with which it falls as the distance to its end.

    On the curve of such an end spells without length are not those that end next. With friction hops end where it
    alone would hold the ball, and the time left until then falls as that distance itself.
    """
    spells, p = point.orbit.spells, point.orbit.params
    if len(spells) == 0:
        return math.inf
    r = p.r
    lengths = spells["t_release"] - spells["t_start"]
    if getattr(p, "f", 0.0) > 0:
        return float(np.min(lengths - [only_held(p, spell) for spell in spells]))
    shortest = float(np.min(lengths[lengths > 0], initial=math.inf))
    if isinstance(r, tuple):
        ball = point.orbit.word.balls[int(spells["contact"][np.argmin(lengths)])]
        r = r[max(ball, 1) - 1]
    return max(shortest, 0.0) ** (1 / chatter_exponent(r)) if 0 < r < 1 else shortest


def _apart(point: Point) -> float:
    """Return the least time between contacts of several balls, inf of one alone."""
    return tie_margin(point) if any(point.orbit.word.balls) else math.inf


def _least(point: Point, name: str) -> float:
    return float(np.min(point.orbit.spells[name], initial=math.inf))


_MARGINS: tuple[tuple[str, Callable[[Point], float]], ...] = (
    (GRAZING, lambda point: point.orbit.min_clearance),
    (GRAZING, _speeds),
    (INCOMPLETE_CHATTER, _stick),
    (TIE, _apart),
    (RELEASE_TANGENCY, lambda point: _least(point, "falls")),
    (RELEASE_TANGENCY, lambda point: _least(point, "least_force")),
    *((kind, lambda point, kind=kind: rest_margins(point.orbit)[kind]) for kind in RESTS),
)


def what_vanishes(before: Point, last: Point, within: float) -> tuple[str, float] | None:
    """Return which margin runs out behind two points of a curve, and after how many more moves from one to the other.

    Parameters
    ----------
    before, last : Point
    within : float
        Most moves.
    """
    least, found = within, None
    for kind, margin in _MARGINS:
        first, second = margin(before), margin(last)
        if not (math.isfinite(first) and math.isfinite(second) and second < first):
            continue
        moves = second / (first - second)
        if abs(moves) < least:
            least, found = abs(moves), (kind, moves)
    return found


def end_of(points: Sequence[Point], width: float) -> End | None:
    """Return why a family ends just behind its last point, None if no margin runs out.

    Parameters
    ----------
    points : sequence of Point
        Of the family, up to the last one.
    width : float
        Of the range of the parameter.
    """
    last = points[-1]
    before = next((point for point in reversed(points) if abs(point.value - last.value) > _BASE * width), None)
    if before is None:
        return None
    move = last.value - before.value
    found = what_vanishes(before, last, _NEAR * width / abs(move))
    return None if found is None else End(found[0], float(move * found[1]))
