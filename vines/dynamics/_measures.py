"""Energy measures of a window of time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import _totals as entry
from vines.dynamics._room import room_of

__all__ = ["Measures", "measures_from"]


@dataclass(frozen=True, slots=True)
class Measures:
    """Measures of a window of time, dimensionless; energies in units of M b² omega0², all from closed forms.

    Attributes
    ----------
    duration : float
        Length of the window.
    period : float
        Forcing period T.
    kinetic_1, kinetic_2 : float
        Time averages of v1²/2 and mu v2²/2.
    kinetic_ratio : float
        K2/K1 = mu <v2²>/<v1²> (paper, eq. (11)); nan if the oscillator did not move.
    max_abs_x1, t_max_abs_x1 : float
        Largest displacement of the oscillator and the time at which it is reached, found by a certified search.
    rms_x1 : float
        Root of the time average of x1².
    base_work : float
        Work of the shaken base on the system (totals of the window from here on).
    damper_loss : float
        Energy lost in the damper.
    impact_loss_left, impact_loss_right : float
        Energy lost in impacts and merges, by wall.
    energy_change : float
        Energy of mass, ball and spring at the end less that at the start.
    impacts_left, impacts_right : int
        Impacts by wall; of a complete chatter those that were followed one by one.
    sticks_left, sticks_right : int
        Spells of sticking that began in the window, by wall.
    travel_loss : float
        Energy lost on the ball's way through the cavity, to a coil or by friction; 0 of a ball that flies freely.
    """

    duration: float
    period: float
    kinetic_1: float
    kinetic_2: float
    kinetic_ratio: float
    max_abs_x1: float
    t_max_abs_x1: float
    rms_x1: float
    base_work: float
    damper_loss: float
    impact_loss_left: float
    impact_loss_right: float
    energy_change: float
    impacts_left: int
    impacts_right: int
    sticks_left: int
    sticks_right: int
    travel_loss: float = 0.0

    @property
    def periods(self) -> float:
        """Length of the window in forcing periods."""
        return self.duration / self.period

    def _each_period(self, total: float) -> float:
        return total / self.periods if self.duration > 0 else math.nan

    @property
    def impact_loss(self) -> float:
        """Energy lost in impacts and merges on both walls."""
        return self.impact_loss_left + self.impact_loss_right

    @property
    def balance(self) -> float:
        """Base work less losses less change of energy: zero up to rounding."""
        return self.base_work - self.damper_loss - self.impact_loss - self.travel_loss - self.energy_change

    @property
    def impacts_per_period(self) -> float:
        """Impacts on both walls per forcing period."""
        return self._each_period(self.impacts_left + self.impacts_right)

    @property
    def sticks_per_period(self) -> float:
        """Spells of sticking per forcing period."""
        return self._each_period(self.sticks_left + self.sticks_right)

    @property
    def base_work_per_period(self) -> float:
        """Base work per forcing period."""
        return self._each_period(self.base_work)

    @property
    def damper_loss_per_period(self) -> float:
        """Energy lost in the damper per forcing period."""
        return self._each_period(self.damper_loss)

    @property
    def impact_loss_per_period(self) -> float:
        """Energy lost in impacts and merges per forcing period."""
        return self._each_period(self.impact_loss)


def measures_from(p: Any, totals: npt.NDArray[np.float64]) -> Measures:
    """Return the measures of a window from the totals that `window_totals` gives."""
    room = room_of(p)
    if room.measures is not None:
        return room.measures(p, totals)
    t = totals.tolist()
    mass = room.mass(p)
    duration = t[entry.DURATION]
    v1_square, v2_square = t[entry.V1_SQUARE], t[entry.V2_SQUARE]
    per = 1.0 / duration if duration > 0 else math.nan
    return Measures(
        kinetic_2=0.5 * mass * v2_square * per,
        kinetic_ratio=mass * v2_square / v1_square if v1_square > 0 else math.nan,
        **of_the_frame(p, t),
    )


def of_the_frame(p: Any, t: list[float]) -> dict[str, Any]:
    """Return all measures but the kinetic energy of what flies from totals as a list: they are those of any balls."""
    duration = t[entry.DURATION]
    per = 1.0 / duration if duration > 0 else math.nan
    return {
        "duration": duration,
        "period": p.period,
        "kinetic_1": 0.5 * t[entry.V1_SQUARE] * per,
        "max_abs_x1": t[entry.MAX_ABS_X1],
        "t_max_abs_x1": t[entry.T_MAX_ABS_X1],
        "rms_x1": max(t[entry.X1_SQUARE] * per, 0.0) ** 0.5,
        "base_work": t[entry.BASE_WORK],
        "damper_loss": t[entry.DAMPER_LOSS],
        "impact_loss_left": t[entry.LOSS_LEFT],
        "impact_loss_right": t[entry.LOSS_RIGHT],
        "energy_change": t[entry.ENERGY_CHANGE],
        "impacts_left": int(t[entry.IMPACTS_LEFT]),
        "impacts_right": int(t[entry.IMPACTS_RIGHT]),
        "sticks_left": int(t[entry.STICKS_LEFT]),
        "sticks_right": int(t[entry.STICKS_RIGHT]),
        "travel_loss": t[entry.TRAVEL_LOSS],
    }
