"""The symmetric 1:1/pT orbits as `Orbit`s, and as a family that can be followed in any parameter."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.domains import Parameters, Whole, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import V2, Params, Word
from vines.orbits._assemble import assemble
from vines.orbits._closed_form import (
    SymmetricFamily,
    family_of,
    family_where,
    fold_amplitude,
    fold_speed,
    impact_states,
    speeds,
)
from vines.orbits._closing import difference
from vines.orbits._orbit import Orbit

__all__ = ["SymmetricProblem", "no_symmetric_orbit", "symmetric_fold", "symmetric_orbits"]

Floats = npt.NDArray[np.float64]

_DIFFERENCE = 1e-6
"""Relative step of the differences in the parameter: they steer Newton's method and do not move its fixed point."""


def _family(p: Params, period: int) -> SymmetricFamily:
    return family_of(p.mu, p.Omega, p.r, p.lam, period)


@stated(ParameterError, p=Parameters(any_system=False), period=Whole(most=1001))
def symmetric_orbits(p: Params, period: int = 1) -> list[Orbit]:
    """Return the symmetric 1:1/pT orbits, admissible or not, the one of highest impact speed first.

    Parameters
    ----------
    p : Params
    period : int
        p, odd: the orbit closes after p forcing periods.

    Returns
    -------
    list of Orbit
        None, one or two.

    Raises
    ------
    ParameterError
        If `period` is not an odd positive integer.

    Notes
    -----
    Closed form, derived in docs/orbits.md.

    Examples
    --------
    >>> from vines.model import Params
    >>> [orbit] = symmetric_orbits(Params(mu=0.01, A=0.017))
    >>> orbit.name, orbit.stable, orbit.admissible
    ('1:1', True, True)
    """
    family = _family(p, period)
    word = Word(f"LR/{period}T")
    return [assemble(word, p, *impact_states(family, V, p.A, p.Omega)) for V in speeds(family, p.A)]


@stated(ParameterError, p=Parameters(any_system=False), period=Whole(most=1001))
def symmetric_fold(p: Params, period: int = 1) -> Params | None:
    """Return the parameters with A at the fold of the symmetric 1:1/pT orbits, or None where they have no fold.

    Below this A there is no symmetric orbit, just above it there are two. The A of the argument does not matter.

    Examples
    --------
    >>> from vines.model import Params
    >>> print(f"{symmetric_fold(Params(mu=0.01, A=0.02)).A:.12f}")
    0.007553...
    """
    family = _family(p, period)
    return p.replace(A=fold_amplitude(family)) if fold_speed(family) > 0 else None


def no_symmetric_orbit(p: Params, word: Word) -> OrbitNotFound:
    """Return the error that says how far the amplitude is from the least one with a symmetric orbit."""
    least = fold_amplitude(_family(p, word.p))
    return OrbitNotFound(
        f"no symmetric {word.name} orbit at A = {p.A:g}: there is none below A = {least:.6g} "
        f"(mu = {p.mu:g}, Omega = {p.Omega:g}, r = {p.r:g}, lam = {p.lam:g}); raise A"
    )


class SymmetricProblem:
    """The symmetric 1:1/pT orbits as the zero set of one equation in (V, parameter); see `Problem`.

    Parameters
    ----------
    orbit : Orbit
        A symmetric 1:1/pT orbit, which gives the word and the parameters that stay fixed.
    parameter : str
        Name of the parameter that varies.
    """

    def __init__(self, orbit: Orbit, parameter: str) -> None:
        self.word = orbit.word
        self.parameter = parameter
        self._fixed = orbit.params.as_dict()
        self.start = np.array([-orbit.states[0, V2], self._fixed[parameter]])

    def _defect(self, V: float, values: Floats) -> Floats:
        """Return the defect of the quadratic for V at a value of the parameter, nan where the model does not exist."""
        now = {**self._fixed, self.parameter: float(values[0])}
        family = family_where(now, self.word.p)
        return np.array([math.nan if family is None else family.defect(V, now["A"])])

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the defect of the quadratic for V, shape (1,), and its derivatives, shape (1, 2)."""
        V, value = float(y[0]), float(y[1])
        family = family_where({**self._fixed, self.parameter: value}, self.word.p)
        if family is None:
            return np.full(1, np.nan), np.full((1, 2), np.nan)
        step = _DIFFERENCE * max(abs(value), 0.01)
        across = difference(lambda values: self._defect(V, values), y[1:], 0, step)
        return self._defect(V, y[1:]), np.array([[family.slope(V), across[0]]])

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        p = Params(**{**self._fixed, self.parameter: float(y[1])})
        return assemble(self.word, p, *impact_states(_family(p, self.word.p), float(y[0]), p.A, p.Omega))
