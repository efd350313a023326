"""A run with a ball and a mass beside it: its samples, and the measures of each of the two."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._measures import of_the_frame
from vines.dynamics._room import room_of
from vines.dynamics._trajectory import Table
from vines.dynamics.hybrid._energies import BALL_SQUARE, MASS_SQUARE
from vines.dynamics.hybrid._layout import R_V3, R_X3
from vines.dynamics.taylor import TaylorMeasures, TaylorRun
from vines.dynamics.taylor.kernels import VISCOUS_LOSS

__all__ = ["HybridMeasures", "HybridRun", "hybrid_measures"]


@dataclass(frozen=True, slots=True)
class HybridMeasures(TaylorMeasures):
    """Measures of a window with a ball and a mass on a spring; `kinetic_2` and `kinetic_ratio` are of both together.

    Attributes
    ----------
    kinetic_ratio_ball, kinetic_ratio_mass : float
        mu <v2²>/<v1²> and mu_n <v3²>/<v1²>; nan if the oscillator did not move.
    """

    kinetic_ratio_ball: float = math.nan
    kinetic_ratio_mass: float = math.nan


def hybrid_measures(p: Any, totals: npt.NDArray[np.float64]) -> HybridMeasures:
    """Return the measures of a window from the totals that `window_totals` gives."""
    t = totals.tolist()
    duration, v1_square = t[entry.DURATION], t[entry.V1_SQUARE]
    per = 1.0 / v1_square if v1_square > 0 else math.nan
    return HybridMeasures(
        kinetic_2=0.5 * t[entry.V2_SQUARE] / duration if duration > 0 else math.nan,
        kinetic_ratio=t[entry.V2_SQUARE] * per,
        viscous_loss=t[VISCOUS_LOSS],
        kinetic_ratio_ball=p.mu * t[BALL_SQUARE] * per,
        kinetic_ratio_mass=p.mu_n * t[MASS_SQUARE] * per,
        **of_the_frame(p, t),
    )


class HybridRun(TaylorRun):
    """One run with a ball and a mass on a spring; see `Trajectory`.

    Samples have x3, v3 of the mass, u = x1 - x3, u_dot, its kinetic energy `kinetic_3`, the part `spring` =
    mu_n (k1 u²/2 + k3 u⁴/4) of the potential energy, and `viscous_loss`, the part of the damper loss since the start of
    the run that the damper beside the spring took.
    """

    def _push(self, rows: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        x1, v1, phase = rows[:, [col.X1, col.V1, col.PHASE]].T
        return room_of(self.params).pushed(self.params, x1, v1, phase, rows[:, [R_X3, R_V3]].T)

    def _fill(
        self,
        t: npt.NDArray[np.float64],
        segment: npt.NDArray[np.int64],
        tau: npt.NDArray[np.float64],
        before: npt.NDArray[np.bool_],
    ) -> Table:
        found = super()._fill(t, segment, tau, before)
        out = np.empty(len(found), dtype=[*found.dtype.descr, ("u", "f8"), ("u_dot", "f8"), ("kinetic_3", "f8")])
        for name in found.dtype.names or ():
            out[name] = found[name]
        out["u"], out["u_dot"] = out["x1"] - out["x3"], out["v1"] - out["v3"]
        out["kinetic_3"] = 0.5 * self.params.mu_n * out["v3"] ** 2
        return out
