"""What bifurcations in two parameters of any system have in common: closing equations with one more appended."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound
from vines.model import Word
from vines.orbits._closing import difference, stays_symmetric
from vines.orbits._orbit import Orbit
from vines.orbits._problem import Point

__all__ = ["TOUCHING", "CurveEquations", "refuse_ends"]

Floats = npt.NDArray[np.float64]

_OF_MULTIPLIERS = ("fold", "period_doubling", "symmetry_breaking", "neimark_sacker")
"""Types of bifurcations at which a multiplier says what happens, and no contact."""

TOUCHING = 1e-5
"""Time between the turning point that touches and one that the survey finds, below which they are one."""


def refuse_ends(kind: str, orbit: Orbit, parameters: tuple[str, str], which: str) -> None:
    """Refuse to follow the end of a family of orbits of which contacts are found by running them.

    Raises
    ------
    OrbitNotFound
        If it is one; `which` says what these orbits are.
    """
    if kind not in _OF_MULTIPLIERS:
        raise OrbitNotFound(
            f"of {orbit.word}{which}, curves of the types {', '.join(_OF_MULTIPLIERS)} are followed, not of {kind}: "
            f"locate it on branches, one for each value of {parameters[1]}"
        )


class CurveEquations(ABC):
    """A bifurcation in two parameters: n + 1 equations in (n unknowns, two parameters), one more of each for grazing.

    The unknowns are those of the family, then for grazing the time of the turning point since the start of its flight,
    then the parameters.

    Parameters
    ----------
    kind : str
        Type of the bifurcation.
    orbit : Orbit
        The orbit there.
    parameters : tuple of str, str
    spans : tuple of float, float
        Widths of their ranges.

    Attributes
    ----------
    symmetric : bool
        Whether the orbits of the curve are kept their own mirror images.
    touches : bool
        Whether the last unknown before the parameters is the time at which a turning point touches a wall.
    place : int
        The flight of that turning point, or the impact that has no speed.
    ball : int
        The ball that turns there, 0 where balls have no numbers.
    start : (m,) float array
        The unknowns and parameters at the bifurcation.
    step : float
        Of the differences, relative to unknowns of size one: they steer Newton's method and do not move its goal.
    """

    start: Floats
    step: float = 1e-6

    def __init__(self, kind: str, orbit: Orbit, parameters: tuple[str, str], spans: tuple[float, float]) -> None:
        self.word: Word = orbit.word
        self.symmetric = stays_symmetric(orbit, *parameters)
        self.spans = np.array(spans)
        self.parameter = parameters[1]
        self.names = parameters
        self.kind = kind
        self.touches = False
        self.place = self.ball = 0

    @abstractmethod
    def residual(self, y: Floats) -> Floats:
        """Return the equations at y, shape (m - 1,), nan where the system does not exist."""

    @abstractmethod
    def orbit(self, y: Floats) -> Orbit:
        """Return the orbit of a solution."""

    @abstractmethod
    def bend(self, y: Floats) -> float:
        """Return w'' at the turning point that touches the wall, negative where it touches L."""

    @abstractmethod
    def turnings(self, orbit: Orbit) -> Floats:
        """Return all turning points of an orbit, rows of flight, time since its start, wall, clearance, w'', ball."""

    def touching(self, orbit: Orbit) -> Floats:
        """Return the row of the turning point with the least clearance, and that it is the one which touches."""
        rows = self.turnings(orbit)
        touch = rows[np.argmin(rows[:, 3])]
        self.touches, self.place, self.ball = True, int(touch[0]), int(touch[5])
        return touch

    def elsewhere(self, orbit: Orbit, y: Floats) -> float:
        """Return the least clearance of a turning point other than the one that touches."""
        rows = self.turnings(orbit)
        # The mirror image of a symmetric orbit touches the other wall at the same time of its own flight.
        around = len(orbit.word) // (2 if self.symmetric else 1)
        mine = (rows[:, 0] % around == self.place % around) & (np.abs(rows[:, 1] - y[-3]) < TOUCHING)
        mine &= rows[:, 5] == self.ball
        return float(rows[~mine, 3].min(initial=2.0))

    def runs_out(self, points: Sequence[Point]) -> str | None:
        """Return what the orbits of the curve need that runs out just behind its last point, None if nothing does."""
        del points
        return None

    def equations(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the equations at y, and their derivatives by differences."""
        matrix = np.empty((len(y) - 1, len(y)))
        here = self.residual(y)
        if not np.isfinite(here).all():
            return here, np.full_like(matrix, np.nan)
        for k in range(len(y)):
            step = self.step * (max(abs(y[k]), 0.01) if k >= len(y) - 2 else 1.0)
            matrix[:, k] = difference(self.residual, y, k, step)
        return here, matrix
