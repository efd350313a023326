"""How the amplitude of the base goes over a record: steady, a ramp, or dwells at several levels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Bins
from vines.rig.uncertainty import robust_deviation

__all__ = ["Dwell", "Envelope", "dwells", "envelope"]

Floats = npt.NDArray[np.float64]

_STEP = 0.01
"""Least relative change of the amplitude from one dwell to the next."""
_SHORTEST = 12
"""Forcing periods of a dwell at least."""
_PERIODS = 2
"""Periods that each value of the envelope is a mean over."""


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """Amplitude and phase of a channel's fundamental, once a period.

    Attributes
    ----------
    t : ndarray, shape (n,)
        [s]
    size : ndarray of complex, shape (n,)
        c_1 with Re[c_1 exp(i omega t)].
    period : float
        [s]
    """

    t: Floats
    size: npt.NDArray[np.complex128]
    period: float


@dataclass(frozen=True, slots=True)
class Dwell:
    """A stretch of a record with one amplitude of the base.

    Attributes
    ----------
    begin, end : float
        [s] on the clock of the run.
    size : float
        Amplitude, in the unit of the envelope.
    """

    begin: float
    end: float
    size: float


def envelope(bins: Bins, f: float) -> Envelope:
    """Return the envelope of a channel at a frequency [Hz].

    Parameters
    ----------
    bins : Bins
        Of the channel; stretches that are lost are bridged by straight lines.
    f : float
        Of the forcing.
    """
    even = np.arange(bins.t[0], bins.t[-1] + 0.5 * bins.width, bins.width)
    y = np.interp(even, bins.t, bins.mean)
    size = max(round(_PERIODS / (f * bins.width)), 4)
    hop = max(round(1 / (f * bins.width)), 1)
    window = np.hanning(size + 1)[:-1]
    turned = (y - y.mean()) * np.exp(-2j * np.pi * f * even)
    begin = np.arange(0, len(y) - size + 1, hop)
    summed = np.array([window @ turned[k : k + size] for k in begin]) * (2 / window.sum())
    return Envelope(even[begin] + 0.5 * size * bins.width, summed, 1 / f)


def dwells(shape: Envelope) -> tuple[Dwell, ...]:
    """Return the stretches of one amplitude, in order; a steady record is one, a ramp none.

    Parameters
    ----------
    shape : Envelope
        Of the base.

    Notes
    -----
    A value belongs to a dwell if the amplitude stays within half a per cent, or four deviations of its noise, over
    twelve periods about it. Neighbouring ones that differ by less than a per cent are one.
    """
    size = np.abs(shape.size)
    if len(size) < _SHORTEST:
        return ()
    usual = float(np.median(size))
    noise = robust_deviation(np.diff(size)) / np.sqrt(2)
    within = max(0.5 * _STEP * usual, 4 * noise)
    parts: list[tuple[int, int]] = []
    start = 0
    for k in range(1, len(size) + 1):
        # A dwell lasts as long as what comes is near the median of what it has.
        if k == len(size) or abs(size[k] - np.median(size[start:k][-4 * _SHORTEST :])) > within:
            if k - start >= _SHORTEST and np.ptp(_thirds(size[start:k])) < 2 * within:
                parts.append((start, k))
            start = k
    joined: list[tuple[int, int]] = []
    for a, b in parts:
        before = joined[-1] if joined else None
        if before and abs(np.median(size[before[0] : before[1]]) - np.median(size[a:b])) < _STEP * usual:
            joined[-1] = (before[0], b)
        else:
            joined.append((a, b))
    half = 0.5 * _PERIODS * shape.period
    return tuple(
        Dwell(float(shape.t[a] - half), float(shape.t[b - 1] + half), float(np.median(size[a:b]))) for a, b in joined
    )


def _thirds(values: Floats) -> Floats:
    return np.array([float(np.median(part)) for part in np.array_split(values, 3)])
