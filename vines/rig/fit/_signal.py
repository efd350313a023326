"""What a signal of the oscillator consists of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.fit._bins import Bins

__all__ = ["Forced", "Signal", "Terms"]

Floats = npt.NDArray[np.float64]

Forced = tuple[npt.NDArray[np.complex128], Floats]
"""The last harmonics of the forced response and their standard uncertainties [m]."""

Terms = tuple[Floats, Floats]
"""Further signals, one a row, and the standard uncertainties of their sizes about 0."""


@dataclass(frozen=True, slots=True, eq=False)
class Signal:
    """Displacement or acceleration of the oscillator: forced response, free oscillation, jumps, further terms.

    Attributes
    ----------
    bins : Bins
        Of the channel.
    s : complex
        -lam omega0/2 + i gamma [1/s].
    omega : float
        Angular frequency of the forcing [rad/s].
    order : {0, 2}
        Derivative of x1 that the channel measures.
    forced : tuple of ndarray, optional
        The last harmonics of the forced response as the base's ask for them [m], and their standard uncertainties: a
        train of equal jumps and a few free harmonics are nearly the same motion.
    extra : tuple of ndarray, optional
        Further signals that may be in the channel, one a row, at the times of `bins`, and the standard uncertainties of
        their sizes about 0.
    harmonics : int
        Harmonics of the forced response.
    guard : float
        Blocks nearer to an impact are left out [s]: contact takes time.
    """

    bins: Bins
    s: complex
    omega: float
    order: int = 0
    forced: Forced | None = None
    extra: Terms | None = None
    harmonics: int = 5
    guard: float = 2.5e-4
