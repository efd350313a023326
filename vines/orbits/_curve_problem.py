"""Bifurcations of the VI-NES as zero sets in two parameters: closing equations with the defining equation appended."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.kernels import entry_njit, linked_njit, new_vector
from vines.model import AMPLITUDE, FREQUENCY, PARAMETER_NAMES, V2, VI_NES, Params
from vines.orbits._assemble import assemble
from vines.orbits._closed_form import SymmetricFamily, family_where, impact_states
from vines.orbits._curve_equations import CurveEquations
from vines.orbits._defining import FLIP, FOLD, GRAZE, STOP, TORUS, condition_kernel, gap_kernel, turnings_kernel
from vines.orbits._family import closing_at
from vines.orbits._orbit import Orbit
from vines.orbits._values import values_of

__all__ = ["CurveProblem"]

Floats = npt.NDArray[np.float64]

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


class CurveProblem(CurveEquations):
    """A bifurcation of the VI-NES; the unknowns are phases of impacts, or the speed V of a symmetric 1:1/pT orbit.

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
        super().__init__(kind, orbit, parameters, spans)
        self._code = _CODES[kind]
        self._fixed = orbit.params
        self._values = values_of(orbit.params)
        self._index = (PARAMETER_NAMES.index(parameters[0]), PARAMETER_NAMES.index(parameters[1]))
        self._side = np.array(orbit.word.sides, dtype=np.int64)
        self._explicit = orbit.symmetric and len(orbit.word) == 2
        self._wall = 0
        if self._explicit:
            unknowns = np.array([-orbit.states[0, V2]])
        else:
            n = len(orbit.word) // 2 if orbit.symmetric else len(orbit.word)
            unknowns = orbit.t[:n] * orbit.params.Omega
        self._n = len(unknowns)
        if self._code == GRAZE:
            speeds = orbit.side * orbit.w_dot
            if orbit.min_clearance < speeds.min():
                touch = self.touching(orbit)
                self._wall = int(touch[2])
                unknowns = np.append(unknowns, touch[1])
            else:
                self._code, self.place = STOP, int(np.argmin(speeds))
        self.start = np.append(unknowns, self._values[list(self._index)])

    def turnings(self, orbit: Orbit) -> Floats:
        """Return all turning points of an orbit, rows of flight, time since its start, wall, clearance, w'', 0."""
        rows = turnings_kernel(constants(orbit.params), orbit.period, orbit.t, orbit.states)
        return np.column_stack([rows, np.zeros(len(rows))])

    def bend(self, y: Floats) -> float:
        """Return w'' at the turning point that touches the wall, negative where it touches L."""
        values, t, states = self._closed(y)
        return float(gap_kernel(values, t, states, self.place, y[-3])[2])

    def _params(self, y: Floats) -> Params:
        return self._fixed.replace(**dict(zip(self.names, (float(y[-2]), float(y[-1])), strict=True)))

    def residual(self, y: Floats) -> Floats:
        """Return the equations at y, shape (y.size - 1,), nan where the model does not exist."""
        if not all(VI_NES.parameter(name).allowed.holds(y[k]) for name, k in zip(self.names, (-2, -1), strict=True)):
            return np.full(len(y) - 1, np.nan)
        if not self._explicit:
            return _general(
                self._code, self._values, *self._index, self.word.p, self._side, self._n, self.symmetric, self.place,
                self._wall, y,
            )  # fmt: skip
        values, V = self._at(y), float(y[0])
        family = self._family(values)
        out = np.full(len(y) - 1, np.nan)
        # Without forcing no phase is that of an impact.
        if family is None or values[AMPLITUDE] == 0:
            return out
        out[0] = family.defect(V, float(values[AMPLITUDE]))
        if self._code == FOLD:
            out[1] = family.slope(V)
        else:
            t, states = impact_states(family, V, float(values[AMPLITUDE]), float(values[FREQUENCY]))
            _append(out, 1, self._code, values, self.word.p, self._side, t, states, True, self.place, self._wall, y[1])
        return out

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        _, t, states = self._closed(y)
        return assemble(self.word, self._params(y), t, states)

    def _at(self, y: Floats) -> Floats:
        values = self._values.copy()
        values[list(self._index)] = y[-2:]
        return values

    def _family(self, values: Floats) -> SymmetricFamily | None:
        return family_where(dict(zip(PARAMETER_NAMES, values.tolist(), strict=True)), self.word.p)

    def _closed(self, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Return parameter values, impact times and states of a solution."""
        values = self._at(y)
        if self._explicit:
            family = self._family(values)
            assert family is not None
            A, Omega = float(values[AMPLITUDE]), float(values[FREQUENCY])
            return values, *impact_states(family, float(y[0]), A, Omega)
        return values, *closing_at(values, self.word.p, self._side, y[: self._n])[2:]
