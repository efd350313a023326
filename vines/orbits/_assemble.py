"""From the impacts of a closed orbit to an `Orbit` with all that follows from them; the same for every word."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.model import VI_NES, X1, X2, Params, Word
from vines.orbits._budget import orbit_measures
from vines.orbits._floquet import FIXED_TIME, IMPACT_TO_IMPACT, half_map, monodromy, sorted_multipliers, squared
from vines.orbits._orbit import Orbit
from vines.orbits._smooth_orbit import assemble_smooth
from vines.orbits._survey import survey_kernel
from vines.orbits._values import marks_of

__all__ = ["assemble", "asymmetry", "begun_first"]

Floats = npt.NDArray[np.float64]

_SAME = 1e-9
"""Largest difference, in any component, of an orbit to its mirror image that counts as symmetric."""


def assemble(word: Word, p: Any, t: Floats, states: Floats, remark: str = "") -> Orbit:
    """Return the orbit with these impacts.

    Parameters
    ----------
    word : Word
    p : Params, or those of another system
    t : (N,) float array
        Times of the impacts in the order of any rotation of the word, increasing within one period pT; the phase of
        the forcing is zero at t = 0.
    states : (N, 4) float array
        x1, v1, x2, v2 just before each impact; of a word without impacts the state at phase 0.
    remark : str
        Kept with the orbit.
    """
    if word.unstruck:
        return assemble_smooth(word, p, states[0], remark)
    t, states = _canonical(word, p, t, states)
    duration = word.p * p.period
    side = marks_of(word)
    c = constants(p)
    jacobians, residual, clearance, violation, wall = survey_kernel(c, duration, side, t, states)
    gaps = np.diff(t, append=t[0] + duration)
    if wall == 0 and not np.all(gaps > 0):
        # Impacts of different balls have changed places.
        first = int(np.argmin(gaps > 0))
        violation, wall = t[first], word.sides[first]
    symmetric = asymmetry(word, duration, t, states) < _SAME
    half = (
        sorted_multipliers(half_map(jacobians, IMPACT_TO_IMPACT if isinstance(p, Params) else FIXED_TIME))
        if symmetric
        else None
    )
    for array in (t, states, jacobians):
        array.setflags(write=False)
    return Orbit(
        word=word,
        params=p,
        t=t,
        states=states,
        jacobians=jacobians,
        multipliers=squared(half) if half is not None else sorted_multipliers(monodromy(jacobians)),
        half_multipliers=half,
        symmetric=symmetric,
        admissible=wall == 0 and clearance > 0,
        min_clearance=float(clearance),
        violation_time=float(violation),
        violation_side=int(wall),
        residual=float(residual),
        measures=orbit_measures(p, c, word, t, states),
        remark=remark,
    )


def _canonical(word: Word, p: Any, t: Floats, states: Floats) -> tuple[Floats, Floats]:
    """Rotate to the canonical first impact, the one of least phase if there are several, and shift it into [0, T)."""
    if any(word.balls):
        # Such orbits are solved for in the canonical order.
        starts = list(word.rotations())
    else:
        letters = VI_NES.letters(states[:, X1] - states[:, X2])
        starts = [k for k in range(len(t)) if letters[k:] + letters[:k] == word.letters]
    k, times = begun_first(starts, word, p, t)
    return times, np.concatenate([states[k:], states[:k]])


def begun_first(starts: Iterable[int], word: Word, p: Any, t: Floats) -> tuple[int, Floats]:
    """Return the start of least phase of those from which contacts read as the word, and the times from it on."""
    k = min(starts, key=lambda k: (float(t[k] % p.period), k))
    times = np.concatenate([t[k:], t[:k] + word.p * p.period])
    return k, times - math.floor(times[0] / p.period) * p.period


def asymmetry(word: Word, duration: float, t: Floats, states: Floats) -> float:
    """Return the largest difference, in any component, of an orbit to its mirror image; inf if its word forbids it."""
    if not word.symmetric:
        return math.inf
    half = len(t) // 2
    late, other = t[half:] - t[:half] - duration / 2, states[half:] + states[:half]
    return float(max(np.abs(late).max(), np.abs(other).max()))
