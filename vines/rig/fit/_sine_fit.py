"""Frequency, amplitude and phase of a measured harmonic motion, with uncertainties."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.fit._bins import Bins, sinhc

__all__ = ["SineFit", "sine_fit"]

_ROUNDS = 30


@dataclass(frozen=True, slots=True, eq=False)
class SineFit:
    """A sine with harmonics: sum of Re[c_n exp(i n omega t)] and an offset.

    Attributes
    ----------
    f, u_f : float
        Frequency and its standard uncertainty [Hz].
    harmonics : ndarray of complex, shape (N,)
        c_1 … c_N, in the unit of the signal, phase at t = 0 of the run's clock.
    u_amplitude, u_phase : float
        Standard uncertainty (Type A) of |c_1| and of its phase [rad] in the middle of the record.
    middle : float
        Middle of the record [s], where frequency and phase are uncorrelated.
    residual : float
        Root mean square of what is left of the block means.
    """

    f: float
    u_f: float
    harmonics: npt.NDArray[np.complex128]
    u_amplitude: float
    u_phase: float
    middle: float
    residual: float

    @property
    def omega(self) -> float:
        """Angular frequency [rad/s]."""
        return 2 * np.pi * self.f


def sine_fit(bins: Bins, *, harmonics: int = 3, near: float | None = None) -> SineFit:
    """Fit frequency, offset and harmonics by least squares (four-parameter fit of IEEE 1057, with harmonics).

    Parameters
    ----------
    bins : Bins
        Of the channel.
    harmonics : int
        Harmonics fitted, the fundamental included.
    near : float, optional
        Frequency [Hz] from which to start; that of the largest line of the spectrum, if left out.

    Returns
    -------
    SineFit

    Raises
    ------
    RigError
        If the record is shorter than two periods or the iteration does not come to rest.

    Notes
    -----
    Uncertainties are those of least squares with the residual's variance, widened where neighbouring residuals are
    alike (hum, drift): the variance is taken from sums over 32 neighbours too, and the larger one counts.

    Examples
    --------
    >>> t = (np.arange(6400) + 0.5) / 3200
    >>> fit = sine_fit(Bins(t, 2.0 * np.sin(2 * np.pi * 8.8 * t + 0.3), 1 / 3200.0), harmonics=1)
    >>> round(fit.f, 6), round(float(np.angle(fit.harmonics[0]) + np.pi / 2), 4)
    (8.8, 0.3)
    """
    t, y = bins.t, bins.mean
    middle = float(0.5 * (t[0] + t[-1]))
    tau = t - middle
    omega = 2 * np.pi * (near if near is not None else _largest_line(bins))
    if omega * (t[-1] - t[0]) < 4 * np.pi:
        raise RigError(f"the record lasts {t[-1] - t[0]:.3g} s, less than two periods of {omega / (2 * np.pi):.4g} Hz")
    order = np.arange(1, harmonics + 1)
    change = np.inf
    c: Any = np.zeros(harmonics, dtype=np.complex128)
    linear: Any = np.zeros(2 * harmonics + 1)
    columns: Any = np.empty((2 * harmonics + 2, len(t)))
    normal: Any = np.eye(2 * harmonics + 2)
    for _ in range(_ROUNDS):
        turn: Any = np.exp(1j * omega * tau)
        powers: list[Any] = [turn]
        for _n in range(harmonics - 1):
            powers.append(powers[-1] * turn)
        smear = np.array([sinhc(0.5j * n * omega * bins.width).real for n in order])
        columns = np.empty((2 * harmonics + 2, len(t)))
        for k, (power, factor) in enumerate(zip(powers, smear, strict=True)):
            columns[2 * k], columns[2 * k + 1] = factor * power.real, -factor * power.imag
        columns[-2] = 1.0
        columns[-1] = 0.0
        normal = columns[:-1] @ columns[:-1].T
        linear = np.linalg.solve(normal, columns[:-1] @ y)
        c = linear[0:-1:2] + 1j * linear[1:-1:2]
        for n, power, factor, value in zip(order, powers, smear, c, strict=True):
            columns[-1] += factor * (1j * n * value * power).real
        columns[-1] *= tau
        normal = columns @ columns.T
        left = y - linear @ columns[:-1]
        change = float(np.linalg.solve(normal, columns @ left)[-1])
        omega += change
        if abs(change) < 1e-12 * omega:
            break
    else:
        if not abs(change) < 1e-9 * omega:
            raise RigError(f"no steady sine near {omega / (2 * np.pi):.4g} Hz: the fit does not come to rest")
    left = y - linear @ columns[:-1]
    residual = float(np.sqrt(np.mean(left**2)))
    variance = residual**2 * clumping(left)
    covariance = np.linalg.inv(normal) * variance
    size = abs(c[0])
    along = np.array([c[0].real, c[0].imag]) / size
    across = np.array([-c[0].imag, c[0].real]) / size
    first = covariance[:2, :2]
    return SineFit(
        omega / (2 * np.pi),
        float(np.sqrt(covariance[-1, -1])) / (2 * np.pi),
        c * np.exp(-1j * order * omega * middle),
        float(np.sqrt(along @ first @ along)),
        float(np.sqrt(across @ first @ across) / size),
        middle,
        residual,
    )


def clumping(left: npt.NDArray[np.float64], size: int = 32) -> float:
    """Return by how much the variance of a mean of residuals exceeds that of independent ones, at least 1.

    Examples
    --------
    >>> clumping(np.random.default_rng(1).normal(size=4096)) < 1.3
    True
    >>> clumping(np.repeat(np.random.default_rng(1).normal(size=128), 32)) > 25
    True
    """
    n = len(left) // size
    if n < 8:
        return 1.0
    parts = left[: n * size].reshape(n, size).mean(axis=1)
    return max(1.0, float(size * np.var(parts) / np.var(left))) if np.var(left) > 0 else 1.0


def _largest_line(bins: Bins) -> float:
    """Return the frequency of the largest line of the spectrum, refined by a parabola through its neighbours [Hz]."""
    even = np.arange(bins.t[0], bins.t[-1], bins.width)
    y = np.interp(even, bins.t, bins.mean)
    spectrum = np.abs(np.fft.rfft((y - y.mean()) * np.hanning(len(y))))
    k = int(np.argmax(spectrum[1:-1])) + 1
    low, top, high = np.log(np.maximum(spectrum[k - 1 : k + 2], 1e-300))
    bend = low - 2 * top + high
    shift = 0.5 * (low - high) / bend if bend < 0 else 0.0
    return float((k + shift) / (len(y) * bins.width))
