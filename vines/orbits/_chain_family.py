"""The orbits of any system as a family: their closing equations in the phases of the impacts and one parameter."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.orbits._assemble import assemble
from vines.orbits._closing import difference, stays_symmetric
from vines.orbits._orbit import Orbit
from vines.orbits._shooting import closing_of

__all__ = ["ChainProblem"]

Floats = npt.NDArray[np.float64]

_DIFFERENCE = 1e-6
"""Relative step of the differences in the parameter: they steer Newton's method and do not move its fixed point."""


class ChainProblem:
    """Orbits of any word of any system as the zero set of n equations in (n phases, parameter); see `Problem`.

    n is N, or N/2 for a symmetric orbit that remains one, as for `GeneralProblem`.

    Parameters
    ----------
    orbit : Orbit
        Gives the word and the parameters that stay fixed.
    parameter : str
        Name of the parameter that varies.
    symmetric : bool, optional
        Whether the family is to be kept symmetric; by default if the orbit is, and remains so.
    """

    def __init__(self, orbit: Orbit, parameter: str, symmetric: bool | None = None) -> None:
        self.word = orbit.word
        self.parameter = parameter
        kept = stays_symmetric(orbit, parameter) if symmetric is None else symmetric
        self._closing = closing_of(orbit, (parameter,), kept)
        self.start = self._closing.start

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the defects in velocities of the balls, shape (n,), and their derivatives, shape (n, n + 1).

        They are nan where the system does not exist.
        """
        phases, n = y[:-1], len(y) - 1
        closed = self._closing.at(phases, y[-1:])
        if closed is None:
            return np.full(n, np.nan), np.full((n, n + 1), np.nan)
        step = _DIFFERENCE * max(abs(float(y[-1])), 0.01)
        across = difference(lambda value: self._closing.defect(phases, value), y[-1:], 0, step)
        return closed.defect, np.column_stack([closed.slope, across])

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        closed = self._closing.at(y[:-1], y[-1:])
        assert closed is not None
        return assemble(self.word, closed.params, closed.t, closed.states)
