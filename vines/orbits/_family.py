"""The orbits of any word as a family: their closing equations in the phases of the impacts and one parameter."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.kernels import copy_values, linked_njit, new_matrix, new_vector, njit, zero_matrix
from vines.model import FREQUENCY, MASS, PARAMETER_NAMES
from vines.orbits._assemble import assemble
from vines.orbits._equations import closing_kernel
from vines.orbits._orbit import Orbit
from vines.orbits._values import essentials, values_of

__all__ = ["DIFFERENCE", "GeneralProblem", "closing_at", "unfold"]

Floats = npt.NDArray[np.float64]

DIFFERENCE = 1e-6
"""Relative step of the differences in a parameter: they steer Newton's method and do not move its fixed point."""


@njit
def unfold(values, p, side, phases):
    """Return the times of all impacts from the phases of the free ones; each further set of them comes pT/2 later."""
    t = new_vector(side.size)
    for j in range(side.size):
        t[j] = (phases[j % phases.size] + math.pi * p * (j // phases.size)) / values[FREQUENCY]
    return t


@linked_njit
def closing_at(values, p, side, phases):
    """Return the defects in the ball's velocity, their slope in the free phases, impact times and states.

    Parameters
    ----------
    values : (5,) float array
        mu, A, Omega, r, lam.
    p : int
        Forcing periods of the word.
    side : (N,) int array
    phases : (n,) float array
        Phases of the free impacts: all N, or the first half of a symmetric orbit.
    """
    n = phases.size
    t = unfold(values, p, side, phases)
    regular, defect, slope, states = closing_kernel(essentials(values), 2.0 * math.pi * p / values[FREQUENCY], side, t)
    if not regular:
        defect[:] = np.nan
    folded = zero_matrix(n, n)
    for i in range(n):
        for j in range(side.size):
            folded[i, j % n] += slope[i, j] / (values[MASS] * values[FREQUENCY])
    scaled = new_vector(n)
    for i in range(n):
        scaled[i] = defect[i] / values[MASS]
    return scaled, folded, t, states


@linked_njit
def _linearised(values, index, p, side, y):
    """Return the defects at y = (phases, parameter) and their derivatives in y."""
    n = y.size - 1
    values = values.copy()
    values[index] = y[n]
    defect, folded, _, _ = closing_at(values, p, side, y[:n])
    matrix = new_matrix(n, n + 1)
    for i in range(n):
        copy_values(matrix[i], folded[i])
    step = DIFFERENCE * max(abs(y[n]), 0.01)
    values[index] = y[n] + step
    above = closing_at(values, p, side, y[:n])[0]
    values[index] = y[n] - step
    below = closing_at(values, p, side, y[:n])[0]
    for i in range(n):
        matrix[i, n] = (above[i] - below[i]) / (2.0 * step)
    return defect, matrix


class GeneralProblem:
    """Orbits of any word as the zero set of n equations in (n phases of the impacts, parameter); see `Problem`.

    n is N, or N/2 for a symmetric orbit: the family is then kept symmetric, so that its equations stay regular where
    it loses stability by symmetry breaking.

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
        self._values = values_of(orbit.params)
        self._index = PARAMETER_NAMES.index(parameter)
        self._side = np.array(orbit.word.sides, dtype=np.int64)
        n = len(orbit.word) // 2 if (orbit.symmetric if symmetric is None else symmetric) else len(orbit.word)
        self.start = np.append(orbit.t[:n] * orbit.params.Omega, self._values[self._index])

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the defects of the ball's velocity, shape (n,), and their derivatives, shape (n, n + 1).

        Derivatives in the phases are analytic, those in the parameter differences.
        """
        return _linearised(self._values, self._index, self.word.p, self._side, y)

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        p = self._fixed.replace(**{self.parameter: float(y[-1])})
        values = self._values.copy()
        values[self._index] = y[-1]
        _, _, t, states = closing_at(values, self.word.p, self._side, y[:-1])
        return assemble(self.word, p, t, states)
