"""Motion of the oscillator in closed form between impacts, in SI units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Motion"]

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)


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
        flight = np.maximum(np.searchsorted(self.starts, t, side="right") - 1, 0)
        return self._on(flight, t, derivative)

    def before(self, derivative: int = 0) -> Floats:
        """Return x1 or a derivative just before each impact, shape (K,)."""
        return self._on(np.arange(len(self.starts) - 1), self.starts[1:], derivative)

    def after(self, derivative: int = 0) -> Floats:
        """Return x1 or a derivative just after each impact, shape (K,)."""
        return self._on(np.arange(1, len(self.starts)), self.starts[1:], derivative)

    def forced(self, t: Floats, derivative: int = 0) -> Floats:
        """Return the forced response or a derivative of it."""
        total = np.zeros(len(t))
        turn = np.exp(1j * self.omega * t)
        power = np.ones_like(turn)
        for n, value in enumerate(self.c, start=1):
            power = power * turn
            total += (value * (1j * n * self.omega) ** derivative * power).real
        return total

    def _on(self, flight: npt.NDArray[np.intp], t: Floats, derivative: int) -> Floats:
        free = self.z[flight] * self.s**derivative * np.exp(self.s * (t - self.starts[flight]))
        return self.forced(t, derivative) + free.real

    def peaks(self) -> tuple[Floats, Floats]:
        """Return times and values of |x1| at every root of v1 and at every impact where |x1| has a corner.

        Between two nodes, a fortieth of a period apart, v1 has at most one root for a record that a laser can follow;
        each is polished by Newton's method to rounding, so the values are those of the closed form.
        """
        nodes = np.arange(self.starts[0], self.stop, 2 * np.pi / self.omega / 40)
        cuts = np.unique(np.concatenate([nodes, self.starts]))
        left, right = cuts[:-1], cuts[1:]
        flight = np.searchsorted(self.starts, left, side="right") - 1
        first, last = self._on(flight, left, 1), self._on(flight, right, 1)
        turning = first * last < 0
        flight, left, right = flight[turning], left[turning], right[turning]
        share = first[turning] / (first[turning] - last[turning])
        t = left + share * (right - left)
        for _ in range(4):
            t = np.clip(t - self._on(flight, t, 1) / self._on(flight, t, 2), left, right)
        corners = self.starts[1:]
        times = np.concatenate([t, corners])
        values = np.abs(np.concatenate([self._on(flight, t, 0), self.after()]))
        order = np.argsort(times, kind="stable")
        return times[order], values[order]

    def mean_square_velocity(self, start: float, stop: float) -> float:
        """Return <v1^2> over a stretch of time [m^2/s^2], by Gauss–Legendre, ten points a tenth of a period."""
        grid = np.arange(start, stop, 2 * np.pi / self.omega / 10)
        inside = self.starts[(self.starts > start) & (self.starts < stop)]
        cuts = np.unique(np.concatenate([grid, inside, [stop]]))
        left, half = cuts[:-1], 0.5 * np.diff(cuts)
        flight = np.maximum(np.searchsorted(self.starts, left, side="right") - 1, 0)
        total = 0.0
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            total += weight * float(np.sum(half * self._on(flight, left + half * (1 + node), 1) ** 2))
        return total / (stop - start)
