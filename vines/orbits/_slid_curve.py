"""Bifurcations of orbits with stops and turns as zero sets in two parameters (docs/orbits.md, "Orbits that stop")."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from vines.orbits._chain_curve import second_compound
from vines.orbits._curve_equations import CurveEquations, refuse_ends
from vines.orbits._moved import moved
from vines.orbits._orbit import Orbit
from vines.orbits._problem import Point
from vines.orbits._slid import first_impact, slid_again
from vines.orbits._slid_round import SlidRound
from vines.orbits._sticking_ends import what_vanishes

__all__ = ["SlidCurve"]

Floats = npt.NDArray[np.float64]

_MOVES = 4.0
"""By how many of its last moves farther a curve may end where a margin runs out: the last ones are short."""


class SlidCurve(CurveEquations):
    """A bifurcation of orbits of a ball that slides; the unknowns are x1, v1, v2 and the phase of the first impact.

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
        refuse_ends(kind, orbit, parameters, " with friction")
        self._fixed = orbit.params
        self._contacts = len(self.word) // 2 if self.symmetric else len(self.word)
        self.start = np.array([*first_impact(orbit), *(orbit.params.as_dict()[name] for name in parameters)])

    def residual(self, y: Floats) -> Floats:
        """Return the equations at y, shape (5,), nan where other contacts come."""
        p = moved(self._fixed, dict(zip(self.names, y[-2:], strict=True)))
        way = None if p is None else SlidRound(self.word, p, y[:4].copy(), self._contacts)
        if way is None or not way.places:
            return np.full(5, np.nan)
        return np.append(way.closing(self.symmetric), self._condition(way.tangent))

    def _condition(self, tangent: Floats) -> float:
        """Return det(I - M), det(I + M) or det(I - M∧M), over a power of the size of M."""
        M = -tangent if self.symmetric else tangent
        size = 1.0 + float(np.linalg.norm(M))
        if self.kind == "neimark_sacker":
            return float(np.linalg.det(np.eye(6) - second_compound(M))) / size**2
        return float(np.linalg.det(np.eye(4) + (-M if self.kind == "fold" else M))) / size

    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution.

        Raises
        ------
        OrbitNotFound
            If other contacts come.
        """
        p = moved(self._fixed, dict(zip(self.names, y[-2:], strict=True)))
        return slid_again(self.word, p, y[:4])

    def runs_out(self, points: Sequence[Point]) -> str | None:
        """Return what the orbits of the curve need that runs out just behind its last point, None if nothing does."""
        found = what_vanishes(points[-2], points[-1], _MOVES) if len(points) > 1 else None
        return None if found is None else found[0]

    def bend(self, y: Floats) -> float:
        """Return nan: nothing touches."""
        return np.nan

    def turnings(self, orbit: Orbit) -> Floats:
        """Return no turning points: nothing touches."""
        return np.empty((0, 6))
