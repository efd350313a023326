"""What all fits of a run share, and how an acceleration alone is fitted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig._bins import Bins
from vines.rig._jumps import JumpFit, fit_jumps
from vines.rig._slide import Push

__all__ = ["KEEP", "LEAST", "Fitter"]

Floats = npt.NDArray[np.float64]

KEEP = 5.0

LEAST = 2e-4
"""No smaller jump is believed [m/s]."""

_U_AREA = 0.03
"""Relative standard uncertainty of a jump by the area of its pulse: for what ringing adds."""

_U_SIDEWAYS = 3e-3
"""Sway across the axis, relative to the motion: a tenth of it, seen by a cross-axis sensitivity of some per cent."""


@dataclass(frozen=True, slots=True, eq=False)
class Fitter:
    """What all fits of a run share."""

    bins: Bins
    s: complex
    omega: float
    order: int
    forced: tuple[npt.NDArray[np.complex128], Floats] | None

    def fit(
        self,
        times: Floats,
        u: Floats,
        dv: Floats,
        draws: int = 8,
        pushed: Push | None = None,
        extra: tuple[Floats, Floats] | None = None,
    ) -> JumpFit:
        def once(expected: tuple[Floats, Floats] | None, more: tuple[Floats, Floats] | None, draws: int) -> JumpFit:
            return fit_jumps(
                self.bins, self.s, self.omega, times, u, dv, order=self.order, draws=draws, forced=self.forced,
                pushed=pushed, extra=more, expected=expected,
            )  # fmt: skip

        if self.order == 0:
            return once(None, extra, draws)
        # Alone, an acceleration hardly tells a train of equal jumps from a forced response; the areas of the pulses do.
        spread = _U_AREA * np.abs(dv) + LEAST / 2
        first = once((dv, spread), None, 0)
        knocks = np.abs(first.jumps.dv - dv) > KEEP * spread
        sideways = (self.omega * first.motion.at(self.bins.t, 1)[None, :], np.array([_U_SIDEWAYS]))
        return once((dv, np.where(knocks, np.abs(dv), spread)), sideways, draws)
