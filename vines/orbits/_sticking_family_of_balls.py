"""Orbits of balls in parallel that stick, of one word, as a family: a section that comes back, and one parameter."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.model import Word
from vines.orbits._closing import difference, stays_symmetric
from vines.orbits._family import DIFFERENCE
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._release_of_balls import run_closed
from vines.orbits._sticking_of_balls import Begun, balls_orbit

__all__ = ["BallsProblem"]

Floats = npt.NDArray[np.float64]


class BallsProblem:
    """Orbits of a word with a star as the zero set of k equations in (k coordinates of a section, parameter).

    Parameters
    ----------
    orbit : Orbit
        Gives the word, the section and the parameters that stay fixed.
    parameter : str
        Name of the parameter that varies.
    word : Word, optional
        Another word, of which the orbit is one too: its own, gone through twice.
    symmetric : bool, optional
        Whether the family is to be kept symmetric; by default if the orbit is, and remains so.
    """

    def __init__(
        self, orbit: Orbit, parameter: str, *, word: Word | None = None, symmetric: bool | None = None
    ) -> None:
        self.word = orbit.word if word is None else word
        self.parameter = parameter
        self._fixed = orbit.params
        self._mirrored = stays_symmetric(orbit, parameter) if symmetric is None else symmetric
        self._section, z = orbit.release
        self.start = np.append(z, orbit.params.as_dict()[parameter])

    def _closing(self, y: Floats) -> tuple[Floats, Floats]:
        n, p = len(y) - 1, moved(self._fixed, {self.parameter: y[-1]})
        nothing = np.full(n, math.nan), np.full((n, n), math.nan)
        if p is None:
            return nothing
        span = self.word.p * p.period / (2 if self._mirrored else 1)
        met = run_closed(p, self._section, span, y[:-1].copy(), mirrored=self._mirrored)
        return nothing if met is None else met[1]

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return what is left, shape (k,), and its derivatives, shape (k, k + 1); nan without a round.

        Derivatives by the coordinates are those of the tangent map, those by the parameter differences.
        """
        defect, slope = self._closing(y)
        if not np.isfinite(defect).all():
            return defect, np.column_stack([slope, defect])
        step = DIFFERENCE * max(abs(float(y[-1])), 0.01)
        across = difference(lambda at: self._closing(at)[0], y, len(y) - 1, step)
        return defect, np.column_stack([slope, across])

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        p = self._fixed.replace(**{self.parameter: float(y[-1])})
        return balls_orbit(self.word, p, Begun(self._section, y[:-1].copy()))
