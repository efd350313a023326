"""Smooth coordinates on the orbits of a family that hang together when several parameters are free.

Near a fold an orbit is not a smooth function of the parameters, but orbits and parameters together form a smooth
surface. A chart of it has its tangent plane at one orbit as coordinates; Newton's method normal to the plane leads back
to the surface (docs/optimum.md).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound, ParameterError
from vines.model import V2, Params
from vines.orbits._assemble import assemble
from vines.orbits._closed_form import family_of, impact_states
from vines.orbits._family import closing_at
from vines.orbits._orbit import Orbit
from vines.orbits._values import values_of

if TYPE_CHECKING:
    from vines.orbits._box import Box

__all__ = ["Chart"]

Floats = npt.NDArray[np.float64]

_DIFFERENCE = 1e-6
_ITERATIONS = 15


class Chart:
    """Coordinates xi, shape (d,), for the orbits near one, with d parameters of a box free; xi = 0 is that orbit.

    Parameters
    ----------
    orbit : Orbit
    box : Box
        Gives parameters from d coordinates between 0 and 1.
    """

    def __init__(self, orbit: Orbit, box: Box) -> None:
        self._orbit, self._box = orbit, box
        self._closed_form = orbit.symmetric and len(orbit.word) == 2
        n = len(orbit.word) // 2 if orbit.symmetric else len(orbit.word)
        self._side = np.array(orbit.word.sides, dtype=np.int64)
        unknowns = np.array([-orbit.states[0, V2]]) if self._closed_form else orbit.t[:n] * orbit.params.Omega
        self._n = len(unknowns)
        self._centre = np.append(unknowns, box.place(orbit.params))
        self._plane = np.linalg.svd(self._linearised(self._centre)[1])[2][self._n :]
        self._known: dict[bytes, Orbit] = {}

    def _equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the n equations at y = (unknowns, coordinates in the box) and their slopes in the unknowns."""
        p = self._box.params(y[self._n :])
        if self._closed_form:
            family = family_of(p.mu, p.Omega, p.r, p.lam, self._orbit.word.p)
            V = float(y[0])
            return np.array([family.defect(V, p.A)]), np.array([[family.slope(V)]])
        defect, slope, _, _ = closing_at(values_of(p), self._orbit.word.p, self._side, y[: self._n])
        return defect, slope

    def _linearised(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the equations and their Jacobian, shape (n, n + d)."""
        defect, slope = self._equations(y)
        columns = []
        for k in range(self._n, len(y)):
            ends = []
            for step in (-_DIFFERENCE, _DIFFERENCE):
                moved = y.copy()
                moved[k] += step
                try:
                    ends.append((moved[k], self._equations(moved)[0]))
                except ParameterError:  # at the end of what the model allows: a one-sided difference
                    ends.append((y[k], defect))
            (left, before), (right, after) = ends
            columns.append((after - before) / (right - left))
        return defect, np.column_stack([slope, *columns])

    def orbit(self, xi: Floats) -> Orbit:
        """Return the orbit at coordinates xi.

        Raises
        ------
        OrbitNotFound
            If the surface does not reach there, or the model does not exist there.
        """
        key = xi.tobytes()
        if key not in self._known:
            self._known[key] = self._built(self._solved(xi))
        return self._known[key]

    def _solved(self, xi: Floats) -> Floats:
        guess = self._centre + xi @ self._plane
        y = guess.copy()
        close = False
        for _ in range(_ITERATIONS):
            try:
                defect, matrix = self._linearised(y)
                right = np.append(defect, self._plane @ (y - guess))
                matrix = np.vstack([matrix, self._plane])
                step = np.linalg.solve(matrix, right) if np.isfinite(matrix).all() else np.full(len(y), np.nan)
            except (ParameterError, np.linalg.LinAlgError):
                break
            y = y - step
            if not np.isfinite(y).all():
                break
            if close:
                return y
            close = bool(np.abs(step).max() < 1e-9)
        raise OrbitNotFound(
            f"the {self._orbit.word} orbits could not be followed from {self._orbit.params} over {np.round(xi, 9)}; "
            "take smaller steps"
        )

    def _built(self, y: Floats) -> Orbit:
        p, word = self._params(y), self._orbit.word
        if self._closed_form:
            V = float(y[0])
            if V <= 0:
                raise OrbitNotFound(f"the {word} orbits end at {p}, where the ball stands still; stay away from there")
            return assemble(word, p, *impact_states(family_of(p.mu, p.Omega, p.r, p.lam, word.p), V, p.A, p.Omega))
        _, _, t, states = closing_at(values_of(p), word.p, self._side, y[: self._n])
        if not np.all(np.diff(t, append=t[0] + self._orbit.word.p * p.period) > 0):
            raise OrbitNotFound(f"the {word} orbits end at {p}, where two impacts meet; stay away from there")
        return assemble(word, p, t, states)

    def _params(self, y: Floats) -> Params:
        return self._box.params(y[self._n :])
