"""Bifurcations of orbits of balls in parallel that stick, as zero sets in two parameters."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.orbits._chain_curve import second_compound
from vines.orbits._curve_equations import CurveEquations, refuse_ends
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._release_of_balls import Ran, run_closed
from vines.orbits._sticking_of_balls import Begun, balls_orbit

__all__ = ["BallsCurve"]

Floats = npt.NDArray[np.float64]


class BallsCurve(CurveEquations):
    """A bifurcation of orbits of balls in parallel that stick; the unknowns are the coordinates of a section.

    Parameters
    ----------
    kind : str
        Type of the bifurcation.
    orbit : Orbit
        The orbit there.
    parameters : tuple of str, str
    spans : tuple of float, float
        Widths of their ranges.

    Raises
    ------
    OrbitNotFound
        If it is an end of the family, whose curve is not followed.
    """

    def __init__(self, kind: str, orbit: Orbit, parameters: tuple[str, str], spans: tuple[float, float]) -> None:
        super().__init__(kind, orbit, parameters, spans)
        refuse_ends(kind, orbit, parameters, ", which sticks")
        self._fixed = orbit.params
        self._section, z = orbit.release
        self.start = np.array([*z, *(orbit.params.as_dict()[name] for name in parameters)])

    def residual(self, y: Floats) -> Floats:
        """Return the equations at y, shape (y.size - 1,), nan where no such round exists."""
        out = np.full(len(y) - 1, np.nan)
        p = moved(self._fixed, dict(zip(self.names, y[-2:], strict=True)))
        if p is None:
            return out
        z = y[:-2].copy()
        span = self.word.p * p.period / (2 if self.symmetric else 1)
        met = run_closed(p, self._section, span, z, mirrored=self.symmetric)
        if met is not None:
            ran, (out[:-1], _) = met
            out[-1] = self._condition(ran, z)
        return out

    def _condition(self, ran: Ran, z: Floats) -> float:
        """Return det(I - M), det(I + M) or det(I - M∧M), over a power of the size of M."""
        M = self._section.mirror(z) @ ran.slopes if self.symmetric else ran.slopes
        size = 1.0 + float(np.linalg.norm(M))
        if self.kind == "neimark_sacker":
            return float(np.linalg.det(np.eye(len(M) * (len(M) - 1) // 2) - second_compound(M))) / size**2
        return float(np.linalg.det(np.eye(len(M)) + (-M if self.kind == "fold" else M))) / size

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""
        p = moved(self._fixed, dict(zip(self.names, y[-2:], strict=True)))
        return balls_orbit(self.word, p, Begun(self._section, y[:-2].copy()))

    def bend(self, y: Floats) -> float:
        """Return nan: nothing touches."""
        return np.nan

    def turnings(self, orbit: Orbit) -> Floats:
        """Return no turning points: nothing touches."""
        return np.empty((0, 6))
