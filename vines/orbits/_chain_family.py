"""The orbits of any system as a family: their closing equations in the phases of the impacts and one parameter."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.orbits._assemble import assemble
from vines.orbits._equations import closing_kernel
from vines.orbits._orbit import Orbit
from vines.orbits._values import frequency_of, marks_of

__all__ = ["ChainProblem"]

Floats = npt.NDArray[np.float64]

_DIFFERENCE = 1e-6
"""Relative step of the differences in the parameter: they steer Newton's method and do not move its fixed point."""


class ChainProblem:
    """Orbits of any word of any system as the zero set of n equations in (n phases, parameter); see `Problem`.

    n is N, or N/2 for a symmetric orbit, as for `GeneralProblem`.

    Parameters
    ----------
    orbit : Orbit
        Gives the word and the parameters that stay fixed.
    parameter : str
        Name of the parameter that varies.
    symmetric : bool, optional
        Whether the family is to be kept symmetric; by default if the orbit is.
    """

    def __init__(self, orbit: Orbit, parameter: str, symmetric: bool | None = None) -> None:
        self.word = orbit.word
        self.parameter = parameter
        self._fixed = orbit.params
        self._side = marks_of(orbit.word)
        n = len(orbit.word) // 2 if (orbit.symmetric if symmetric is None else symmetric) else len(orbit.word)
        value = orbit.params.as_dict()[parameter]
        self.start = np.append(orbit.t[:n] * frequency_of(orbit.params), value)

    def _at(self, phases: Floats, value: float) -> tuple[Any, Floats, Floats, Floats, Floats]:
        """Return parameters, times, defects, their slope in the times, and states."""
        p = self._fixed.replace(**{self.parameter: value})
        sets = len(self._side) // len(phases)
        shifts = math.pi * self.word.p * np.repeat(np.arange(sets), len(phases))
        t = (np.tile(phases, sets) + shifts) / frequency_of(p)
        regular, defect, slope, states = closing_kernel(constants(p), self.word.p * p.period, self._side, t)
        return p, t, defect if regular else np.full(len(t), np.nan), slope, states

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the defects in velocities of the balls, shape (n,), and their derivatives, shape (n, n + 1)."""
        phases, value = y[:-1], float(y[-1])
        n = len(phases)
        p, _, defect, slope, _ = self._at(phases, value)
        folded = slope[:n].reshape(n, -1, n).sum(axis=1) / frequency_of(p)
        step = _DIFFERENCE * max(abs(value), 0.01)
        above, below = self._at(phases, value + step)[2], self._at(phases, value - step)[2]
        return defect[:n], np.column_stack([folded, (above - below)[:n] / (2 * step)])

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        p, t, _, _, states = self._at(y[:-1], float(y[-1]))
        return assemble(self.word, p, t, states)
