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
from vines.dynamics._measures import Measures
from vines.dynamics._room import constants
from vines.dynamics._trajectory import Table, Trajectory
from vines.dynamics.parallel import _energies as own
from vines.dynamics.parallel._layout import BALL
from vines.dynamics.parallel._rows import sample_balls
from vines.errors import StateError

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
        duration=duration,
        period=p.period,
        kinetic_1=0.5 * v1_square * per,
        kinetic_2=sum(each.kinetic for each in balls),
        kinetic_ratio=sum(each.kinetic_ratio for each in balls),
        max_abs_x1=t[entry.MAX_ABS_X1],
        t_max_abs_x1=t[entry.T_MAX_ABS_X1],
        rms_x1=max(t[entry.X1_SQUARE] * per, 0.0) ** 0.5,
        base_work=t[entry.BASE_WORK],
        damper_loss=t[entry.DAMPER_LOSS],
        impact_loss_left=t[entry.LOSS_LEFT],
        impact_loss_right=t[entry.LOSS_RIGHT],
        energy_change=t[entry.ENERGY_CHANGE],
        impacts_left=int(t[entry.IMPACTS_LEFT]),
        impacts_right=int(t[entry.IMPACTS_RIGHT]),
        sticks_left=int(t[entry.STICKS_LEFT]),
        sticks_right=int(t[entry.STICKS_RIGHT]),
        balls=balls,
        ties=int(t[own.S_TIES]),
    )


STICK = np.dtype([("ball", "i8"), ("side", "i1"), ("t_start", "f8"), ("t_release", "f8"), ("impacts", "i8")])


class ParallelRun(Trajectory):
    """One run with several balls; see `Trajectory`. Impacts have the number of the ball, and how many hit with it."""

    @cached_property
    def sticks(self) -> Table:
        """Spells of sticking: ball, side, times of merge and release (nan if it rides still), impacts before."""
        found: list[tuple[int, int, float, float, int]] = []
        open_at: dict[int, int] = {}
        for row in self.rows[np.isin(self.rows[:, col.KIND], (col.STICK, col.IMPACT, col.RELEASE))]:
            ball = int(row[BALL])
            if row[col.KIND] == col.STICK:
                open_at[ball] = len(found)
                found.append((ball, int(row[col.SIDE]), float(row[col.TIME]), math.nan, int(row[col.RUN])))
            elif ball in open_at:
                at = open_at.pop(ball)
                found[at] = (*found[at][:3], float(row[col.TIME]), found[at][4])
        return np.array(found, dtype=STICK)

    def sample(
        self,
        n: int | None = None,
        *,
        times: npt.ArrayLike | None = None,
        per_period: int | None = None,
        at_events: bool = False,
    ) -> Table:
        """Return the state at chosen times, from the closed forms.

        Parameters
        ----------
        n, times, per_period
            As for `Trajectory.sample`.
        at_events : bool
            Has to be False: an instant may have many events here.

        Returns
        -------
        structured ndarray
            t, x1, v1, phase [rad], and of each ball k x2_k, v2_k, w_k = x1 - x2_k, stuck_k (the wall; 0 in flight).

        Raises
        ------
        StateError
            If times lie outside the run, more than one of n, times, per_period is given, or events are asked for.
        """
        if at_events:
            raise StateError("samples at events are not made of several balls; see `impacts` and `sticks`")
        chosen = self._times(n, times, per_period)
        begins = self.rows[:, col.TIME]
        segment = np.clip(np.searchsorted(begins, chosen, side="right") - 1, 0, len(begins) - 1)
        balls = self.params.balls
        raw = np.empty((len(chosen), 4 + 2 * balls))
        sample_balls(constants(self.params), self.rows, segment, np.maximum(chosen - begins[segment], 0.0), raw)
        own = [(f"{name}_{k}", form) for k in range(1, balls + 1) for name, form in _OF_A_BALL]
        out = np.empty(len(chosen), dtype=[(name, "f8") for name in ("t", "x1", "v1", "phase")] + own)
        out["t"], out["x1"], out["v1"], out["phase"] = chosen, *raw[:, :3].T
        for k in range(balls):
            out[f"x2_{k + 1}"], out[f"v2_{k + 1}"] = raw[:, 4 + 2 * k], raw[:, 5 + 2 * k]
            out[f"w_{k + 1}"] = raw[:, 0] - raw[:, 4 + 2 * k]
            rides = np.abs(raw[:, 3]).astype(np.int64) >> k & 1
            out[f"stuck_{k + 1}"] = rides * np.sign(raw[:, 3]).astype(np.int64)
        return out


_OF_A_BALL = (("x2", "f8"), ("v2", "f8"), ("w", "f8"), ("stuck", "i1"))
