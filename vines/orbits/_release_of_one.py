"""The release of the one ball of a system beside the VI-NES: where more acts on it, or on the frame, or moves beside.

A ball that rides on a wall is let go where the push of the frame comes to a value of the system, `Room.let_go`. There
both accelerations are one, a, before and after it, so that phase, v1 and what moves beside say all (docs/sticking.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.drag import DragConstants
from vines.dynamics.friction import FrictionConstants
from vines.dynamics.hybrid import HybridConstants
from vines.dynamics.kernels import Slopes, constants, room_of
from vines.dynamics.kernels import rows as col
from vines.dynamics.modes import ModesConstants
from vines.dynamics.taylor import TaylorConstants
from vines.orbits._release_of_balls import Release

__all__ = ["LetGo", "release_on", "rides_alone"]

Floats = npt.NDArray[np.float64]

_NEWTON = 100
"""Steps at most to the x1 of a release, which for a cubic spring come nearer from one side."""


def rides_alone(p: Any) -> bool:
    """Say whether a system has one ball, and is not the VI-NES."""
    kinds = DragConstants | FrictionConstants | TaylorConstants | HybridConstants | ModesConstants
    return isinstance(constants(p), kinds)


def release_on(p: Any, side: int) -> LetGo:
    """Return the release of a system from a wall."""
    return LetGo(side, alongside=room_of(p).alongside(p))


@dataclass(frozen=True, slots=True)
class LetGo(Release):
    """The ball is let go; coordinates are phase, v1, and of what moves beside those of its rows.

    Attributes
    ----------
    alongside : tuple of float
        Of each of these 1 if the difference to x1 is taken, so that x1 follows from the others, else 0.
    """

    riders: tuple[int, ...] = (0,)
    balls: int = 1
    alongside: tuple[float, ...] = ()

    @property
    def mirrored(self) -> LetGo:
        """The mirror image."""
        return LetGo(-self.side, alongside=self.alongside)

    def read(self, row: Floats) -> Floats:
        """Return the coordinates at the row of a release."""
        beside = self.beside(row) - np.array(self.alongside) * row[col.X1]
        return np.array([row[col.PHASE], row[col.A_V1], *beside])

    def beside(self, row: Floats) -> Floats:
        """Return what a row has of what moves beside."""
        return row[len(row) - len(self.alongside) :]

    def place(self, p: Any, z: Floats) -> tuple[float, Floats]:
        """Return x1 at the release and what moves beside, where the push comes to its value."""
        room, limit, moved = room_of(p), room_of(p).let_go(p, self.side), np.array(self.alongside)
        phase, v1 = float(z[0]), float(z[1])
        x1, step = 0.0, math.inf
        for _ in range(_NEWTON):
            beside = z[2:] + moved * x1
            slope = self._steepness(room.slopes(p, x1, v1, phase, beside))
            new = (limit - float(room.pushed(p, x1, v1, phase, beside))) / slope
            if not abs(new) < abs(step) or new == 0.0:
                break
            x1, step = x1 + new, new
        return x1, z[2:] + moved * x1

    def _steepness(self, slopes: Slopes) -> float:
        """Return the derivative of the push by x1 with the other coordinates fixed."""
        return float(slopes.by_state[0] + slopes.by_state[2:] @ np.array(self.alongside))

    def pace(self, p: Any) -> float:
        """Return x1'' at the release."""
        return room_of(p).let_go(p, self.side) / (1.0 + p.mu) - getattr(p, "G", 0.0)

    def rate(self, p: Any, v1: float, slopes: Slopes) -> float:
        """Return the derivative by time of the push at a release."""
        moves = slopes.by_state[0] * v1 + slopes.by_state[1] * self.pace(p)
        return float(slopes.by_time + moves + slopes.by_state[2:] @ slopes.rates)

    def falling(self, p: Any, z: Floats) -> float:
        """Return the same at its coordinates."""
        return self.rate(p, float(z[1]), self._slopes(p, z))

    def _slopes(self, p: Any, z: Floats) -> Slopes:
        x1, beside = self.place(p, z)
        return room_of(p).slopes(p, x1, float(z[1]), float(z[0]), beside)

    def still(self, p: Any, phase: float) -> float:
        """Return about which velocity the push does not change at a release."""
        z = np.array([phase, *[0.0] * (1 + len(self.alongside))])
        slopes = self._slopes(p, z)
        return self.rate(p, 0.0, slopes) / -float(slopes.by_state[0])

    def begin(self, p: Any, z: Floats) -> Floats | None:
        """Return the state of a run just after it, None where there can be none: the contact force has to fall."""
        phase, v1 = float(z[0]), float(z[1])
        room, (x1, beside) = room_of(p), self.place(p, z)
        if not self.side * self.rate(p, v1, room.slopes(p, x1, v1, phase, beside)) < 0.0:
            return None
        state = np.zeros(room.layout(p).state)
        x2, v2 = np.array([x1 - self.side, *beside[0::2]]), np.array([v1, *beside[1::2]])
        several = room.layout(p).width > col.ROW
        room.begin(constants(p), state, x1, v1, x2 if several else x2[0], v2 if several else v1, phase, 0.0)
        state[col.S_WALL], state[col.S_RELEASED], state[col.S_DECIDE] = self.side, 1.0, 0.0
        return state

    def disturbances(self, p: Any, z: Floats) -> Floats:
        """Return the disturbances, at the time of the release, by its time and coordinates, shape (4 + n, 2 + n)."""
        slopes, moved = self._slopes(p, z), np.array(self.alongside)
        # x1 follows from the other coordinates.
        moves = -np.array([slopes.by_time, *slopes.by_state[1:]]) / self._steepness(slopes)
        columns = np.zeros((4 + len(moved), 2 + len(moved)))
        columns[0] = columns[2] = moves
        columns[4:] = np.outer(moved, moves)
        columns[1, 1] = columns[3, 1] = 1.0
        columns[4:, 2:] += np.eye(len(moved))
        # A release later by dt, with the same coordinates, was before on its own motion.
        pace = self.pace(p)
        columns[:, 0] -= np.array([float(z[1]), pace, float(z[1]), pace, *slopes.rates])
        return columns

    def arrivals(self, p: Any, end: Floats, Y: Floats) -> Floats:
        """Return time and coordinates of the disturbed release by disturbances at the time of the other one."""
        slopes, moved, v1 = self._slopes(p, end), np.array(self.alongside), float(end[1])
        change = slopes.by_state[:2] @ Y[:2] + slopes.by_state[2:] @ Y[4:]
        late = -change / self.rate(p, v1, slopes)
        beside = Y[4:] + np.outer(slopes.rates, late) - np.outer(moved, Y[0] + v1 * late)
        return np.vstack([late, Y[1] + self.pace(p) * late, beside])

    def among(self, rows: Floats) -> Sequence[tuple[int, Release]]:
        """Return the rows of releases, each with its section."""
        found = np.flatnonzero(rows[:, col.KIND] == col.RELEASE).tolist()
        return [(i, LetGo(int(rows[i, col.SIDE]), alongside=self.alongside)) for i in found]
