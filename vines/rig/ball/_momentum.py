"""Ratio of the masses, length of the cavity and forces on the ball from M dv1 + m dv2 = 0 at every impact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.rig.ball._ball import Cavity, Course, ball_motion
from vines.rig.fit import Jumps
from vines.rig.recording import Uncertain
from vines.rig.uncertainty import combined, robust_deviation

__all__ = ["SWAPPED", "MomentumFit", "fit_momentum"]

Floats = npt.NDArray[np.float64]

_NAMES = ("mu", "b", "friction", "tilt", "touch", "skew", "bow", "swap", "turn")
_FAR = 5.0

_SKEW = 2e-3
"""How much the gain of the oscillator's sensor may differ along its motion: slope and curvature, of half the range."""


_U_VELOCITY = 4e-3
"""Relative uncertainty of the ball's velocities by the sensor's linearity and the law of the contact; over a flight it
looks like a deceleration."""

SWAPPED = 4e-3
"""How much of the forced response a sensor's linearity may swap for jumps that repeat, relative to it."""


@dataclass(frozen=True, slots=True, eq=False)
class MomentumFit:
    """Estimates from momentum.

    Attributes
    ----------
    mu, b, friction, tilt, touch : Uncertain
        [1], [m], [m/s^2], [m/s^2], [s].
    swapped : tuple of float
        Share of the forced response that was swapped for jumps, real and imaginary part.
    covariance : ndarray, shape (9, 9)
        Of mu, b, friction, tilt, touch, the sensor's slope and curvature, and `swapped`.
    misfit, u : ndarray, shape (K - 2,)
        (dv1 + mu dv2)/u at each impact that has two flights, and u [m/s]; large where an impact near it is missed or
        false.
    good : ndarray of bool, shape (K - 2,)
        Which of them the fit used.
    """

    mu: Uncertain
    b: Uncertain
    friction: Uncertain
    tilt: Uncertain
    touch: Uncertain
    swapped: tuple[float, float]
    covariance: Floats
    misfit: Floats
    u: Floats
    good: npt.NDArray[np.bool_]

    @property
    def cavity(self) -> Cavity:
        """The cavity with these numbers."""
        return Cavity(self.b.value, self.friction.value, self.tilt.value, self.touch.value)

    def spread(self, slopes: dict[str, float]) -> float:
        """Return the standard uncertainty of a quantity that depends on some of the estimates with given slopes."""
        slope = np.array([slopes.get(name, 0.0) for name in _NAMES])
        return float(np.sqrt(slope @ self.covariance @ slope))


def fit_momentum(
    jumps: Jumps,
    draws: Jumps,
    side: Floats,
    course: Course,
    *,
    mu: Uncertain | None,
    b: Uncertain,
    touch: Uncertain,
    friction: Uncertain,
    tilt: Uncertain,
    usable: npt.NDArray[np.bool_] | None = None,
    swap: Jumps | None = None,
) -> MomentumFit:
    """Solve dv1 = -mu (v2_after - v2_before) for mu, b, tilt and touch, with what is known of them beforehand.

    Parameters
    ----------
    jumps, draws : Jumps
        State of the oscillator at the impacts, and draws of it.
    side : ndarray, shape (K,)
    course : Course
    mu : Uncertain or None
        From weighing; None if it is to be found by momentum alone.
    b : Uncertain
        From a gauge [m].
    touch : Uncertain
        Centroid of the force of a contact after the touch [s].
    friction, tilt : Uncertain
        Of the ball [m/s^2]. Momentum hardly sees friction where flights are equally long: it slows the ball before one
        impact as after the one before.
    usable : ndarray of bool, shape (K - 2,), optional
        Impacts to use at most.
    swap : Jumps, optional
        As of `JumpFit`; without it jumps and forced response are taken as they were fitted.

    Notes
    -----
    Gauss–Newton on the weighted residuals and on the differences from what is known; residuals beyond five times
    their spread are set aside. With sides that only alternate mu and b are nearly degenerate (mu ~ 1/b), so one of
    them must be known: mu weighed gives b, b gauged gives mu. A sensor that is not quite linear has another gain where
    the ball hits one end than where it hits the other; unaccounted for, that would look like a tilt. And it swaps a
    part of the forced response for jumps that repeat: momentum tells how much where impacts are of several kinds.
    """
    value = {"mu": 0.01, "b": b.value, "friction": friction.value, "tilt": tilt.value, "touch": touch.value}
    value |= {"skew": 0.0, "bow": 0.0, "swap": 0.0, "turn": 0.0}
    # What momentum sees of friction is that and such a deceleration.
    seems = _U_VELOCITY * 2 * b.value / float(np.median(np.diff(jumps.t))) ** 2
    seen = combined(friction.value, friction.u, seems)
    known = {
        "b": b,
        "friction": seen,
        "tilt": tilt,
        "touch": touch,
        "skew": Uncertain(0.0, _SKEW),
        "bow": Uncertain(0.0, _SKEW),
    }
    known |= {name: Uncertain(0.0, SWAPPED) for name in ("swap", "turn")}

    def residual(of: Jumps, at: dict[str, float]) -> Floats:
        return _residual(of if swap is None else of.moved(swap, (at["swap"], at["turn"])), side, at, course)

    if mu is not None:
        known["mu"] = mu
    usable = np.ones(len(side) - 2, bool) if usable is None else usable
    if mu is None:
        motion = ball_motion(jumps, side, Cavity(b.value, friction.value, tilt.value, touch.value), course)
        gain = motion.v2_after - motion.v2_before
        with np.errstate(divide="ignore", invalid="ignore"):
            guess = float(np.median((-jumps.dv[1:-1] / gain)[usable]))
        value["mu"] = guess if np.isfinite(guess) and guess != 0 else 0.01
    else:
        value["mu"] = mu.value
    step = {"mu": 1e-4 * value["mu"], "b": 1e-4 * b.value, "friction": 1e-2, "tilt": 1e-3, "touch": 1e-6}
    step |= dict.fromkeys(("skew", "bow", "swap", "turn"), 1e-4)
    good = usable.copy()
    covariance = np.eye(len(_NAMES))
    u: Any = 1.0
    for _ in range(8):
        base = residual(jumps, value)
        noise = residual(draws, value)
        u = np.sqrt(np.mean((noise - base) ** 2, axis=0) + (2e-4 * np.abs(jumps.dv[1:-1])) ** 2 + 1e-12)
        scaled = base / u
        spread = max(1.0, robust_deviation(scaled[good])) if good.any() else 1.0
        good = usable & (np.abs(scaled) < _FAR * spread)
        slope = np.stack(
            [(residual(jumps, value | {n: value[n] + step[n]}) - base) / step[n] / u for n in _NAMES], axis=1
        )[good]
        normal = slope.T @ slope / spread**2
        right = -slope.T @ scaled[good] / spread**2
        for i, name in enumerate(_NAMES):
            if name in known:
                normal[i, i] += 1 / known[name].u ** 2
                right[i] += (known[name].value - value[name]) / known[name].u ** 2
        size = np.sqrt(np.diag(normal)) + 1e-300
        covariance = np.linalg.pinv(normal / np.outer(size, size)) / np.outer(size, size)
        change = covariance @ right
        for i, name in enumerate(_NAMES):
            value[name] += float(change[i])
        if np.all(np.abs(change) < 1e-4 * np.sqrt(np.diag(covariance))):
            break
    base = residual(jumps, value) / u
    found = {name: Uncertain(value[name], float(np.sqrt(covariance[i, i]))) for i, name in enumerate(_NAMES)}
    share = (friction.u / seen.u) ** 2
    rubs = combined(
        friction.value + share * (value["friction"] - friction.value),
        friction.u * float(np.sqrt(1 - share)), share * found["friction"].u,
    )  # fmt: skip
    return MomentumFit(
        found["mu"], found["b"], rubs, found["tilt"], found["touch"], (value["swap"], value["turn"]), covariance,
        misfit=base, u=u, good=good,
    )  # fmt: skip


def _residual(jumps: Jumps, side: Floats, value: dict[str, float], course: Course) -> Floats:
    motion = ball_motion(jumps, side, Cavity(value["b"], value["friction"], value["tilt"], value["touch"]), course)
    place = jumps.x[..., 1:-1] / np.abs(jumps.x).max()
    dv = jumps.dv[..., 1:-1] * (1 + value["skew"] * place + value["bow"] * (place**2 - np.mean(place**2)))
    return dv + value["mu"] * (motion.v2_after - motion.v2_before)
