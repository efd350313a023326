"""A run with several balls: its sticking, samples, and the measures of each ball."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._measures import Measures, of_the_frame
from vines.dynamics._room import constants, room_of
from vines.dynamics._trajectory import STICK as SPELL
from vines.dynamics._trajectory import Table, Trajectory
from vines.dynamics.parallel import _energies as own
from vines.dynamics.parallel._layout import BALL
from vines.dynamics.parallel._samples import FIRST_BALL, sample_balls

__all__ = ["BallMeasures", "ParallelMeasures", "ParallelRun", "parallel_measures"]


@dataclass(frozen=True, slots=True)
class BallMeasures:
    """Measures of one ball over a window, in the units of `Measures`.

    Attributes
    ----------
    kinetic : float
        Time average of mu v2²/2.
    kinetic_ratio : float
        mu <v2²>/<v1²>; nan if the oscillator did not move.
    impact_loss_left, impact_loss_right : float
        Energy lost in its impacts and merges, by wall.
    impacts_left, impacts_right : int
        Its impacts by wall.
    """

    kinetic: float
    kinetic_ratio: float
    impact_loss_left: float
    impact_loss_right: float
    impacts_left: int
    impacts_right: int


@dataclass(frozen=True, slots=True)
class ParallelMeasures(Measures):
    """Measures of a window with several balls; what `Measures` says of the ball is summed over them.

    Attributes
    ----------
    balls : tuple of BallMeasures
    ties : int
        Impacts that came together with that of another ball.
    """

    balls: tuple[BallMeasures, ...] = ()
    ties: int = 0


def parallel_measures(p: Any, totals: npt.NDArray[np.float64]) -> ParallelMeasures:
    """Return the measures of a window from the totals that `window_totals` gives."""
    t = totals.tolist()
    duration, v1_square = t[entry.DURATION], t[entry.V1_SQUARE]
    per = 1.0 / duration if duration > 0 else math.nan

    def ball(i: int, mu: float) -> BallMeasures:
        at = own.EACH * i
        square = mu * t[own.V2_SQUARE + at]
        return BallMeasures(
            kinetic=0.5 * square * per,
            kinetic_ratio=square / v1_square if v1_square > 0 else math.nan,
            impact_loss_left=t[own.LOSS_LEFT + at],
            impact_loss_right=t[own.LOSS_RIGHT + at],
            impacts_left=int(t[own.IMPACTS_LEFT + at]),
            impacts_right=int(t[own.IMPACTS_RIGHT + at]),
        )

    balls = tuple(ball(i, mu) for i, mu in enumerate(p.mu))
    return ParallelMeasures(
        kinetic_2=sum(each.kinetic for each in balls),
        kinetic_ratio=sum(each.kinetic_ratio for each in balls),
        balls=balls,
        ties=int(t[own.S_TIES]),
        **of_the_frame(p, t),
    )


STICK = np.dtype([("ball", "i8"), *SPELL.descr])


class ParallelRun(Trajectory):
    """One run with several balls; see `Trajectory`. Impacts have the number of the ball, and how many hit with it.

    Samples have t, x1, v1, phase [rad], base (A sin phase), kinetic_1, potential (of the spring), since the start of
    the run base_work, damper_loss and impact_loss, and of each ball k x2_k, v2_k, w_k = x1 - x2_k, w_dot_k, its kinetic
    energy kinetic_2_k, potential_2_k = mu G x2 and stuck_k (the wall; 0 in flight). Those at events are just before the
    first and just after the last event of an instant.
    """

    @cached_property
    def sticks(self) -> Table:
        """Spells of sticking: ball, and as of one ball, with the time of the merge; no release while it rides still."""
        found: list[tuple[float, ...]] = []
        open_at: dict[int, int] = {}
        for row in self.rows[np.isin(self.rows[:, col.KIND], (col.STICK, col.IMPACT, col.RELEASE))]:
            ball, now, phase = int(row[BALL]), float(row[col.TIME]), float(row[col.PHASE])
            if row[col.KIND] == col.STICK:
                open_at[ball] = len(found)
                found.append((ball, int(row[col.SIDE]), now, math.nan, phase, math.nan, int(row[col.RUN])))
            elif ball in open_at:
                at = open_at.pop(ball)
                merge = found[at]
                found[at] = (*merge[:3], now, merge[4], phase, merge[6])
        return np.array(found, dtype=STICK)

    def _instants(self) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        # Between events of one instant the balls are in no state that could be told alone.
        events, _ = super()._instants()
        follows = np.append(self.rows[events[1:], col.TAU] == 0.0, False) & np.append(np.diff(events) == 1, False)
        return events[~np.append(False, follows[:-1])], events[~follows]

    def _fill(
        self,
        t: npt.NDArray[np.float64],
        segment: npt.NDArray[np.int64],
        tau: npt.NDArray[np.float64],
        before: npt.NDArray[np.bool_],
    ) -> Table:
        p = self.params
        raw = np.empty((len(t), FIRST_BALL + 2 * p.balls))
        sample_balls(constants(p), self.rows, segment, tau, before, raw)
        own = [(f"{name}_{k}", form) for k in range(1, p.balls + 1) for name, form in _OF_A_BALL]
        out = np.empty(len(t), dtype=[(name, "f8") for name in _OF_THE_FRAME] + own)
        out["t"], out["x1"], out["v1"], out["phase"] = t, *raw[:, :3].T
        out["base_work"], out["damper_loss"], out["impact_loss"] = raw[:, 4:FIRST_BALL].T
        out["base"] = room_of(p).base(p, out["phase"])
        out["kinetic_1"], out["potential"] = 0.5 * out["v1"] ** 2, 0.5 * (out["x1"] - out["base"]) ** 2
        modes = raw[:, 3].astype(np.int64)
        for k, mu in enumerate(p.mu, start=1):
            x2, v2 = raw[:, FIRST_BALL + 2 * (k - 1)], raw[:, FIRST_BALL + 1 + 2 * (k - 1)]
            out[f"x2_{k}"], out[f"v2_{k}"] = x2, v2
            out[f"w_{k}"], out[f"w_dot_{k}"] = out["x1"] - x2, out["v1"] - v2
            out[f"kinetic_2_{k}"], out[f"potential_2_{k}"] = 0.5 * mu * v2**2, mu * p.G * x2
            out[f"stuck_{k}"] = (np.abs(modes) >> (k - 1) & 1) * np.sign(modes)
        return out


_OF_THE_FRAME = (
    *("t", "x1", "v1", "phase", "base", "kinetic_1", "potential"),
    *("base_work", "damper_loss", "impact_loss"),
)
_OF_A_BALL = (
    *((name, "f8") for name in ("x2", "v2", "w", "w_dot", "kinetic_2", "potential_2")),
    ("stuck", "i1"),
)
