"""Closed motions, each a round of flights: what the impacts of periodic orbits and attractors say by themselves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.stages.audit._flights import Flights, Sums
from vines.stages.audit._rows import Floats

__all__ = ["Cycles"]


@dataclass(frozen=True)
class Cycles:
    """Closed motions of one impact or more.

    Attributes
    ----------
    flights : Flights
        Their flights, those of one motion after the other; the last one of a motion leads back to its first impact.
    lengths : (n,) int array
        Number of impacts of each motion, > 0.
    """

    flights: Flights
    lengths: npt.NDArray[np.int64]

    @cached_property
    def first(self) -> npt.NDArray[np.int64]:
        """Place of the first impact of each motion."""
        return np.cumsum(self.lengths) - self.lengths

    @cached_property
    def following(self) -> npt.NDArray[np.int64]:
        """Place of the impact after each one."""
        places = np.arange(1, len(self.flights) + 1)
        places[self.first + self.lengths - 1] = self.first
        return places

    @cached_property
    def sums(self) -> Sums:
        """Integrals over each motion, and its extremes."""
        each = self.flights.sums()
        return Sums(
            v1_square=self.add(each.v1_square),
            v2_square=self.add(each.v2_square),
            x1_square=self.add(each.x1_square),
            base_work=self.add(each.base_work),
            damper_loss=self.add(each.damper_loss),
            largest_x1=self.most(each.largest_x1),
            largest_gap=self.most(each.largest_gap),
        )

    def add(self, values: Any) -> Floats:
        """Return the sum of values of impacts over each motion."""
        return np.add.reduceat(values, self.first)

    def most(self, values: Any) -> Floats:
        """Return the largest of the values of impacts of each motion."""
        return np.maximum.reduceat(values, self.first)

    @cached_property
    def closure(self) -> Floats:
        """Largest difference of where a flight lands to the next impact that is stored, for each motion."""
        f = self.flights
        stored = (f.x1, f.v1, f.x2, f.v2)
        return self.most(
            np.max([np.abs(at - one[self.following]) for at, one in zip(f.land(), stored, strict=True)], axis=0)
        )

    def losses(self, side: Floats) -> tuple[Floats, Floats]:
        """Return the energies lost in the impacts on the left and on the right end, mu (1 - r²) w'²/(2 (1 + mu))."""
        f = self.flights
        lost = 0.5 * f.mu * (1 - f.r**2) * (f.v1 - f.v2) ** 2 / (1 + f.mu)
        return self.add(np.where(side > 0, lost, 0.0)), self.add(np.where(side < 0, lost, 0.0))
