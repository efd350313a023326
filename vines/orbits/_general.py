"""Orbits of any word: Newton's method from a guess, and a search from many starts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.domains import Numbers
from vines.dynamics.kernels import constants
from vines.errors import OrbitNotFound, ParameterError
from vines.model import V1, V2, Word
from vines.orbits._assemble import assemble, asymmetry
from vines.orbits._closed_form import refuse_resonance
from vines.orbits._equations import newton_kernel
from vines.orbits._orbit import Orbit
from vines.orbits._shooting import shoots, shot_from
from vines.orbits._smooth_orbit import same_smooth, smooth_origin
from vines.orbits._smooth_search import refine_smooth
from vines.orbits._values import frequency_of, marks_of, unit_of

__all__ = ["ITERATIONS", "check_word", "origin", "proper", "refine", "same", "search"]

Floats = npt.NDArray[np.float64]

ITERATIONS = 60
_STARTS_PER_IMPACT = 60
_SAME = 1e-6
"""Largest difference of times and states of two orbits that are one, or of an orbit to its own repetition."""

_NEAR = 1e-3
"""The same at a point where families join, which the degenerate equations there give to half the digits only."""


def check_word(guess: Orbit, word: Word) -> None:
    """Raise `ParameterError` if a guess is an orbit of another word."""
    if guess.word != word:
        raise ParameterError(f"the guess is an orbit of {guess.word}, not of {word}; give one of the same word")


def refine(word: Word, p: Any, guess: Orbit | npt.ArrayLike) -> Orbit:
    """Return the orbit that Newton's method finds from a guess.

    Raises
    ------
    OrbitNotFound
        If it does not converge to an orbit of this word that meets the walls from inside.
    ParameterError
        If the guess does not fit the word, or at Omega = 1 without damping where that has no steady response.
    """
    if word.unstruck:
        return refine_smooth(word, p, guess)
    if not shoots(p):
        refuse_resonance(p)
    if isinstance(guess, Orbit):
        check_word(guess, word)
    if shoots(p):
        converged, t, defect, states = shot_from(word, p, guess)
    else:
        times = _times_of(word, p, guess)
        converged, t, defect, states = newton_kernel(constants(p), word.p * p.period, marks_of(word), times, ITERATIONS)
    if not converged:
        raise OrbitNotFound(
            f"no {word} orbit from this guess at {p}: Newton's method stopped at a defect of {defect / unit_of(p):.2g};"
            " give a nearer guess, such as an orbit at nearby parameters"
        )
    if not proper(word, word.p * p.period, t, states):
        raise OrbitNotFound(
            f"no {word} orbit from this guess at {p}: it leads to a solution that passes through a wall or has a "
            "shorter period; give another guess"
        )
    return assemble(word, p, t, states)


def _times_of(word: Word, p: Any, guess: Orbit | npt.ArrayLike) -> Floats:
    if isinstance(guess, Orbit):
        times = guess.t * frequency_of(guess.params) / frequency_of(p)
    else:
        Numbers(most=2 * len(word)).check("guess", guess, ParameterError)
        times = np.asarray(guess, dtype=np.float64)
    duration = word.p * p.period
    if times.shape != (len(word),) or not np.all(np.diff(times) > 0) or not times[-1] - times[0] < duration:
        raise ParameterError(
            f"the guess for {word} has to be {len(word)} increasing times within {word.p} forcing periods, "
            f"{duration:.6g}; it is {np.array2string(times, precision=4, threshold=8)}"
        )
    return times


def search(word: Word, p: Any) -> tuple[list[Orbit], float]:
    """Return the different orbits of a word that are found from many starts, and the least defect of a failed one.

    The starts are drawn from a fixed seed, uniformly over the flight times and the phase.
    """
    c, duration, side = constants(p), word.p * p.period, marks_of(word)
    rng = np.random.default_rng(len(word))
    found: list[Orbit] = []
    nearest = math.inf
    for _ in range(_STARTS_PER_IMPACT * len(word)):
        flights = rng.dirichlet(np.ones(len(word))) * duration
        start = rng.uniform(0, p.period) + np.concatenate([[0.0], np.cumsum(flights[:-1])])
        converged, t, defect, states = newton_kernel(c, duration, side, start, ITERATIONS)
        if not converged:
            nearest = min(nearest, defect / unit_of(p))
        elif proper(word, duration, t, states) and not any(same(orbit, t, states) for orbit in found):
            found.append(assemble(word, p, t, states))
    return found, nearest


def proper(word: Word, duration: float, t: Floats, states: Floats) -> bool:
    """Say whether a solution is an orbit of least period pT whose impacts are in order and come from inside."""
    if not np.all(np.diff(t, append=t[0] + duration) > 0):
        return False
    if not np.all(np.array(word.sides) * (states[:, V1] - states[:, V2]) > 0):
        return False
    return _repetition(word, duration, t, states) >= _SAME


def _repetition(word: Word, duration: float, t: Floats, states: Floats) -> float:
    """Return how far, in any component, an orbit is from the repetition of one with a shorter period."""
    least = math.inf
    for times in range(2, word.p + 1):
        if word.p % times or len(word) % times or word.letters[: len(word.letters) // times] * times != word.letters:
            continue
        shift = len(word) // times
        later = np.append(t[shift:], t[:shift] + duration) - duration / times
        difference = max(np.abs(later - t).max(), np.abs(np.roll(states, -shift, axis=0) - states).max())
        least = min(least, float(difference))
    return least


def origin(orbit: Orbit, within: float = _NEAR) -> str | None:
    """Return the bifurcation by which an orbit at a fold of its family comes out of another family, None if it is none.

    A family that broke the symmetry meets its mirror image there, a doubled one its own repetition; both look like
    folds from within. `within` is how near to the other family counts as on it.
    """
    if orbit.word.unstruck:
        return smooth_origin(orbit, within)
    mirrored = orbit.params.mirrored and orbit.word.symmetric
    if mirrored and asymmetry(orbit.word, orbit.period, orbit.t, orbit.states) < within:
        return "symmetry_breaking"
    if _repetition(orbit.word, orbit.period, orbit.t, orbit.states) < within:
        return "period_doubling"
    return None


def same(orbit: Orbit, t: Floats, states: Floats) -> bool:
    """Say whether a solution at the parameters of an orbit is that orbit, up to a shift of time.

    Parameters
    ----------
    orbit : Orbit
    t, states : (N,), (N, 4) float array
        Times of the impacts in canonical order, and the states just before them.
    """
    if orbit.word.unstruck:
        return same_smooth(orbit, states[0])
    T, N = orbit.params.period, len(orbit.t)
    for k in orbit.word.rotations():
        shift = np.append(t[k:], t[:k] + orbit.period) - orbit.t
        shift -= T * np.round(shift[0] / T)
        if max(np.abs(shift).max(), np.abs(states[np.arange(k, k + N) % N] - orbit.states).max()) < _SAME:
            return True
    return False
