"""Velocity jumps of the oscillator: its state at the impacts, and what a fit says of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.fit._motion import Motion

__all__ = ["JumpFit", "Jumps"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Jumps:
    """State of the oscillator at K impacts; arrays of shape (K,), or (draws, K).

    Attributes
    ----------
    t : ndarray
        Times [s].
    x, v_before, v_after : ndarray
        Position and velocities of the oscillator [m, m/s].
    """

    t: Floats
    x: Floats
    v_before: Floats
    v_after: Floats

    @classmethod
    def stacked(cls, several: Sequence[Jumps]) -> Jumps:
        """Return several sets as one, with an axis for the sets in front."""
        return cls(*(np.array([getattr(one, name) for one in several]) for name in ("t", "x", "v_before", "v_after")))

    @property
    def dv(self) -> Floats:
        """Velocity jumps [m/s]."""
        return self.v_after - self.v_before

    def less(self, other: Jumps, step: float) -> Jumps:
        """Return the difference from another set over a step."""
        return Jumps(
            (self.t - other.t) / step,
            (self.x - other.x) / step,
            (self.v_before - other.v_before) / step,
            (self.v_after - other.v_after) / step,
        )

    def moved(self, slopes: Jumps, by: tuple[float, ...]) -> Jumps:
        """Return the jumps after steps along derivatives, of shape (n, K) for n steps."""
        return Jumps(
            self.t + np.tensordot(by, slopes.t, 1),
            self.x + np.tensordot(by, slopes.x, 1),
            self.v_before + np.tensordot(by, slopes.v_before, 1),
            self.v_after + np.tensordot(by, slopes.v_after, 1),
        )


@dataclass(frozen=True, slots=True, eq=False)
class JumpFit:
    """Solution of the least squares.

    Attributes
    ----------
    motion : Motion
        x1 in closed form.
    jumps : Jumps
        At the refined times.
    draws : Jumps
        The same, drawn from the distribution that noise of the signal leaves for them; shape (draws, K).
    first : ndarray of complex, shape (draws,)
        Draws of the first harmonic of the forced response [m].
    swap : Jumps
        Derivative of the jumps by a relative change of that harmonic, real and imaginary, shape (2, K): a train of
        jumps and a forced response are so much alike that what a sensor adds may swap one for the other.
    shift : ndarray, shape (K,)
        Refined less given time [s], where the given time's own uncertainty allows it.
    u_dv : ndarray, shape (K,)
        Standard uncertainty of the jumps [m/s].
    residual, noise : float
        Root mean square of what is left of the block means on trusted flights, and that of a block mean by neighbouring
        differences, in the unit of the signal.
    clumped : float
        By how much the variance of longer means exceeds that of independent residuals.
    fair : ndarray of bool, shape (K + 1,)
        Flights that were used; the motion on the others is not that of one flight: an impact in them is missing.
    left : ndarray, shape (n,)
        What is left, at `left_t` [s].
    extra : ndarray
        Sizes of the further signals.
    offset : float
        Constant part of the signal.
    """

    motion: Motion
    jumps: Jumps
    draws: Jumps
    first: npt.NDArray[np.complex128]
    swap: Jumps
    shift: Floats
    u_dv: Floats
    residual: float
    noise: float
    clumped: float
    fair: npt.NDArray[np.bool_]
    left: Floats
    left_t: Floats
    extra: Floats
    offset: float
