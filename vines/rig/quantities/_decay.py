"""A decaying sine whose frequency and damping may depend on its amplitude, by least squares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.fit import Bins, clumping, sinhc

__all__ = ["Decay", "again", "fit_decay"]

Floats = npt.NDArray[np.float64]

_ROUNDS = 60
_DEGREE = 7

_GROWS = 30.0
"""Logarithm of a growth beyond which a fit is lost."""

_BELIEVED = 5.0
"""Standard deviations at which a dependence on the amplitude is believed."""

_BENDS = 2e-5
"""Least relative change of the frequency over the decay that is taken for one."""


@dataclass(frozen=True, slots=True, eq=False)
class Decay:
    """The signal Re[z exp(s tau + g h(tau))], tau = t - t[0], h the integral of |z|^2 exp(2 Re(s) tau).

    Attributes
    ----------
    t : ndarray, shape (n,)
        Times of the samples [s].
    s, g, z : complex
        Exponent for a small amplitude [1/s], its change by the square of the amplitude, amplitude at t[0].
    u : tuple of float
        Standard uncertainties of Re s and Im s.
    turn, u_turn : float
        Im g with its standard uncertainty; what a fit gives, also where `g` is taken to be 0.
    residual, size : float
        Root mean square of what is left, and |z|.
    bent : ndarray, shape (n,)
        What the sensor and further columns add.
    """

    t: Floats
    s: complex
    g: complex
    z: complex
    u: tuple[float, float]
    turn: float
    u_turn: float
    residual: float
    size: float
    bent: Floats

    def wave(self, bins: Bins) -> npt.NDArray[np.complex128]:
        """Return exp(s tau + g h) at block means."""
        tau = bins.t - self.t[0]
        return sinhc(0.5 * self.s * bins.width) * np.exp(self.s * tau + self.g * _slowed(self.s, self.z, tau)[0])

    def part_of(self, bins: Bins, more: Floats | None = None) -> tuple[complex, float, Floats]:
        """Return the amplitude of this decay in another signal, its standard uncertainty, and what is left of that."""
        e = self.wave(bins)
        columns = np.vstack([e.real, -e.imag, _beside(bins, more)])
        normal = columns @ columns.T
        linear = np.linalg.solve(normal, columns @ bins.mean)
        left = bins.mean - linear @ columns
        u = np.sqrt(np.max(np.diag(np.linalg.inv(normal))[:2]) * np.mean(left**2) * clumping(left))
        return complex(linear[0], linear[1]), float(u), left


def _beside(bins: Bins, more: Floats | None) -> Floats:
    """Return an offset and further signals, one a row."""
    offset = np.ones((1, len(bins.t)))
    return offset if more is None else np.vstack([offset, more])


def _slowed(s: complex, z: complex, tau: Floats) -> tuple[Floats, Floats]:
    """Return h(tau) and its derivative by Re s."""
    fall = 2 * s.real
    gone = np.exp(fall * tau)
    h = abs(z) ** 2 * (gone - 1) / fall
    return h, abs(z) ** 2 * 2 * tau * gone / fall - 2 * h / fall


def fit_decay(
    bins: Bins, omega: float, *, sensor: bool = False, bends: bool = True, more: Floats | None = None
) -> Decay:
    """Fit a decay; one that depends on its amplitude where the signal says so.

    Parameters
    ----------
    bins : Bins
        The signal, about 0.
    omega : float
        Angular frequency, about [rad/s].
    sensor : bool
        Whether it may hold polynomials of degree 2 to 7 of the motion.
    bends : bool
        Whether it may depend on its amplitude.
    more : ndarray, shape (k, n), optional
        Further signals that may be in it, of any size.

    Raises
    ------
    RigError
        If the fit does not come to rest, or the motion grows.

    Examples
    --------
    >>> t = np.arange(0.0, 10.0, 1 / 3200)
    >>> phase = 55.0 * t + 60.0 * 0.01**2 / 0.66 * (1 - np.exp(-0.66 * t))
    >>> found = fit_decay(Bins(t, 0.01 * np.exp(-0.33 * t) * np.cos(phase), 0.0), 55.0)
    >>> round(found.s.imag, 6), round(found.s.real, 6), round(found.turn, 3)
    (55.0, -0.33, 60.0)
    """
    s, g = _begun(bins, omega)

    def solved(s: complex, g: complex, *, free: bool) -> Decay:
        found = _solved(bins, s, g, 0.0, more, bends=free)
        return _solved(bins, found.s, found.g, found.size, more, bends=free) if sensor else found

    try:
        linear = solved(complex(s.real, omega), 0.0, free=False)
    except RigError:
        if not bends:
            raise
        return solved(s, g, free=True)
    turns = abs(linear.turn) > _BELIEVED * linear.u_turn and abs(linear.turn) * linear.size**2 > _BENDS * linear.s.imag
    return solved(s, g, free=True) if bends and turns else linear


def again(bins: Bins, found: Decay) -> complex:
    """Return the exponent by another piece of the signal, with the dependence on the amplitude as found."""
    return _solved(bins, found.s, found.g, 0.0, None, bends=False).s


def _begun(bins: Bins, omega: float) -> tuple[complex, complex]:
    """Return s and g by the phase and the logarithm of the amplitude over blocks of four periods."""
    tau = bins.t - bins.t[0]
    block = (tau * omega / (8 * np.pi)).astype(np.intp)
    count = np.bincount(block)
    turned = bins.mean * np.exp(-1j * omega * tau)
    means = 2 * (np.bincount(block, turned.real) + 1j * np.bincount(block, turned.imag)) / np.maximum(count, 1)
    whole = count > 0.9 * np.median(count)
    means, at = means[whole], (np.flatnonzero(whole) + 0.5) * 8 * np.pi / omega
    if len(means) < 4:
        return complex(-0.3, omega), 0.0
    square = np.abs(means) ** 2
    h = np.concatenate([[0.0], np.cumsum(0.5 * (square[1:] + square[:-1]) * np.diff(at))])
    columns = np.stack([np.ones(len(at)), at, h])
    weights = np.abs(means)
    fits = [
        np.linalg.lstsq((columns * weights).T, each * weights, rcond=None)[0]
        for each in (np.log(np.abs(means)), np.unwrap(np.angle(means)))
    ]
    fall = min(float(fits[0][1]), -1e-3)
    return complex(fall, omega + float(fits[1][1])), complex(0.0, float(fits[1][2]))


def _solved(bins: Bins, s: complex, g: complex, reach: float, more: Floats | None, *, bends: bool) -> Decay:
    """Return the decay by Gauss-Newton, with g free or held.

    With a `reach` the signal may hold polynomials of the motion over it.
    """
    tau, y = bins.t - bins.t[0], bins.mean
    beside = _beside(bins, more)
    terms = np.zeros((0, len(tau)))
    z: complex = complex(np.abs(y[: max(8, len(y) // 50)]).max())
    n = 4 if bends else 2
    for _ in range(_ROUNDS):
        h, by_fall = _slowed(s, z, tau)
        if not s.real * tau[-1] < _GROWS or not abs(g.real * h[-1]) < _GROWS:
            raise RigError(f"the ring-down grows, by exp({s.real:.3g} t); record the free decay with the base at rest")
        e: Any = sinhc(0.5 * s * bins.width) * np.exp(s * tau + g * h)
        bare = bool(reach) and not len(terms)
        columns = np.vstack([e.real, -e.imag, beside, terms])
        linear = np.linalg.solve(columns @ columns.T, columns @ y)
        z, known = complex(linear[0], linear[1]), len(columns)
        bent = linear[3:] @ columns[3:]
        wave = z * e
        if reach:
            terms = reach * np.polynomial.legendre.legvander(wave.real / reach, _DEGREE).T[2:]
        fall, turn = (tau + g * by_fall) * wave, tau * wave
        slopes = np.vstack([fall.real, -turn.imag, (h * wave).real, -(h * wave).imag])
        columns = np.vstack([columns, slopes[:n]])
        normal = columns @ columns.T
        left = y - linear @ columns[:known]
        scale = np.maximum(np.sqrt(np.diag(normal)), 1e-150)
        step = np.linalg.solve(normal / np.outer(scale, scale), columns @ left / scale) / scale
        # The first steps are held back: over a thousand radians the phase may turn once.
        change = complex(step[known], step[known + 1])
        limit = 1.0 / tau[-1]
        held = min(1.0, limit / abs(change)) if change else 1.0
        s += change * held
        if bends:
            g += complex(step[known + 2], step[known + 3]) * held
        if abs(change) < 1e-11 * abs(s) and not bare:
            break
    else:
        raise RigError("the ring-down is no decaying sine: its fit does not come to rest")
    if not s.real < 0:
        raise RigError(f"the ring-down grows, by exp({s.real:.3g} t); record the free decay with the base at rest")
    residual = float(np.sqrt(np.mean(left**2)))
    inverse = np.linalg.inv(normal / np.outer(scale, scale)) / np.outer(scale, scale)
    u = np.sqrt(np.diag(inverse)[known:] * clumping(left)) * residual
    turned, u_turned = (g.imag, float(u[3])) if bends else _turns(np.vstack([columns, slopes[n:]]), left)
    return Decay(
        bins.t, s, g, z, (float(u[0]), float(u[1])), turned, u_turned, residual, abs(z), bent,
    )  # fmt: skip


def _turns(columns: Floats, left: Floats) -> tuple[float, float]:
    """Return the last column's size in what a fit left, and its standard uncertainty."""
    scale = np.maximum(np.sqrt(np.sum(columns**2, axis=1)), 1e-150)
    inverse = np.linalg.inv(columns @ columns.T / np.outer(scale, scale)) / np.outer(scale, scale)
    step = inverse @ (columns @ left)
    rest = left - step @ columns
    return float(step[-1]), float(np.sqrt(inverse[-1, -1] * np.mean(rest**2) * clumping(rest)))
