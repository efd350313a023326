"""Orbits that stick, of one word, as a family: a release that comes back, and one parameter."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.model import Params, Word
from vines.orbits._family import DIFFERENCE
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._sticking_orbit import Release, Round, release_of, sticking_orbit

__all__ = ["StickingProblem", "closing_of_round"]

Floats = npt.NDArray[np.float64]


def closing_of_round(way: Round, p: Params, phase: float, v1: float) -> tuple[Floats, Floats]:
    """Return by how much a release comes back late and too fast, and the slopes of both in its phase and velocity.

    They are nan where other contacts come.

    Parameters
    ----------
    way : Round
    p : Params
    phase, v1 : float
        Of the release.

    Returns
    -------
    (defect, slope)
        Shapes (2,) and (2, 2).
    """
    met = way.run(p, Release(phase, v1))
    if met is None:
        return np.full(2, math.nan), np.full((2, 2), math.nan)
    out = met[1]
    slope = np.array([[(out[2] - 1.0) / p.Omega, out[3]], [out[4] / p.Omega, out[5] - way.sign]])
    return np.array([out[0] - way.span(p.period), out[1] - way.sign * v1]), slope


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

    def _closing(self, y: Floats) -> tuple[Floats, Floats]:
        p = moved(self._fixed, {self.parameter: y[-1]})
        if p is None:
            return np.full(2, math.nan), np.full((2, 2), math.nan)
        return closing_of_round(self._round, p, float(y[0]), float(y[1]))

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return what is left of time and velocity, shape (2,), and its derivatives, shape (2, 3); nan without a round.

        Derivatives by the release are those of the tangent map, those by the parameter differences.
        """
        defect, slope = self._closing(y)
        return defect, np.column_stack([slope, self._by_parameter(y, defect)])

    def _by_parameter(self, y: Floats, here: Floats) -> Floats:
        step = DIFFERENCE * max(abs(float(y[-1])), 0.01)
        sides = [(shift, self._closing(np.array([y[0], y[1], y[2] + shift]))[0]) for shift in (step, -step)]
        known = [(shift, defect) for shift, defect in sides if np.isfinite(defect).all()]
        if not known or not np.isfinite(here).all():
            return np.full(2, math.nan)
        # Where there is a round on one side only its difference to what is here has to do.
        (a, above), (b, below) = known if len(known) == 2 else (known[0], (0.0, here))
        return (above - below) / (a - b)

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        p = self._fixed.replace(**{self.parameter: float(y[-1])})
        return sticking_orbit(self.word, p, Release(float(y[0]), float(y[1])))
