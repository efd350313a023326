"""Scatter as in a real rig: restitution drawn at each impact, noise and a second harmonic of the base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.bounds import check_count, check_number
from vines.errors import ParameterError

__all__ = ["Scatter"]

_LARGEST = 1e6
"""Largest number of a scatter; all are of order one."""


@dataclass(frozen=True, slots=True)
class Scatter:
    """What varies from impact to impact and in the base, with the seed of the draws.

    Parameters
    ----------
    sigma_r : float
        Standard deviation of the restitution; each impact has r - r_speed |w'| + sigma_r g, cut to [0, 1], g normal.
    r_speed : float
        Decrease of the restitution with the relative speed before impact.
    noise : float
        Standard deviation of a random force on the oscillator, in units of A, held for a part of a period.
    hold : int
        How often in a forcing period that force is drawn.
    second : float
        Amplitude of the second harmonic of the base, in units of A.
    second_phase : float
        Its phase when that of the first is 0 [rad].
    seed : int
        Seed; trajectory k draws from the stream (seed, k), whatever runs beside it.

    Raises
    ------
    ParameterError
        If a number is not finite, a standard deviation negative, or `hold` or `seed` out of range.

    Examples
    --------
    >>> Scatter(sigma_r=0.02, seed=7).seed
    7
    """

    sigma_r: float = 0.0
    r_speed: float = 0.0
    noise: float = 0.0
    hold: int = 32
    second: float = 0.0
    second_phase: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("sigma_r", "r_speed", "noise", "second", "second_phase"):
            least = 0.0 if name in ("sigma_r", "noise", "second") else -_LARGEST
            check_number(name, getattr(self, name), least=least, most=_LARGEST, error=ParameterError)
        check_count("hold", self.hold, most=4096, error=ParameterError)
        check_count("seed", self.seed, least=0, most=2**53 - 1, error=ParameterError)

    def numbers(self) -> npt.NDArray[np.float64]:
        """Return the fields as an array, for the kernel."""
        return np.array(
            [self.sigma_r, self.r_speed, self.noise, self.hold, self.second, self.second_phase, self.seed], dtype=float
        )
