"""Motion of the oscillator in closed form between impacts, in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["Motion", "forced_response", "free_part", "root"]

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)


def root(omega0: float, lam: float) -> complex:
    """Return s of the free oscillation exp(s t), -lam omega0/2 + i gamma [1/s]."""
    return omega0 * complex(-lam / 2, np.sqrt(1 - lam**2 / 4))


def forced_response(e: Any, omega: Any, s: complex) -> Any:
    """Return the response Re[c exp(i omega t)] to a base motion Re[e exp(i omega t)], spring and damper on the base."""
    damp = -2j * s.real * omega
    return e * (abs(s) ** 2 + damp) / (abs(s) ** 2 - omega**2 + damp)


def free_part(x: Any, v: Any, s: complex) -> Any:
    """Return z of the free oscillation Re[z exp(s t)] that begins with displacement x and velocity v."""
    return x - 1j * (v - s.real * x) / s.imag


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """x1(t) = Re sum c_n exp(i n omega t) + Re[z_j exp(s (t - T_j))] on the flight that begins at T_j.

    Attributes
    ----------
    s : complex
        -lam omega0/2 + i gamma of the free oscillation [1/s].
    omega : float
        Angular frequency of the forcing [rad/s].
    c : ndarray of complex, shape (N,)
        Forced response, harmonics 1 … N [m].
    starts : ndarray, shape (K + 1,)
        Start of the record, then the times of the K impacts [s].
    z : ndarray of complex, shape (K + 1,)
        Free part at the start of each flight [m].
    stop : float
        End of the record [s].
    """

    s: complex
    omega: float
    c: Complexes
    starts: Floats
    z: Complexes
    stop: float

    def at(self, t: Floats, derivative: int = 0) -> Floats:
        """Return x1 [m], or a time derivative of it, at times in seconds; at an impact, just after it."""
        return self.combination(t, {derivative: 1.0})

    def combination(self, t: Floats, weights: Mapping[int, float]) -> Floats:
        """Return the sum of weights times derivatives of x1, given by their order, at times in seconds."""
        flight = np.maximum(np.searchsorted(self.starts, t, side="right") - 1, 0)
        return self._on(flight, t, weights)

    def before(self, derivative: int = 0) -> Floats:
        """Return x1 or a derivative just before each impact, shape (K,)."""
        return self._on(np.arange(len(self.starts) - 1), self.starts[1:], {derivative: 1.0})

    def after(self, derivative: int = 0) -> Floats:
        """Return x1 or a derivative just after each impact, shape (K,)."""
        return self._on(np.arange(1, len(self.starts)), self.starts[1:], {derivative: 1.0})

    def on(self, flight: npt.NDArray[np.intp], t: Floats, derivative: int = 0) -> Floats:
        """Return x1 or a derivative at times of given flights, their ends included."""
        return self._on(flight, t, {derivative: 1.0})

    def forced(self, t: Floats, derivative: int = 0) -> Floats:
        """Return the forced response or a derivative of it."""
        return self._forced(t, {derivative: 1.0})

    def _forced(self, t: Floats, weights: Mapping[int, float]) -> Floats:
        at = 1j * self.omega * np.arange(1, len(self.c) + 1)
        c = self.c * sum(w * at**d for d, w in weights.items())
        turn = np.exp(1j * self.omega * t)
        # Horner's rule in the first harmonic.
        total = np.zeros(len(t), complex)
        for value in c[::-1]:
            total += value
            total *= turn
        return np.real(total)

    def _on(self, flight: npt.NDArray[np.intp], t: Floats, weights: Mapping[int, float]) -> Floats:
        z = self.z * sum(w * self.s**d for d, w in weights.items())
        free = z[flight] * np.exp(self.s * (t - self.starts[flight]))
        return self._forced(t, weights) + free.real

    def peaks(self) -> tuple[Floats, Floats]:
        """Return times and values of |x1| at every root of v1 and at every impact where |x1| has a corner.

        Between two nodes, a fortieth of a period apart, v1 has at most one root for a record that a laser can follow;
        each is polished by Newton's method to rounding, so the values are those of the closed form.
        """
        nodes = np.arange(self.starts[0], self.stop, 2 * np.pi / self.omega / 40)
        cuts = np.unique(np.concatenate([nodes, self.starts]))
        left, right = cuts[:-1], cuts[1:]
        flight = np.searchsorted(self.starts, left, side="right") - 1
        first, last = self._on(flight, left, {1: 1.0}), self._on(flight, right, {1: 1.0})
        turning = first * last < 0
        flight, left, right = flight[turning], left[turning], right[turning]
        share = first[turning] / (first[turning] - last[turning])
        t = left + share * (right - left)
        for _ in range(4):
            t = np.clip(t - self._on(flight, t, {1: 1.0}) / self._on(flight, t, {2: 1.0}), left, right)
        corners = self.starts[1:]
        times = np.concatenate([t, corners])
        values = np.abs(np.concatenate([self._on(flight, t, {0: 1.0}), self.after()]))
        order = np.argsort(times, kind="stable")
        return times[order], values[order]

    def mean_square_velocity(self, edges: Floats) -> Floats:
        """Return <v1^2> between neighbouring edges [m^2/s^2], shape (len(edges) - 1,).

        By Gauss–Legendre, ten points on every part that is no longer than a tenth of a period and holds no impact.
        """
        grid = np.arange(edges[0], edges[-1], 2 * np.pi / self.omega / 10)
        inside = self.starts[(self.starts > edges[0]) & (self.starts < edges[-1])]
        cuts = np.unique(np.concatenate([grid, inside, edges]))
        left, half = cuts[:-1], 0.5 * np.diff(cuts)
        flight = np.maximum(np.searchsorted(self.starts, left, side="right") - 1, 0)
        total = np.zeros(len(left))
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            total += weight * half * self._on(flight, left + half * (1 + node), {1: 1.0}) ** 2
        return np.add.reduceat(total, np.searchsorted(cuts, edges[:-1])) / np.diff(edges)
