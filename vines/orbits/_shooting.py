"""The closing equations of orbits whose flights no closed form gives: all states at the impacts are unknown.

Between impacts orbits are flown by series, with the derivatives of each flight's end (multiple shooting).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.bounds import shown
from vines.dynamics.kernels import constants, room_of
from vines.errors import ParameterError
from vines.model import STATE_NAMES, X1, X2, Word
from vines.orbits._closing import Closed, Closing
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._shots import KINDS, shots_kernel
from vines.orbits._smooth_closing import SmoothClosing
from vines.orbits._values import frequency_of, marks_of

__all__ = ["Shooting", "closing_of", "refuse_no_walls", "shoots", "shot", "shot_from"]

Floats = npt.NDArray[np.float64]

_ITERATIONS = 40
_LEAST_SHARE = 1.0 / 64.0
"""Smallest part of a Newton step that is tried."""


def shoots(p: Any) -> bool:
    """Say whether the flights of a system have no closed form."""
    return isinstance(constants(p), KINDS)


def refuse_no_walls(p: Any) -> None:
    """Raise `ParameterError` where there are no walls that a word could tell of."""
    if not getattr(p, "walls", 1.0):
        raise ParameterError("walls is 0: a word tells of impacts; orbits without any have the words -, -/2T, …")


def _free(states: Floats) -> Floats:
    """Return what is unknown before impacts: x2 follows from x1 and the wall."""
    return np.delete(states, X2, axis=1)


def closing_of(orbit: Orbit, names: Sequence[str], symmetric: bool) -> Closing | Shooting | SmoothClosing:
    """Return the closing equations of the word of an orbit, in the form that its system has; see `Closing`."""
    if orbit.word.unstruck:
        return SmoothClosing(orbit, names, symmetric)
    return (Shooting if shoots(orbit.params) else Closing)(orbit, names, symmetric)


class Shooting:
    """As `Closing`; its phases are followed by all x1, all v1, all v2, … just before the free impacts."""

    def __init__(self, orbit: Orbit, names: Sequence[str], symmetric: bool) -> None:
        self.word = orbit.word
        self.side = marks_of(orbit.word)
        self._names = tuple(names)
        self._fixed = orbit.params
        self._sets = 2 if symmetric else 1
        n = len(self.side) // self._sets
        t, states = orbit.t[:n], orbit.states[:n]
        if symmetric:
            # An orbit next to the loss of its symmetry is the mean of itself and its mirror image.
            t = (t + orbit.t[n:] - orbit.period / 2) / 2
            states = (states - orbit.states[n:]) / 2
        values = [orbit.params.as_dict()[name] for name in names]
        self.start = np.concatenate([t * frequency_of(orbit.params), _free(states).T.ravel(), values])

    def params(self, values: Sequence[float] | Floats) -> Any:
        """Return the parameters with those that vary at some values, None where the system does not exist."""
        return moved(self._fixed, dict(zip(self._names, values, strict=True)))

    def at(self, phases: Floats, values: Sequence[float] | Floats) -> Closed | None:
        """Return what the equations say; None where the system does not exist."""
        p = self.params(values)
        if p is None:
            return None
        n = len(self.side) // self._sets
        c, duration, Omega = constants(p), self.word.p * p.period, frequency_of(p)
        t, free = phases[:n] / Omega, np.ascontiguousarray(phases[n:].reshape(-1, n).T)
        sign = 1.0 if self._sets == 1 else -1.0
        defect, slope = np.full(len(phases), np.nan), np.zeros((len(phases), len(phases)))
        span = duration / self._sets
        if np.all(np.diff(t, append=t[0] + span) > 0):
            shots_kernel(c, sign, span, self.side[:n], t, free, defect, slope)
        slope[:, :n] /= Omega
        states = np.insert(free, 2, free[:, X1] - self.side[:n], axis=1)
        if self._sets == 2:
            t, states = np.concatenate([t, t + span]), np.concatenate([states, -states])
        return Closed(p, c, duration, t, states, defect, slope)

    def defect(self, phases: Floats, values: Sequence[float] | Floats) -> Floats:
        """Return the defects alone, nan where the system does not exist."""
        closed = self.at(phases, values)
        return np.full(len(phases), np.nan) if closed is None else closed.defect


def shot_from(word: Word, p: Any, guess: object) -> tuple[bool, Floats, float, Floats]:
    """Return what Newton's method comes to from an orbit at nearby parameters, or from times and states; see `shot`.

    Raises
    ------
    ParameterError
        If there are no barriers, or the guess is neither an orbit nor an (N, 1 + d) array of times and states.
    """
    refuse_no_walls(p)
    if isinstance(guess, Orbit):
        return shot(word, p, guess.t * frequency_of(guess.params) / frequency_of(p), guess.states)
    try:
        found = np.asarray(guess, dtype=np.float64)
    except (TypeError, ValueError):
        found = np.empty(0)
    names = (*STATE_NAMES, *room_of(p).beside)
    if found.shape != (len(word), 1 + len(names)) or not np.isfinite(found).all():
        raise ParameterError(
            f"the guess is {shown(guess)}; of {p.system.name} give an orbit at nearby parameters, or rows of t, "
            f"{', '.join(names)} just before each of the {len(word)} impacts: times alone do not say how the mass flies"
        )
    return shot(word, p, found[:, 0], found[:, 1:])


def shot(word: Word, p: Any, t: Floats, states: Floats) -> tuple[bool, Floats, float, Floats]:
    """Return where Newton's method comes to from times and states of a guess.

    Parameters
    ----------
    t, states : (N,), (N, d) float array
        Times of the impacts, and x1, v1, x2, v2, … just before them.

    Returns
    -------
    (converged, t, defect, states)
        The largest defect.
    """
    N, side = len(t), marks_of(word)
    c, duration = constants(p), word.p * p.period
    z = np.concatenate([t, _free(states).T.ravel()])
    defect, slope = np.full(len(z), np.nan), np.zeros((len(z), len(z)))

    def size_at(z: Floats) -> float:
        flights = np.diff(z[:N], append=z[0] + duration)
        if not (np.all(flights > 0) and np.isfinite(z).all()):
            return math.inf
        shots_kernel(c, 1.0, duration, side, z[:N], np.ascontiguousarray(z[N:].reshape(-1, N).T), defect, slope)
        return float(np.abs(defect).max()) if np.isfinite(defect).all() else math.inf

    size = size_at(z)
    for _ in range(_ITERATIONS):
        if not math.isfinite(size):
            break
        try:
            step = np.linalg.solve(slope, defect)
        except np.linalg.LinAlgError:
            return False, t, size, states
        share, before = 1.0, size
        while True:
            size = size_at(z - share * step)
            if size < before or share * np.abs(step).max() < 1e-12 or share < _LEAST_SHARE:
                break
            share *= 0.5
        if not size < before and before < 1e-11:
            size = size_at(z)
            break
        z = z - share * step
        if np.abs(share * step).max() < 1e-14 * duration:
            break
    free = z[N:].reshape(-1, N).T
    return size < 1e-9, z[:N], size, np.insert(free, 2, free[:, X1] - side, axis=1)
