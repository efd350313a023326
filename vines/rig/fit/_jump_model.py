"""The model of the oscillator's signal whose least squares give its velocity jumps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.fit._bins import Bins
from vines.rig.fit._jumps import JumpFit, Jumps
from vines.rig.fit._motion import Motion
from vines.rig.fit._normal_equations import Expected, NormalEquations, Solution
from vines.rig.fit._signal import Signal
from vines.rig.fit._sine_fit import clumping
from vines.rig.fit._slide import Push
from vines.rig.fit._train import Train
from vines.rig.uncertainty import robust_deviation

__all__ = ["JumpModel", "noise_of"]

Floats = npt.NDArray[np.float64]

_SWAP = 1e-3
"""Relative step of the forced response."""


@dataclass(frozen=True, slots=True, eq=False)
class JumpModel(Signal):
    """The signal of the oscillator with a velocity jump at each impact.

    Attributes
    ----------
    seed : int
        Of the draws for uncertainties. All others are those of :class:`Signal`.
    """

    seed: int = 0

    def fit(
        self,
        train: Train,
        *,
        expected: Expected | None = None,
        pushed: Push | None = None,
        fair: npt.NDArray[np.bool_] | None = None,
        draws: int = 32,
    ) -> JumpFit:
        """Fit the model at given impacts by linear least squares.

        Parameters
        ----------
        train : Train
            Of K impacts, no two at one time. A shift of an impact by dt is, to first order, a jump -dv dt of the
            position, so uncertain times allow such jumps; what the signal says of the time is in `JumpFit.shift` (the
            Gauss–Newton step). Of the velocity jumps only the sizes matter, about.
        expected : tuple of ndarray, optional
            Velocity jumps known from elsewhere (pulses of the acceleration) and their standard uncertainties [m/s].
        pushed : Push, optional
            What the ball's friction adds.
        fair : ndarray of bool, shape (K + 1,), optional
            Flights that are trusted at first, such as by a fit that knew more.
        draws : int
            Draws for the uncertainty; without any, `JumpFit.draws`, `first`, `swap` and `u_dv` tell nothing.

        Raises
        ------
        RigError
            If two impacts are at one time, one is outside of the record, or the record holds too few samples for them.
        """
        equations = NormalEquations(self, train, pushed, fair)
        noise = max(noise_of(self.bins), 1e-15)
        solution, clumped = _solved(equations, train, noise, expected)
        left = equations.left(solution)
        motion = equations.motion(solution)
        jumps, shift = _read(motion, equations)
        others = [equations.motion(one) for one in solution.drawn(np.random.default_rng(self.seed), draws)]
        drawn = Jumps.stacked([_read(other, equations)[0] for other in others])
        return JumpFit(
            motion=motion,
            jumps=jumps,
            draws=drawn,
            first=np.array([other.c[0] for other in others]),
            swap=Jumps.stacked(list(_swapped(equations, solution, motion, jumps)) if draws else []),
            shift=shift,
            u_dv=drawn.dv.std(axis=0) if draws else np.zeros(len(shift)),
            residual=float(np.sqrt(np.mean(left[equations.trusted] ** 2))),
            noise=noise,
            clumped=clumped,
            fair=equations.fair,
            left=left,
            left_t=equations.t,
            extra=solution.linear[2 * self.harmonics + 1 :],
            offset=float(solution.linear[2 * self.harmonics]),
        )


def _solved(
    equations: NormalEquations, train: Train, noise: float, expected: Expected | None
) -> tuple[Solution, float]:
    """Return the solution with its own scale of noise and without the flights that are not one; how clumped that is."""
    # Sizes are given, never those of the fit: a jump fitted too small would tighten its own condition and run away.
    u_gap = np.maximum(np.abs(train.dv), 1e-4) * train.u
    solution, clumped = equations.solve(noise, u_gap, expected), 1.0
    for _ in range(3):
        left = equations.left(solution)
        equations.distrust(left, noise)
        left = left[equations.trusted]
        clumped = clumping(left)
        scale = max(float(np.sqrt(np.mean(left**2) * clumped)), 1e-15)
        solution = equations.solve(scale, u_gap, expected)
    return solution, clumped


def _swapped(equations: NormalEquations, solution: Solution, motion: Motion, jumps: Jumps) -> Iterator[Jumps]:
    """Yield the derivatives of the jumps by a relative change of the first harmonic, real and imaginary."""
    for turn in (1.0, 1j):
        other = equations.motion(solution.beside(complex(_SWAP * turn * motion.c[0])))
        moved = _read(other, equations)[0]
        # The times are those that the impacts were heard at.
        late, turning = moved.t - jumps.t, 0.5 * (motion.before(2) + motion.after(2))
        moved = Jumps(
            jumps.t,
            moved.x - 0.5 * (jumps.v_before + jumps.v_after) * late,
            moved.v_before - turning * late,
            moved.v_after - turning * late,
        )
        yield moved.less(jumps, _SWAP)


def _read(motion: Motion, equations: NormalEquations) -> tuple[Jumps, Floats]:
    """Return the state at each impact at its refined time, and the shift of the time."""
    pushed, fair = equations.pushed, equations.fair
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
    return robust_deviation(np.diff(bins.mean, 4)) / float(np.sqrt(binomial @ alike @ binomial))
