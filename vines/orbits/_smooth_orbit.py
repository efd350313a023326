"""Orbits without impacts: from the state at phase 0 of the forcing to an `Orbit`, and which of them are one."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.model import Word
from vines.orbits._floquet import FIXED_TIME, sorted_multipliers, squared
from vines.orbits._orbit import Orbit
from vines.orbits._smooth_flow import fly, measures_of, passages, seen
from vines.orbits._survey import NO_TURNING

__all__ = ["assemble_smooth", "same_smooth", "smooth_doubled", "smooth_image", "smooth_origin"]

Floats = npt.NDArray[np.float64]

_SAME = 1e-9
"""Largest difference, in any coordinate, of an orbit to its mirror image that counts as symmetric."""

_ONE = 1e-6
"""The same of two orbits that are one, or of an orbit to its own repetition."""


def assemble_smooth(word: Word, p: Any, start: Floats, remark: str = "") -> Orbit:
    """Return the orbit without impacts through a state at phase 0.

    It has one row for the passage through phase 0, as if that were a contact at no wall; of several the one with the
    largest x1.
    """
    c, T = constants(p), p.period
    points = passages(p, c, start, word.p)
    residual = float(np.abs(points[-1] - points[0]).max())
    points = np.roll(points[:-1], -int(np.argmax(points[:-1, 0])), axis=0)
    start = points[0]
    points = np.vstack([points, start])
    flown = fly(c, start, word.p * T)
    half = None
    symmetric = _mirror_defect(word, p, c, start) < _SAME
    if symmetric:
        half = sorted_multipliers(FIXED_TIME[:, None] * fly(c, start, word.p * T / 2).map)
    clearance, violation, wall = _clearance(word, p, c, start) if p.walls else (math.nan, math.nan, 0)
    t, states, jacobians = np.zeros(1), start[None, :].copy(), flown.map[None, :, :]
    for array in (t, states, jacobians):
        array.setflags(write=False)
    return Orbit(
        word=word,
        params=p,
        t=t,
        states=states,
        jacobians=jacobians,
        multipliers=squared(half) if half is not None else sorted_multipliers(flown.map),
        half_multipliers=half,
        symmetric=symmetric,
        admissible=not p.walls or (wall == 0 and clearance > 0),
        min_clearance=clearance,
        violation_time=violation,
        violation_side=wall,
        residual=residual,
        measures=measures_of(p, c, points),
        remark=remark,
        struck=states[:, [1, 3]],
    )


def _clearance(word: Word, p: Any, c: Any, start: Floats) -> tuple[float, float, int]:
    """Return least clearance of a turning point, time and wall of the first contact."""
    if p.A > 0.0:
        return seen(c, start, word.p * p.period)
    # At rest nothing turns.
    gap = float(start[0] - start[2])
    return (NO_TURNING, math.nan, 0) if abs(gap) < 1.0 else (1.0 - abs(gap), 0.0, int(math.copysign(1.0, gap)))


def _mirror_defect(word: Word, p: Any, c: Any, start: Floats) -> float:
    """Return how far a state is from that of the mirror image half a period later; inf if the word forbids it."""
    if not (word.symmetric and p.mirrored):
        return math.inf
    return float(np.abs(fly(c, start, word.p * p.period / 2).end + start).max())


def repeats_sooner(word: Word, points: Floats) -> float:
    """Return how far an orbit is from the repetition of one of a shorter period."""
    shorter = [q for q in range(1, word.p) if word.p % q == 0]
    return min((float(np.abs(points[q] - points[0]).max()) for q in shorter), default=math.inf)


def smooth_origin(orbit: Orbit, within: float) -> str | None:
    """Return the bifurcation by which an orbit at a fold of its family comes out of another one; see `origin`."""
    c, start = constants(orbit.params), orbit.states[0]
    if _mirror_defect(orbit.word, orbit.params, c, start) < within:
        return "symmetry_breaking"
    if repeats_sooner(orbit.word, passages(orbit.params, c, start, orbit.word.p)) < within:
        return "period_doubling"
    return None


def same_smooth(orbit: Orbit, start: Floats) -> bool:
    """Say whether the orbit through a state at phase 0 is an orbit, up to a shift of time."""
    points = passages(orbit.params, constants(orbit.params), orbit.states[0], orbit.word.p - 1)
    return bool((np.abs(points - start).max(axis=1) < _ONE).any())


def smooth_image(orbit: Orbit) -> Orbit:
    """Return the mirror image of an orbit: where it is half a forcing period later, with the signs turned."""
    end = fly(constants(orbit.params), orbit.states[0], orbit.params.period / 2).end
    return assemble_smooth(orbit.word, orbit.params, -end, orbit.remark)


def smooth_doubled(orbit: Orbit) -> Orbit:
    """Return an orbit gone through twice."""
    return assemble_smooth(Word(f"-/{2 * orbit.word.p}T"), orbit.params, orbit.states[0])
