"""Orbits that stick, of one word, as a family: a release that comes back, and one parameter."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.errors import ParameterError
from vines.model import Params, Word
from vines.orbits._family import DIFFERENCE
from vines.orbits._orbit import Orbit
from vines.orbits._sticking_orbit import Release, Round, release_of, sticking_orbit

__all__ = ["StickingProblem"]

Floats = npt.NDArray[np.float64]


class StickingProblem:
    """Orbits of a word with a star as the zero set of two equations in (phase and v1 of a release, parameter).

    A symmetric family is kept symmetric: its release comes back as its mirror image after half the period.

    Parameters
    ----------
    orbit : Orbit
        Gives the word and the parameters that stay fixed.
    parameter : str
        Name of the parameter that varies.
    word : Word, optional
        Another word, of which the orbit is one too: its own, gone through twice.
    symmetric : bool, optional
        Whether the family is to be kept symmetric; by default if the orbit is.
    """

    def __init__(
        self, orbit: Orbit, parameter: str, *, word: Word | None = None, symmetric: bool | None = None
    ) -> None:
        self.word = orbit.word if word is None else word
        self.parameter = parameter
        self._fixed = orbit.params
        self._round = Round(self.word, half=orbit.symmetric if symmetric is None else symmetric)
        begin = release_of(orbit)
        self.start = np.array([begin.phase, begin.v1, orbit.params.as_dict()[parameter]])

    def _params(self, value: float) -> Params | None:
        try:
            return self._fixed.replace(**{self.parameter: value})
        except ParameterError:
            return None

    def _defect(self, y: Floats) -> tuple[Floats, Floats] | None:
        """Return by how much the release comes late and too fast, and the slopes of the round; None without a round."""
        p = self._params(float(y[-1]))
        met = self._round.run(p, Release(float(y[0]), float(y[1]))) if p is not None else None
        if p is None or met is None:
            return None
        out = met[1]
        return np.array([out[0] - self._round.span(p.period), out[1] - self._round.sign * y[1]]), out

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return what is left of time and velocity, shape (2,), and its derivatives, shape (2, 3); nan without a round.

        Derivatives by the release are those of the tangent map, those by the parameter differences.
        """
        here = self._defect(y)
        if here is None:
            return np.full(2, math.nan), np.full((2, 3), math.nan)
        value, out = here
        matrix = np.empty((2, 3))
        frequency = y[-1] if self.parameter == "Omega" else self._fixed.Omega
        matrix[:, 0] = np.array([out[2] - 1.0, out[4]]) / frequency
        matrix[:, 1] = out[3], out[5] - self._round.sign
        matrix[:, 2] = self._by_parameter(y, value)
        return value, matrix

    def _by_parameter(self, y: Floats, here: Floats) -> Floats:
        step = DIFFERENCE * max(abs(float(y[-1])), 0.01)
        sides = [(shift, self._defect(np.array([y[0], y[1], y[2] + shift]))) for shift in (step, -step)]
        known = [(shift, met[0]) for shift, met in sides if met is not None]
        if not known:
            return np.full(2, math.nan)
        # Where there is a round on one side only its difference to what is here has to do.
        (a, above), (b, below) = known if len(known) == 2 else (known[0], (0.0, here))
        return (above - below) / (a - b)

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        p = self._fixed.replace(**{self.parameter: float(y[-1])})
        return sticking_orbit(self.word, p, Release(float(y[0]), float(y[1])))
