"""Normal equations of the oscillator's motion over all flights at once.

Between impacts x1 is a forced response with harmonics plus a free oscillation; at impact k the velocity jumps by dv_k
and the position does not. Written with one jump response G(t - t_k) an impact this is a full matrix; written with the
free part z_j of each flight as unknowns it is banded, and thousands of impacts cost milliseconds (docs/rig.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import cho_solve_banded, cholesky_banded

from vines.errors import RigError
from vines.rig.fit._motion import Motion
from vines.rig.fit._signal import Signal
from vines.rig.fit._slide import Push
from vines.rig.fit._train import Train

__all__ = ["TAIL", "Expected", "NormalEquations", "Solution"]

Floats = npt.NDArray[np.float64]

Expected = tuple[Floats, Floats]
"""Velocity jumps known from elsewhere and their standard uncertainties [m/s]."""

_DISTRUST = 1e-4
"""Weight of the samples of a flight that is not one."""

_WIDEST = 2e-3
"""No more is left out beside an impact [s]."""

TAIL = 4.5
"""How far the pulse of an impact reaches into a smoothed acceleration, in standard deviations of the smoothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """A solution of the normal equations, and what its uncertainty follows from.

    Attributes
    ----------
    z : ndarray, shape (2 (K + 1),)
        Real and imaginary part of the free oscillation at the start of each flight.
    linear : ndarray, shape (n,)
        Real and imaginary parts of the harmonics, the offset, sizes of further signals.
    factor : ndarray
        Banded Cholesky factor of the flights' equations, lower form.
    border : ndarray, shape (2 (K + 1), n)
        By how much `z` changes against a change of `linear`.
    schur : ndarray, shape (n, n)
        Inverse covariance of `linear`.
    """

    z: Floats
    linear: Floats
    factor: Floats
    border: Floats
    schur: Floats

    def drawn(self, rng: np.random.Generator, count: int) -> Iterator[Solution]:
        """Yield solutions as the noise of the signal draws them."""
        lower = np.linalg.cholesky(self.schur)
        for _ in range(count):
            move = np.linalg.solve(lower.T, rng.normal(size=len(self.linear)))
            noise = _multiply(self.factor, rng.normal(size=self.factor.shape[1]))
            moved_z = self.z + cho_solve_banded((self.factor, True), noise)
            yield replace(self, z=moved_z - self.border @ move, linear=self.linear + move)

    def beside(self, change: complex) -> Solution:
        """Return the best solution whose first harmonic differs by a change [m]."""
        fixed = np.array([change.real, change.imag])
        move = np.concatenate([fixed, -np.linalg.solve(self.schur[2:, 2:], self.schur[2:, :2] @ fixed)])
        return replace(self, z=self.z - self.border @ move, linear=self.linear + move)


class NormalEquations:
    """The normal equations: unknowns (Re z_j, Im z_j) of each flight, and the forced response with an offset.

    Parameters
    ----------
    signal : Signal
    train : Train
    pushed : Push or None
        Known part of each flight, taken off the signal.
    fair : ndarray of bool or None, shape (K + 1,)
        Flights that are trusted at first; all if None.

    Raises
    ------
    RigError
        As of `JumpModel.fit`.
    """

    def __init__(self, signal: Signal, train: Train, pushed: Push | None, fair: npt.NDArray[np.bool_] | None) -> None:
        bins, times, harmonics, order = signal.bins, train.t, signal.harmonics, signal.order
        s, omega = signal.s, signal.omega
        self.signal = signal
        columns, self.u_extra = (np.zeros((0, len(bins.t))), np.zeros(0)) if signal.extra is None else signal.extra
        start, stop = float(bins.t[0]), float(bins.t[-1])
        if len(times) and not (np.all(np.diff(times) > 0) and start < times[0] and times[-1] < stop):
            raise RigError("impacts must be at times of their own, inside the record")
        self.starts = np.concatenate([[start], times])
        self.stop = stop
        guards = np.full(len(times), signal.guard)
        if order == 0:
            # Samples on the wrong side of an impact whose time is not known belong to the other flight.
            guards = np.maximum(guards, np.minimum(2 * train.u, _WIDEST))
        reach = guards + 0.5 * bins.width + TAIL * bins.smooth
        keep = np.ones(len(bins.t), bool)
        low, high = np.searchsorted(bins.t, times - reach), np.searchsorted(bins.t, times + reach)
        for k in range(int((high - low).max(initial=0))):
            keep[np.minimum(low + k, high - 1)[high > low]] = False
        self.t, self.y = bins.t[keep], bins.mean[keep]
        flights = len(self.starts)
        if len(self.t) < 2 * flights + 2 * harmonics + 2:
            raise RigError(f"{len(times)} impacts leave only {len(self.t)} stretches of samples between them")
        self.flight = np.maximum(np.searchsorted(self.starts, self.t, side="right") - 1, 0)
        free = bins.response(s) * s**order * np.exp(s * (self.t - self.starts[self.flight]))
        self.free = np.stack([free.real, -free.imag])
        self.forced = np.empty((2 * harmonics + 1 + len(columns), len(self.t)))
        turn = np.exp(1j * omega * self.t)
        power = np.ones_like(turn)
        for n in range(1, harmonics + 1):
            power = power * turn
            column = bins.response(1j * n * omega) * (1j * n * omega) ** order * power
            self.forced[2 * n - 2], self.forced[2 * n - 1] = column.real, -column.imag
        self.forced[2 * harmonics] = 1.0
        self.forced[2 * harmonics + 1 :] = columns[:, keep]
        if pushed is not None:
            self.y = self.y - pushed.signal[keep]
        self.pushed = Push(np.zeros(0), *np.zeros((3, flights))) if pushed is None else pushed
        self.fair = np.ones(flights, bool) if fair is None else fair
        self._sum_flights()
        self._gather()

    @property
    def trusted(self) -> npt.NDArray[np.bool_]:
        """Which blocks lie on trusted flights."""
        return self.fair[self.flight]

    def distrust(self, left: Floats, noise: float) -> None:
        """Leave out flights whose residual is far above that of the others: an impact in them is missing."""
        count = np.maximum(np.bincount(self.flight, minlength=len(self.starts)), 1)
        size = np.sqrt(np.bincount(self.flight, left**2, len(self.starts)) / count)
        usual = max(float(np.median(size[count > 8])) if (count > 8).any() else noise, noise)
        fair = (size < 3 * usual) | (count <= 8)
        # Half of the flights at least must stay, or nothing is left to judge by.
        if np.mean(fair) < 0.5:
            fair = size <= np.median(size)
        if not np.array_equal(fair, self.fair):
            self.fair = fair
            self._gather()

    def _total(self, values: Floats) -> Floats:
        """Return the sum over each flight; flights without samples have none."""
        total = np.zeros(len(self.starts))
        total[self.seen] = np.add.reduceat(values, self.first)
        return total

    def _sum_flights(self) -> None:
        """Sum products of the columns over each flight, once: a weight is the same for all samples of a flight."""
        self.seen, self.first = np.unique(self.flight, return_index=True)
        flights = len(self.starts)
        one, two = self.free
        self.squares = np.stack([self._total(one * one), self._total(two * two), self._total(one * two)])
        self.crossed = np.empty((2 * flights, len(self.forced)))
        for k, column in enumerate(self.forced):
            self.crossed[0::2, k], self.crossed[1::2, k] = self._total(one * column), self._total(two * column)
        self.forced_square = self.forced @ self.forced.T
        self.seen_right = np.empty(2 * len(self.starts))
        self.seen_right[0::2], self.seen_right[1::2] = self._total(one * self.y), self._total(two * self.y)
        self.forced_signal = self.forced @ self.y

    def _gather(self) -> None:
        weight = np.where(self.fair, 1.0, _DISTRUST)
        twice = np.repeat(weight, 2)
        band = np.zeros((4, 2 * len(weight)))
        band[0, 0::2], band[0, 1::2], band[1, 0::2] = weight * self.squares
        self.band, self.right, self.cross = band, twice * self.seen_right, twice[:, None] * self.crossed
        self.corner, self.below = self.forced_square, self.forced_signal
        if not self.fair.all():
            off = ~self.trusted
            part = self.forced[:, off]
            self.corner = self.corner - (1 - _DISTRUST) * part @ part.T
            self.below = self.below - (1 - _DISTRUST) * part @ self.y[off]

    def solve(self, scale: float, u_gap: Floats, expected: Expected | None) -> Solution:
        """Solve with noise of a standard deviation `scale`, and positions that jump by `u_gap` at the impacts [m]."""
        band, right = self.band / scale**2, self.right / scale**2
        cross, corner, below = self.cross / scale**2, self.corner / scale**2, self.below / scale**2
        s, known = self.signal.s, 2 * self.signal.harmonics
        if self.signal.forced is not None:
            c, u_c = self.signal.forced
            for n, (value, u_n) in enumerate(zip(c, u_c, strict=True), start=self.signal.harmonics - len(c)):
                for k, part in ((2 * n, value.real), (2 * n + 1, value.imag)):
                    corner[k, k] += 1 / u_n**2
                    below[k] += part / u_n**2
        more = np.arange(known + 1, len(corner))
        corner[more, more] += 1 / self.u_extra**2
        step: Any = np.exp(s * np.diff(self.starts))
        position = np.stack([-step.real, step.imag, np.ones(len(step)), np.zeros(len(step))], axis=1)
        carried = s * step
        velocity = np.stack(
            [-carried.real, carried.imag, np.full(len(step), s.real), np.full(len(step), -s.imag)], axis=1
        )
        end, speed = self.pushed.end[:-1], self.pushed.speed[:-1]
        _add(band, right, position, 1 / np.maximum(u_gap, 1e-12) ** 2, end - self.pushed.start[1:])
        # A jump of more than 3 m/s would need a ball of the oscillator's own mass: a bound for flights without samples.
        mean, u = (np.zeros(len(step)), np.full(len(step), 3.0)) if expected is None else expected
        _add(band, right, velocity, 1 / u**2, mean + speed)
        # Keeps the first flight solvable when it holds no samples.
        band[0, :2] += 1e-9 * float(np.median(band[0]))
        factor = cholesky_banded(band, lower=True)
        answer = cho_solve_banded((factor, True), np.column_stack([right, cross]))
        border = answer[:, 1:]
        schur = corner - cross.T @ border
        schur = 0.5 * (schur + schur.T) + np.diag(1e-12 * np.diag(corner))
        linear = np.linalg.solve(schur, below - cross.T @ answer[:, 0])
        return Solution(answer[:, 0] - border @ linear, linear, factor, border, schur)

    def left(self, solution: Solution) -> Floats:
        """Return what a solution leaves of the signal."""
        z, linear = solution.z, solution.linear
        one, two = self.free
        count = np.diff(self.first, append=len(self.y))
        own = self.y - linear @ self.forced
        own -= one * np.repeat(z[0::2][self.seen], count)
        own -= two * np.repeat(z[1::2][self.seen], count)
        return own

    def motion(self, solution: Solution) -> Motion:
        """Return x1 in closed form."""
        z, linear = solution.z, solution.linear
        known = 2 * self.signal.harmonics
        c = linear[0:known:2] + 1j * linear[1:known:2]
        return Motion(self.signal.s, self.signal.omega, c, self.starts, z[0::2] + 1j * z[1::2], self.stop)


def _add(band: Floats, right: Floats, row: Floats, weight: Floats, value: Floats) -> None:
    """Add weighted conditions row · (z_{k-1}, z_k) = value to the normal equations."""
    for i in range(4):
        right[i : i + 2 * len(row) : 2] += weight * row[:, i] * value
        for j in range(i + 1):
            band[i - j, j : j + 2 * len(row) : 2] += weight * row[:, i] * row[:, j]


def _multiply(factor: Floats, vector: Floats) -> Floats:
    """Return L times a vector, L in banded lower form."""
    result = factor[0] * vector
    for d in range(1, factor.shape[0]):
        result[d:] += factor[d, :-d] * vector[:-d]
    return result
