"""A run on a cubic spring: its samples, and measures with the damper of the spring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._measures import Measures, of_the_frame
from vines.dynamics._room import constants, room_of
from vines.dynamics._trajectory import SAMPLE, Table, Trajectory
from vines.dynamics.taylor._energies import VISCOUS_LOSS
from vines.dynamics.taylor._samples import OF_ONE_BALL, sample_flights

__all__ = ["SeriesRun", "TaylorMeasures", "TaylorRun", "spring_energy", "taylor_measures"]


@dataclass(frozen=True, slots=True)
class TaylorMeasures(Measures):
    """Measures of a window with a spring beside the barriers; `damper_loss` is that of both dampers.

    Attributes
    ----------
    viscous_loss : float
        What of it the damper of the spring took.
    """

    viscous_loss: float = 0.0


def taylor_measures(p: Any, totals: npt.NDArray[np.float64]) -> TaylorMeasures:
    """Return the measures of a window from the totals that `window_totals` gives."""
    t = totals.tolist()
    duration, v1_square, v2_square = t[entry.DURATION], t[entry.V1_SQUARE], p.mu * t[entry.V2_SQUARE]
    return TaylorMeasures(
        kinetic_2=0.5 * v2_square / duration if duration > 0 else math.nan,
        kinetic_ratio=v2_square / v1_square if v1_square > 0 else math.nan,
        viscous_loss=t[VISCOUS_LOSS],
        **of_the_frame(p, t),
    )


TAYLOR_SAMPLE = np.dtype([*SAMPLE.descr, ("spring", "f8"), ("viscous_loss", "f8")])


def spring_energy(p: Any, mass: float, w: Any) -> Any:
    """Return the energy of the spring of a mass at a gap."""
    return mass * w**2 * (0.5 * p.k1 + 0.25 * p.k3 * w**2)


class SeriesRun(Trajectory):
    """One run by series; see `Trajectory`."""

    sample_dtype: ClassVar[np.dtype[np.void]] = SAMPLE
    """What a sample has, beside what rows have at their ends."""

    def _fill(
        self,
        t: npt.NDArray[np.float64],
        segment: npt.NDArray[np.int64],
        tau: npt.NDArray[np.float64],
        before: npt.NDArray[np.bool_],
    ) -> Table:
        p, room = self.params, room_of(self.params)
        raw = np.empty((len(t), OF_ONE_BALL + len(room.beside)))
        sums = np.zeros(room.layout(p).totals)
        sample_flights(constants(p), self.rows, segment, tau, before, sums, raw)
        out = np.empty(len(t), dtype=[*self.sample_dtype.descr, *((name, "f8") for name in room.beside)])
        out["t"] = t
        names = ("x1", "v1", "x2", "v2", "phase", "stuck", "base_work", "damper_loss", "impact_loss", "viscous_loss")
        for k, name in enumerate((*names, *room.beside)):
            if name in (out.dtype.names or ()):
                out[name] = raw[:, k]
        out["w"] = out["x1"] - out["x2"]
        out["w_dot"] = out["v1"] - out["v2"]
        out["base"] = room.base(p, out["phase"])
        out["kinetic_1"], out["kinetic_2"], out["potential"] = room.stored(p, out)
        return out


class TaylorRun(SeriesRun):
    """One run on a cubic spring; see `Trajectory`.

    Samples have `spring`, the part mu (k1 w²/2 + k3 w⁴/4) of the potential energy, and `viscous_loss`, the part of the
    damper loss since the start of the run that the damper beside it took.
    """

    sample_dtype = TAYLOR_SAMPLE

    def _push(self, rows: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return (1 + mu) times how a wall that the mass were to ride on would press, towards L."""
        p = self.params
        push = room_of(p).push(p, rows[:, col.X1], rows[:, col.V1], rows[:, col.PHASE])
        # The spring pushes too, which `Room.push` of one wall alone could not say.
        return push - rows[:, col.SIDE] * (1 + p.mu) * (p.k1 + p.k3)

    def _fill(
        self,
        t: npt.NDArray[np.float64],
        segment: npt.NDArray[np.int64],
        tau: npt.NDArray[np.float64],
        before: npt.NDArray[np.bool_],
    ) -> Table:
        out = super()._fill(t, segment, tau, before)
        out["spring"] = room_of(self.params).spring(self.params, out)
        return out
