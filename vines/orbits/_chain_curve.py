"""Bifurcations of any system as zero sets in two parameters."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.orbits._assemble import assemble
from vines.orbits._closing import Closed
from vines.orbits._curve_equations import CurveEquations
from vines.orbits._floquet import FIXED_TIME, half_map, monodromy
from vines.orbits._orbit import Orbit
from vines.orbits._shooting import closing_of
from vines.orbits._survey import survey_kernel
from vines.orbits._turnings_of_balls import gap_kernel, turnings_kernel

__all__ = ["ChainCurve", "second_compound"]

Floats = npt.NDArray[np.float64]


class ChainCurve(CurveEquations):
    """A bifurcation of any system; the unknowns are phases of impacts.

    M is the tangent map over the period, that of the half map for symmetric orbits (docs/orbits.md, "Curves").

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
        self._closing = closing_of(orbit, parameters, self.symmetric)
        self._n = len(self._closing.start) - 2
        self._wall = 0
        self.start = self._closing.start
        if kind == "grazing":
            speeds = orbit.side * orbit.w_dot
            if orbit.word.unstruck or orbit.min_clearance < speeds.min():
                touch = self.touching(orbit)
                self._wall = int(touch[2])
                self.start = np.insert(self.start, self._n, touch[1])
            else:
                self.place = int(np.argmin(speeds))

    def turnings(self, orbit: Orbit) -> Floats:
        """Return all turning points of an orbit, rows of flight, time since its start, wall, clearance, w'', ball."""
        return turnings_kernel(constants(orbit.params), orbit.period, self._closing.side, orbit.t, orbit.states)

    def bend(self, y: Floats) -> float:
        """Return w'' at the turning point that touches the wall, negative where it touches L."""
        return self._gap(self._closed(y), float(y[-3]))[2]

    def residual(self, y: Floats) -> Floats:
        """Return the equations at y, shape (y.size - 1,), nan where the system does not exist."""
        out = np.full(len(y) - 1, np.nan)
        closed = self._closing.at(y[: self._n], y[-2:])
        if closed is None or not np.isfinite(closed.defect).all():
            return out
        out[: self._n] = closed.defect
        if self.touches:
            w, out[-1], _ = self._gap(closed, float(y[-3]))
            out[-2] = w - self._wall
        elif self.kind == "grazing":
            out[-1] = closed.states[self.place, 1] - closed.states[self.place, 3]
        else:
            out[-1] = self._condition(closed)
        return out

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        closed = self._closed(y)
        return assemble(self.word, closed.params, closed.t, closed.states)

    def _closed(self, y: Floats) -> Closed:
        closed = self._closing.at(y[: self._n], y[-2:])
        assert closed is not None
        return closed

    def _gap(self, closed: Closed, tau: float) -> tuple[float, float, float]:
        return gap_kernel(
            closed.constants, closed.duration, self._closing.side, closed.t, closed.states, self.place, self.ball, tau
        )

    def _condition(self, closed: Closed) -> float:
        """Return det(I - M), det(I + M) or det(I - M∧M), over a power of the size of M."""
        M = self._growth(closed)
        if not np.isfinite(M).all():
            return np.nan
        size = 1.0 + float(np.linalg.norm(M))
        if self.kind == "neimark_sacker":
            return float(np.linalg.det(np.eye(len(M) * (len(M) - 1) // 2) - second_compound(M))) / size**2
        return float(np.linalg.det(np.eye(len(M)) + (-M if self.kind == "fold" else M))) / size

    def _growth(self, closed: Closed) -> Floats:
        """Return M."""
        side = self._closing.side
        jacobians = survey_kernel(closed.constants, closed.duration, side, closed.t, closed.states)[0]
        return half_map(jacobians, FIXED_TIME) if self.symmetric else monodromy(jacobians)


def second_compound(M: Floats) -> Floats:
    """Return the matrix whose eigenvalues are the products of pairs of those of M.

    Examples
    --------
    >>> second_compound(np.diag([2.0, 3.0, 5.0])).diagonal()
    array([ 6., 10., 15.])
    """
    i, j = np.array(list(combinations(range(len(M)), 2))).T
    return M[np.ix_(i, i)] * M[np.ix_(j, j)] - M[np.ix_(i, j)] * M[np.ix_(j, i)]
