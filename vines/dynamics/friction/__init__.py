"""One oscillator with a ball that slides with Coulomb friction; docs/dynamics.md, "A ball that slides"."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import _advance as col
from vines.dynamics._room import Room
from vines.dynamics._trajectory import Table, Trajectory
from vines.dynamics.friction import _advance as _advance
from vines.dynamics.friction import _bodies as _bodies
from vines.dynamics.friction._constants import FrictionConstants, FrictionTable, friction_constants

__all__ = ["ROOM", "FrictionConstants", "FrictionRun"]


class FrictionRun(Trajectory):
    """One run of a ball that slides; see `Trajectory`. Events of kind 5 are stops, of 6 turns and new slides."""

    @cached_property
    def sticks(self) -> Table:
        """Spells of sticking on a wall."""
        found = super().sticks
        if self.params.f > 0:
            # Between two impacts of a chatter is the row of a turn.
            found["impacts"] = (found["impacts"] + 1) // 2
        return found

    @cached_property
    def rests(self) -> Table:
        """Spells in which the ball does not slide: on a wall, and with side 0 in mid-cavity, in their order."""
        kinds = self.rows[:, col.KIND]
        begins = np.flatnonzero(kinds == col.STOP)
        # A ball that stopped lets go before it can stop again.
        ends = np.append(np.flatnonzero((kinds == col.SLIDE) & (self.rows[:, col.RUN] == 1.0)), len(kinds))
        after = ends[np.searchsorted(ends, begins)]
        out = np.zeros(len(begins), dtype=self.sticks.dtype)
        out["t_start"], out["phase_start"] = self.rows[begins, col.TIME], self.rows[begins, col.PHASE]
        out["t_release"] = out["phase_release"] = np.nan
        ended = after < len(kinds)
        out["t_release"][ended] = self.rows[after[ended], col.TIME]
        out["phase_release"][ended] = self.rows[after[ended], col.PHASE]
        every = np.concatenate([self.sticks, out])
        return every[np.argsort(every["t_start"], kind="stable")]

    def _instants(self) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        kinds = self.rows[:, col.KIND]
        events = np.flatnonzero((kinds != col.START) & (kinds != col.END))
        return events, events

    def _hops(self, speed: npt.NDArray[np.float64], push: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        p = self.params
        lasts = np.zeros_like(speed)
        good = push > (1 + p.mu) * p.f
        out, back, speed = push[good] + (1 + p.mu) * p.f, push[good] - (1 + p.mu) * p.f, speed[good]
        # A hop brakes faster than it comes back, and each is shorter by the same ratio.
        lasts[good] = speed * (1 / out + 1 / np.sqrt(out * back)) / (1 - p.r * np.sqrt(back / out))
        return lasts


class _Friction(Room):
    trajectory = FrictionRun
    unstruck = "0:0"

    def constants(self, values: Sequence[float]) -> FrictionConstants:
        return friction_constants(*values)

    def table(self, points: list[list[float]]) -> FrictionTable:
        return FrictionTable(self.constants(points[0]))

    def begin(self, c: Any, state: npt.NDArray[np.float64], x1: float, v1: float, x2: Any, v2: Any,
              phase: float, t: float) -> None:  # fmt: skip
        super().begin(c, state, x1, v1, x2, v2, phase, t)
        if v1 == v2:
            state[col.S_DECIDE] = 1.0

    def push(self, p: Any, x1: Any, v1: Any, phase: Any) -> Any:
        return super().push(p, x1, v1, phase) + p.G

    def let_go(self, p: Any, side: int) -> float:
        return -side * (1 + p.mu) * p.f

    def conserves(self, p: Any) -> bool:
        return p.f == 0.0 and super().conserves(p)

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        frame, ball, spring = super().stored(p, at)
        return frame, ball, spring + p.mu * p.G * at["x2"]


ROOM = _Friction()
