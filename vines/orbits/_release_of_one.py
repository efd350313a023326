"""The release of the one ball of a system beside the VI-NES: where a coil, friction or a spring acts on it, too.

A ball that rides on a wall is let go where the push of the frame comes to a value of the system, `Room.let_go`. There
both accelerations are one, a, before and after it, so that phase and v1 say all, as for the VI-NES (docs/sticking.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.drag import DragConstants
from vines.dynamics.friction import FrictionConstants
from vines.dynamics.kernels import constants, room_of
from vines.dynamics.kernels import rows as col
from vines.dynamics.taylor import TaylorConstants
from vines.orbits._release_of_balls import Release, force_slope

__all__ = ["LetGo", "rides_alone"]

Floats = npt.NDArray[np.float64]


def rides_alone(p: Any) -> bool:
    """Say whether a system has one ball, on which more than the walls acts."""
    return isinstance(constants(p), DragConstants | FrictionConstants | TaylorConstants)


@dataclass(frozen=True, slots=True)
class LetGo(Release):
    """The ball is let go; coordinates are phase and v1."""

    riders: tuple[int, ...] = (0,)
    balls: int = 1

    @property
    def mirrored(self) -> LetGo:
        """The mirror image."""
        return LetGo(-self.side)

    def pace(self, p: Any) -> float:
        """Return x1'' at the release."""
        return room_of(p).let_go(p, self.side) / (1.0 + p.mu) - getattr(p, "G", 0.0)

    def falling(self, p: Any, phase: float, v1: float) -> float:
        """Return the derivative by time of the push at a release."""
        return force_slope(p, phase) - p.lam * self.pace(p) - v1

    def begin(self, p: Any, z: Floats) -> Floats | None:
        """Return the state of a run just after it, None where there can be none: the contact force has to fall."""
        phase, v1 = float(z[0]), float(z[1])
        if not self.side * self.falling(p, phase, v1) < 0.0:
            return None
        room = room_of(p)
        x1 = float(room.push(p, 0.0, v1, phase)) - room.let_go(p, self.side)
        state = np.zeros(room.layout(p).state)
        room.begin(constants(p), state, x1, v1, x1 - self.side, v1, phase, 0.0)
        state[col.S_WALL], state[col.S_RELEASED], state[col.S_DECIDE] = self.side, 1.0, 0.0
        return state

    def disturbances(self, p: Any, z: Floats) -> Floats:
        """Return the disturbances, at the time of the release, by its time and velocity, shape (4, 2)."""
        # A release later by dt, with the same velocity, was before on its own motion.
        later = [force_slope(p, float(z[0])) - float(z[1]), -self.pace(p)]
        faster = [-p.lam, 1.0]
        return np.array([later * 2, faster * 2]).T

    def arrivals(self, p: Any, end: Floats, Y: Floats) -> Floats:
        """Return time and velocity of the disturbed release by disturbances at the time of the other one."""
        late = (p.lam * Y[1] + Y[0]) / self.falling(p, float(end[0]), float(end[1]))
        return np.stack([late, Y[1] + self.pace(p) * late])

    def among(self, rows: Floats) -> Sequence[tuple[int, Release]]:
        """Return the rows of releases, each with its section."""
        found = np.flatnonzero(rows[:, col.KIND] == col.RELEASE).tolist()
        return [(i, LetGo(int(rows[i, col.SIDE]))) for i in found]
