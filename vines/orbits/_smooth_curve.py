"""Bifurcations of orbits without impacts as zero sets in two parameters."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import constants
from vines.orbits._chain_curve import ChainCurve
from vines.orbits._closing import Closed
from vines.orbits._curve_equations import TOUCHING
from vines.orbits._orbit import Orbit
from vines.orbits._smooth_flow import gap_at, nearest_turnings

__all__ = ["SmoothCurve"]

Floats = npt.NDArray[np.float64]


class SmoothCurve(ChainCurve):
    """As `ChainCurve`; the unknowns are the state at phase 0, and M is what its closing equations bring."""

    def turnings(self, orbit: Orbit) -> Floats:
        """Return all turning points of an orbit, rows of 0, time since phase 0, wall, clearance, w'', 0."""
        rows = nearest_turnings(constants(orbit.params), orbit.states[0], orbit.period)
        nothing = np.zeros(len(rows))
        return np.column_stack([nothing, rows, nothing])

    def elsewhere(self, orbit: Orbit, y: Floats) -> float:
        """Return the least clearance of a turning point other than the one that touches."""
        rows = self.turnings(orbit)
        # The mirror image of a symmetric orbit touches the other wall half a period later.
        around = orbit.period / (2 if self.symmetric else 1)
        away = (rows[:, 1] - y[-3] + 0.5 * around) % around - 0.5 * around
        return float(rows[np.abs(away) >= TOUCHING, 3].min(initial=2.0))

    def _gap(self, closed: Closed, tau: float) -> tuple[float, float, float]:
        return gap_at(closed.constants, closed.states[0], tau)

    def _growth(self, closed: Closed) -> Floats:
        return closed.slope + np.eye(len(closed.slope))
