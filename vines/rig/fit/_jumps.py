"""Velocity jumps of the oscillator by linear least squares over all flights at once.

Between impacts x1 is a forced response with harmonics plus a free oscillation; at impact k the velocity jumps by dv_k
and the position does not. Written with one jump response G(t - t_k) an impact this is a full matrix; written with the
free part z_j of each flight as unknowns it is banded, and thousands of impacts cost milliseconds (docs/rig.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import cho_solve_banded, cholesky_banded

from vines.errors import RigError
from vines.rig.fit._bins import Bins
from vines.rig.fit._motion import Motion
from vines.rig.fit._sine_fit import clumping
from vines.rig.fit._slide import Push
from vines.rig.spread import spread_about

__all__ = ["TAIL", "JumpFit", "Jumps", "fit_jumps", "noise_of"]

Floats = npt.NDArray[np.float64]

_SWAP = 1e-3
"""Relative step of the forced response."""

_DISTRUST = 1e-4
"""Weight of the samples of a flight that is not one."""

_WIDEST = 2e-3
"""No more is left out beside an impact [s]."""

TAIL = 4.5
"""How far the pulse of an impact reaches into a smoothed acceleration, in standard deviations of the smoothing."""


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


def fit_jumps(
    bins: Bins,
    s: complex,
    omega: float,
    times: Floats,
    u_times: Floats | float,
    sizes: Floats,
    *,
    order: int = 0,
    harmonics: int = 5,
    guard: float = 2.5e-4,
    expected: tuple[Floats, Floats] | None = None,
    forced: tuple[npt.NDArray[np.complex128], Floats] | None = None,
    pushed: Push | None = None,
    extra: tuple[Floats, Floats] | None = None,
    fair: npt.NDArray[np.bool_] | None = None,
    draws: int = 32,
    seed: int = 0,
) -> JumpFit:
    """Fit forced response, free oscillation and velocity jumps to displacement or acceleration of the oscillator.

    Parameters
    ----------
    bins : Bins
        Of the channel.
    s : complex
        -lam omega0/2 + i gamma [1/s].
    omega : float
        Angular frequency of the forcing [rad/s].
    times : ndarray, shape (K,)
        Impact times, ascending [s]; none twice.
    u_times : ndarray, shape (K,), or float
        Their standard uncertainty [s]. A shift of an impact by dt is, to first order, a jump -dv dt of the position,
        so this allows such jumps; what the signal says of the time is in `JumpFit.shift` (the Gauss–Newton step).
    sizes : ndarray, shape (K,)
        About how large the velocity jumps are [m/s]; their signs don't matter.
    order : {0, 2}
        Derivative of x1 that the channel measures.
    harmonics : int
        Harmonics of the forced response.
    guard : float
        Blocks nearer to an impact are left out [s]: contact takes time.
    expected : tuple of ndarray, optional
        Velocity jumps known from elsewhere (pulses of the acceleration) and their standard uncertainties [m/s].
    forced : tuple of ndarray, optional
        The last harmonics of the forced response as the base's ask for them [m], and their standard uncertainties: a
        train of equal jumps and a few free harmonics are nearly the same motion.
    pushed : Push, optional
        What the ball's friction adds.
    extra : tuple of ndarray, optional
        Further signals that may be in the channel, one a row, at the times of `bins`, and the standard uncertainties of
        their sizes about 0.
    fair : ndarray of bool, shape (K + 1,), optional
        Flights that are trusted at first, such as by a fit that knew more.
    draws : int
        Draws for the uncertainty; without any, `JumpFit.draws`, `first`, `swap` and `u_dv` tell nothing.
    seed : int
        Of the draws.

    Raises
    ------
    RigError
        If the record holds too few samples for so many impacts.
    """
    more = (np.zeros((0, len(bins.t))), np.zeros(0)) if extra is None else extra
    u_times = np.broadcast_to(np.asarray(u_times, float), np.shape(times))
    # Samples on the wrong side of an impact whose time is not known belong to the other flight.
    guards = np.maximum(guard, np.minimum(2 * u_times, _WIDEST)) if order == 0 else np.full(len(u_times), guard)
    problem = _Problem(bins, s, omega, np.asarray(times, float), order, harmonics, guards, more)
    problem.forced_known = forced
    if pushed is not None:
        problem.push(pushed)
    if fair is not None:
        problem.trust(fair)
    noise = max(noise_of(bins), 1e-15)
    scale = noise
    # Sizes are given, never those of the fit: a jump fitted too small would tighten its own condition and run away.
    u_gap = np.maximum(np.abs(sizes), 1e-4) * u_times
    solved = problem.solve(scale, u_gap, expected)
    clumped = 1.0
    for _ in range(3):
        problem.distrust(problem.left(*solved[:2]), noise)
        left = problem.left(*solved[:2])[problem.trusted]
        clumped = clumping(left)
        scale = max(float(np.sqrt(np.mean(left**2) * clumped)), 1e-15)
        solved = problem.solve(scale, u_gap, expected)
    z, linear, factor, border, schur = solved
    left = problem.left(z, linear)
    motion = problem.motion(z, linear)
    trusted = left[problem.trusted]
    jumps, shift = _read(motion, problem.pushed, problem.fair)
    rng = np.random.default_rng(seed)
    drawn, first = [], []
    lower = np.linalg.cholesky(schur)
    for _ in range(draws):
        move = np.linalg.solve(lower.T, rng.normal(size=len(linear)))
        noise_z = cho_solve_banded((factor, True), _multiply(factor, rng.normal(size=factor.shape[1])))
        other = problem.motion(z + noise_z - border @ move, linear + move)
        drawn.append(_read(other, problem.pushed, problem.fair)[0])
        first.append(other.c[0])
    together = _stacked(drawn)
    swapped = []
    for turn in (1.0, 1j) if draws else ():
        move = _SWAP * turn * motion.c[0]
        fixed = np.array([move.real, move.imag])
        change = np.concatenate([fixed, -np.linalg.solve(schur[2:, 2:], schur[2:, :2] @ fixed)])
        other = problem.motion(z - border @ change, linear + change)
        moved = _read(other, problem.pushed, problem.fair)[0]
        # The times are those that the impacts were heard at.
        late, turning = moved.t - jumps.t, 0.5 * (motion.before(2) + motion.after(2))
        moved = Jumps(
            jumps.t,
            moved.x - 0.5 * (jumps.v_before + jumps.v_after) * late,
            moved.v_before - turning * late,
            moved.v_after - turning * late,
        )
        swapped.append(moved.less(jumps, _SWAP))
    return JumpFit(
        motion,
        jumps,
        together,
        np.array(first),
        _stacked(swapped),
        shift,
        together.dv.std(axis=0) if draws else np.zeros(len(shift)),
        float(np.sqrt(np.mean(trusted**2))),
        noise,
        clumped,
        problem.fair,
        left,
        problem.t,
        linear[2 * harmonics + 1 :],
        float(linear[2 * harmonics]),
    )


def _stacked(several: list[Jumps]) -> Jumps:
    return Jumps(*(np.array([getattr(one, name) for one in several]) for name in ("t", "x", "v_before", "v_after")))


def _read(motion: Motion, pushed: Push, fair: npt.NDArray[np.bool_]) -> tuple[Jumps, Floats]:
    """Return the state at each impact at its refined time, and the shift of the time."""
    x, v_before = motion.before() + pushed.end[:-1], motion.before(1) + pushed.speed[:-1]
    v_after = motion.after(1)
    gap = motion.after() + pushed.start[1:] - x
    dv = v_after - v_before
    # x_after(t) - x_before(t) = gap + dv (t - t_k) vanishes at the true time; far moves mean that dv is no jump at all,
    # and a flight that is not one says nothing.
    told = (np.abs(dv) > 1e-6) & fair[:-1] & fair[1:]
    shift = np.where(told, -gap / np.where(dv == 0, 1.0, dv), 0.0)
    shift = np.clip(shift, -1e-3, 1e-3)
    x = x + v_before * shift
    turn = 0.5 * (motion.before(2) + motion.after(2))
    moved = Jumps(motion.starts[1:] + shift, x, v_before + turn * shift, v_after + turn * shift)
    return moved, shift


def noise_of(bins: Bins) -> float:
    """Return the noise of a block mean from fourth differences, which the oscillator's motion hardly reaches."""
    binomial = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
    # Neighbouring values of a smoothed signal are alike, and so is their noise.
    step = float(np.median(np.diff(bins.t))) / bins.smooth if bins.smooth else np.inf
    lag = np.subtract.outer(np.arange(5), np.arange(5))
    alike = np.where(lag == 0, 1.0, np.exp(-0.25 * np.where(lag == 0, 1, lag) ** 2 * step**2))
    return spread_about(0.0, np.diff(bins.mean, 4)) / float(np.sqrt(binomial @ alike @ binomial))


def _multiply(factor: Floats, vector: Floats) -> Floats:
    """Return L times a vector, L in banded lower form."""
    result = factor[0] * vector
    for d in range(1, factor.shape[0]):
        result[d:] += factor[d, :-d] * vector[:-d]
    return result


class _Problem:
    """The normal equations: unknowns (Re z_j, Im z_j) of each flight, and the forced response with an offset."""

    def __init__(
        self,
        bins: Bins,
        s: complex,
        omega: float,
        times: Floats,
        order: int,
        harmonics: int,
        guard: Floats,
        extra: tuple[Floats, Floats],
    ) -> None:
        self.s, self.omega, self.order, self.harmonics = s, omega, order, harmonics
        self.forced_known: tuple[npt.NDArray[np.complex128], Floats] | None = None
        start, stop = float(bins.t[0]), float(bins.t[-1])
        self.times = times
        if len(times) and not (np.all(np.diff(times) > 0) and start < times[0] and times[-1] < stop):
            raise RigError("impact times must ascend and lie inside the record")
        self.starts = np.concatenate([[start], times])
        self.stop = stop
        reach = guard + 0.5 * bins.width + TAIL * bins.smooth
        self.kept = keep = np.ones(len(bins.t), bool)
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
        columns, self.u_extra = extra
        self.forced = np.empty((2 * harmonics + 1 + len(columns), len(self.t)))
        turn = np.exp(1j * omega * self.t)
        power = np.ones_like(turn)
        for n in range(1, harmonics + 1):
            power = power * turn
            column = bins.response(1j * n * omega) * (1j * n * omega) ** order * power
            self.forced[2 * n - 2], self.forced[2 * n - 1] = column.real, -column.imag
        self.forced[2 * harmonics] = 1.0
        self.forced[2 * harmonics + 1 :] = columns[:, keep]
        self.fair = np.ones(flights, bool)
        self.pushed = Push(np.zeros(0), *np.zeros((3, flights)))
        self._sum_flights()
        self._gather()

    @property
    def trusted(self) -> npt.NDArray[np.bool_]:
        """Which blocks lie on trusted flights."""
        return self.fair[self.flight]

    def push(self, pushed: Push) -> None:
        """Take a known part of each flight off the signal."""
        self.pushed = pushed
        self.y = self.y - pushed.signal[self.kept]
        self._sum_signal()
        self._gather()

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
            self.trust(fair)

    def trust(self, fair: npt.NDArray[np.bool_]) -> None:
        """Leave out all other flights."""
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
        self._sum_signal()

    def _sum_signal(self) -> None:
        one, two = self.free
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

    def solve(
        self, scale: float, u_gap: Floats, expected: tuple[Floats, Floats] | None
    ) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return flights' unknowns, forced response, banded factor, its answer to the border, Schur complement."""
        band, right = self.band / scale**2, self.right / scale**2
        cross, corner, below = self.cross / scale**2, self.corner / scale**2, self.below / scale**2
        if self.forced_known is not None:
            c, u_c = self.forced_known
            for n, (value, u_n) in enumerate(zip(c, u_c, strict=True), start=self.harmonics - len(c)):
                for k, part in ((2 * n, value.real), (2 * n + 1, value.imag)):
                    corner[k, k] += 1 / u_n**2
                    below[k] += part / u_n**2
        more = np.arange(2 * self.harmonics + 1, len(corner))
        corner[more, more] += 1 / self.u_extra**2
        step: Any = np.exp(self.s * np.diff(self.starts))
        position = np.stack([-step.real, step.imag, np.ones(len(step)), np.zeros(len(step))], axis=1)
        carried = self.s * step
        velocity = np.stack(
            [-carried.real, carried.imag, np.full(len(step), self.s.real), np.full(len(step), -self.s.imag)], axis=1
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
        return answer[:, 0] - border @ linear, linear, factor, border, schur

    def left(self, z: Floats, linear: Floats) -> Floats:
        """Return what a solution leaves of the signal."""
        one, two = self.free
        count = np.diff(self.first, append=len(self.y))
        own = self.y - linear @ self.forced
        own -= one * np.repeat(z[0::2][self.seen], count)
        own -= two * np.repeat(z[1::2][self.seen], count)
        return own

    def motion(self, z: Floats, linear: Floats) -> Motion:
        """Return x1 in closed form."""
        known = 2 * self.harmonics
        c = linear[0:known:2] + 1j * linear[1:known:2]
        return Motion(self.s, self.omega, c, self.starts, z[0::2] + 1j * z[1::2], self.stop)


def _add(band: Floats, right: Floats, row: Floats, weight: Floats, value: Floats) -> None:
    """Add weighted conditions row · (z_{k-1}, z_k) = value to the normal equations."""
    for i in range(4):
        right[i : i + 2 * len(row) : 2] += weight * row[:, i] * value
        for j in range(i + 1):
            band[i - j, j : j + 2 * len(row) : 2] += weight * row[:, i] * row[:, j]
