"""Motion of the oscillator in closed form between impacts, in SI units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["Motion", "forced_response", "free_part", "root"]

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


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


def _integral(rate: complex, length: Floats) -> Complexes:
    """Return the integrals of exp(rate t) from 0 to each length."""
    return length.astype(complex) if rate == 0 else np.expm1(rate * length) / rate


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

    def both(self, t: Floats) -> tuple[Floats, Floats]:
        """Return x1 [m] and v1 [m/s] at times in seconds; at an impact, just after it."""
        flight = np.maximum(np.searchsorted(self.starts, t, side="right") - 1, 0)
        x1, v1 = self._each(flight, t, [{0: 1.0}, {1: 1.0}])
        return x1, v1

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
        return self._turned(np.exp(1j * self.omega * t), weights)

    def _turned(self, turn: Complexes, weights: Mapping[int, float]) -> Floats:
        at = 1j * self.omega * np.arange(1, len(self.c) + 1)
        c = self.c * sum(w * at**d for d, w in weights.items())
        # Horner's rule in the first harmonic.
        total = np.zeros(len(turn), complex)
        for value in c[::-1]:
            total += value
            total *= turn
        return np.real(total)

    def _on(self, flight: npt.NDArray[np.intp], t: Floats, weights: Mapping[int, float]) -> Floats:
        return self._each(flight, t, [weights])[0]

    def _each(
        self, flight: npt.NDArray[np.intp], t: Floats, several: Sequence[Mapping[int, float]]
    ) -> tuple[Floats, ...]:
        """Return a sum of weighted derivatives for each set of weights."""
        turn, decay = np.exp(1j * self.omega * t), np.exp(self.s * (t - self.starts[flight]))
        found = []
        for weights in several:
            z = self.z * sum(w * self.s**d for d, w in weights.items())
            found.append(self._turned(turn, weights) + (z[flight] * decay).real)
        return tuple(found)

    def peaks(self) -> tuple[Floats, Floats]:
        """Return times and values of |x1| at every root of v1 and at every impact where |x1| has a corner.

        Between two nodes, a fortieth of a period apart, v1 has at most one root for a record that a laser can follow;
        each is polished by Newton's method to rounding, so the values are those of the closed form.
        """
        nodes = np.arange(self.starts[0], self.stop, 2 * np.pi / self.omega / 40)
        cuts = np.unique(np.concatenate([nodes, self.starts]))
        left, right = cuts[:-1], cuts[1:]
        flight = np.searchsorted(self.starts, left, side="right") - 1
        speed = self._on(np.append(flight, flight[-1]), cuts, {1: 1.0})
        first, last = speed[:-1], speed[1:].copy()
        last[np.searchsorted(right, self.starts[1:])] = self.before(1)
        turning = first * last < 0
        flight, left, right = flight[turning], left[turning], right[turning]
        share = first[turning] / (first[turning] - last[turning])
        t = left + share * (right - left)
        for _ in range(4):
            v1, turning_back = self._each(flight, t, [{1: 1.0}, {2: 1.0}])
            t = np.clip(t - v1 / turning_back, left, right)
        corners = self.starts[1:]
        times = np.concatenate([t, corners])
        values = np.abs(np.concatenate([self._on(flight, t, {0: 1.0}), self.after()]))
        order = np.argsort(times, kind="stable")
        return times[order], values[order]

    def mean_square_velocity(self, edges: Floats) -> Floats:
        """Return <v1^2> between neighbouring edges [m^2/s^2], shape (len(edges) - 1,).

        In closed form on each part that holds no impact: v1 is a sum of exponentials there, and so is its square.
        """
        inside = self.starts[(self.starts > edges[0]) & (self.starts < edges[-1])]
        cuts = np.unique(np.concatenate([inside, edges]))
        left, length = cuts[:-1], np.diff(cuts)
        flight = np.maximum(np.searchsorted(self.starts, left, side="right") - 1, 0)
        at = 1j * self.omega * np.arange(1, len(self.c) + 1)
        sizes = [c * a * np.exp(a * left) for c, a in zip(self.c, at, strict=True)]
        sizes.append(self.z[flight] * self.s * np.exp(self.s * (left - self.starts[flight])))
        total = np.zeros(len(left))
        for size, rate in zip(sizes, [*at, self.s], strict=True):
            for other, its in zip(sizes, [*at, self.s], strict=True):
                total += 0.5 * (size * other * _integral(rate + its, length)).real
                total += 0.5 * (size * other.conj() * _integral(rate + its.conjugate(), length)).real
        return np.add.reduceat(total, np.searchsorted(cuts, edges[:-1])) / np.diff(edges)
