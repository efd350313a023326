"""Damped sines of which a signal consists between impacts, whatever began them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Bins

__all__ = ["resonances"]

Floats = npt.NDArray[np.float64]

_LONGEST = 0.04
"""[s] Window, at most; it is 1.5 cycles of the slowest mode that is looked for."""
_SHARE = 0.7
"""Of a usual flight that a window takes."""
_LEAST = 24
"""Samples of a window."""
_BESIDE = 1e-3
"""[s] So near to an impact nothing is read."""
_SPARE = 8
"""Windows that a flight must hold."""
_ABOVE = 1.3
"""By how much a direction stands out of the noise, in amplitude."""
_MOST = 24
"""Directions, at most."""


def resonances(bins: Bins, times: Floats) -> npt.NDArray[np.complex128]:
    """Return the exponents of the damped sines between impacts, strongest directions first taken, slowest first.

    Parameters
    ----------
    bins : Bins
        Of the signal.
    times : ndarray, shape (n,)
        Impacts [s].

    Returns
    -------
    ndarray of complex
        With positive imaginary part [1/s]; empty where flights are too short. The motion itself, harmonics and hum are
        among them.

    Notes
    -----
    ESPRIT (Roy and Kailath, IEEE Trans. ASSP 37, 984, 1989) over the windows of all flights together: what follows
    from the samples of a window a sample later is one matrix for all, whose eigenvalues are exp(s width). Amplitudes
    and phases may be new in each flight, so that impacts need not be known but for their times.

    Examples
    --------
    >>> t = np.arange(3200) / 3200
    >>> hits = np.arange(0.02, 1.0, 0.06)
    >>> rung = sum(np.where(t > hit, np.exp(238 * (-0.01 + 1j) * (t - hit)), 0) for hit in hits)
    >>> signal = rung.real + 9 * np.cos(55 * t) + 1e-3 * np.random.default_rng(1).normal(size=len(t))
    >>> found = resonances(Bins(t, signal, 1 / 3200), hits)
    >>> bool(np.abs(found - 238 * (-0.01 + 1j)).min() < 0.3)
    True
    """
    nothing = np.zeros(0, complex)
    if len(times) < 2:
        return nothing
    size = round(min(_LONGEST, _SHARE * float(np.median(np.diff(times)))) / bins.width)
    if size < _LEAST:
        return nothing
    square, count = np.zeros((size, size)), 0
    edges = np.searchsorted(bins.t, np.stack([times[:-1] + _BESIDE, times[1:] - _BESIDE]))
    for begin, end in edges.T:
        whole = end - begin >= size + _SPARE and bins.t[end - 1] - bins.t[begin] < (end - begin - 0.5) * bins.width
        if whole:
            windows = np.lib.stride_tricks.sliding_window_view(bins.mean[begin:end], size)
            square += windows.T @ windows
            count += len(windows)
    if count < 2 * size:
        return nothing
    power, directions = np.linalg.eigh(square / count)
    sizes = np.sqrt(np.maximum(power[::-1], 0.0))
    order = min(int(np.count_nonzero(sizes > _ABOVE * float(np.median(sizes[size // 2 :])))), _MOST, size // 2)
    if order < 1:
        return nothing
    span = directions[:, ::-1][:, :order]
    roots = np.linalg.eigvals(np.linalg.lstsq(span[:-1], span[1:], rcond=None)[0]).astype(complex)
    s = np.log(roots[np.abs(roots) > 1e-9]) / bins.width
    above: npt.NDArray[np.complex128] = s[s.imag > 0].astype(np.complex128)
    return above[np.argsort(above.imag)]
