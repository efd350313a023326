"""Bifurcations as zero sets in two parameters: closing equations with the defining equation appended."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import constants
from vines.kernels import entry_njit, linked_njit, new_vector
from vines.model import PARAMETER_NAMES, V2, Params
from vines.orbits._assemble import assemble
from vines.orbits._closed_form import family_of, impact_states
from vines.orbits._defining import FLIP, FOLD, GRAZE, STOP, TORUS, condition_kernel, gap_kernel, turnings_kernel
from vines.orbits._family import closing_at
from vines.orbits._orbit import Orbit
from vines.orbits._values import values_of

__all__ = ["CurveProblem"]

Floats = npt.NDArray[np.float64]

_STEP = 1e-6
"""Step of the differences, relative to unknowns of size one: they steer Newton's method and do not move its goal."""

_CODES = {
    "fold": FOLD,
    "symmetry_breaking": FLIP,
    "period_doubling": FLIP,
    "neimark_sacker": TORUS,
    "grazing": GRAZE,
}


@linked_njit
def _append(out, n, kind, values, p, side, t, states, half, place, wall, tau):
    """Write the defining equation behind the n closing equations."""
    first, second = condition_kernel(kind, values, p, side, t, states, half, place, wall, tau)
    out[n] = first
    if kind == GRAZE:
        out[n + 1] = second


@entry_njit
def _general(kind, values, first, second, p, side, n, half, place, wall, y):
    """Return the closing equations in n phases with the defining equation appended, shape (y.size - 1,)."""
    values = values.copy()
    values[first], values[second] = y[-2], y[-1]
    defect, _, t, states = closing_at(values, p, side, y[:n])
    out = new_vector(y.size - 1)
    out[:n] = defect
    _append(out, n, kind, values, p, side, t, states, half, place, wall, y[n])
    return out


class CurveProblem:
    """A bifurcation in two parameters: n + 1 equations in (n unknowns, two parameters), one more of each for grazing.

    The unknowns are phases of impacts, or the speed V of a symmetric 1:1/pT orbit, then for grazing the time of the
    turning point since the start of its flight, then the parameters.

    Parameters
    ----------
    kind : str
        Type of the bifurcation.
    orbit : Orbit
        The orbit there.
    parameters : tuple of str, str
    spans : tuple of float, float
        Widths of their ranges.
    """

    def __init__(self, kind: str, orbit: Orbit, parameters: tuple[str, str], spans: tuple[float, float]) -> None:
        self.word = orbit.word
        self.symmetric = orbit.symmetric
        self.spans = np.array(spans)
        self.parameter = parameters[1]
        self.names = parameters
        self.kind = kind
        self._code = _CODES[kind]
        self._fixed = orbit.params
        self._values = values_of(orbit.params)
        self._index = (PARAMETER_NAMES.index(parameters[0]), PARAMETER_NAMES.index(parameters[1]))
        self._side = np.array(orbit.word.sides, dtype=np.int64)
        self._explicit = orbit.symmetric and len(orbit.word) == 2
        self.place, self._wall = 0, 0
        if self._explicit:
            unknowns = np.array([-orbit.states[0, V2]])
        else:
            n = len(orbit.word) // 2 if orbit.symmetric else len(orbit.word)
            unknowns = orbit.t[:n] * orbit.params.Omega
        self._n = len(unknowns)
        if self._code == GRAZE:
            speeds = orbit.side * orbit.w_dot
            if orbit.min_clearance < speeds.min():
                c = constants(orbit.params)
                turnings = turnings_kernel(c, orbit.period, orbit.t, orbit.states)
                touch = turnings[np.argmin(turnings[:, 3])]
                self.place, self._wall = int(touch[0]), int(touch[2])
                unknowns = np.append(unknowns, touch[1])
            else:
                self._code, self.place = STOP, int(np.argmin(speeds))
        self.start = np.append(unknowns, self._values[list(self._index)])

    @property
    def touches(self) -> bool:
        """Whether the last unknown before the parameters is the time at which a turning point touches a wall."""
        return self._code == GRAZE

    def bend(self, y: Floats) -> float:
        """Return w'' at the turning point that touches the wall, negative where it touches L."""
        values, t, states = self._closed(y)
        return float(gap_kernel(values, t, states, self.place, y[-3])[2])

    def _params(self, y: Floats) -> Params:
        return self._fixed.replace(**dict(zip(self.names, (float(y[-2]), float(y[-1])), strict=True)))

    def _impacts(self, values: Floats, V: float) -> tuple[float, Floats, Floats]:
        mu, A, Omega, r, lam = values.tolist()
        family = family_of(mu, Omega, r, lam, self.word.p)
        return family.defect(V, A), *impact_states(family, V, A, Omega)

    def residual(self, y: Floats) -> Floats:
        """Return the equations at y, shape (y.size - 1,)."""
        if not self._explicit:
            return _general(
                self._code, self._values, *self._index, self.word.p, self._side, self._n, self.symmetric, self.place,
                self._wall, y,
            )  # fmt: skip
        values = self._values.copy()
        values[list(self._index)] = y[-2:]
        V = float(y[0])
        out = np.empty(len(y) - 1)
        out[0], t, states = self._impacts(values, V)
        if self._code == FOLD:
            mu, _, Omega, r, lam = values.tolist()
            out[1] = family_of(mu, Omega, r, lam, self.word.p).slope(V)
        else:
            _append(out, 1, self._code, values, self.word.p, self._side, t, states, True, self.place, self._wall, y[1])
        return out

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the equations at y, and their derivatives by differences."""
        matrix = np.empty((len(y) - 1, len(y)))
        for k in range(len(y)):
            step = np.zeros(len(y))
            step[k] = _STEP * (max(abs(y[k]), 0.01) if k >= len(y) - 2 else 1.0)
            matrix[:, k] = (self.residual(y + step) - self.residual(y - step)) / (2 * step[k])
        return self.residual(y), matrix

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        _, t, states = self._closed(y)
        return assemble(self.word, self._params(y), t, states)

    def _closed(self, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Return parameter values, impact times and states of a solution."""
        values = self._values.copy()
        values[list(self._index)] = y[-2:]
        if self._explicit:
            return values, *self._impacts(values, float(y[0]))[1:]
        return values, *closing_at(values, self.word.p, self._side, y[: self._n])[2:]
