"""The ball at each impact: momentum, velocities, restitution, and which impacts contradict the rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.ball._ball import BallMotion, Cavity, Course, ball_motion
from vines.rig.ball._momentum import MomentumFit, fit_momentum
from vines.rig.ball._restitution import Restitution, restitution
from vines.rig.fit import Jumps, slide
from vines.rig.impacts import Response
from vines.rig.recording import Recording, Uncertain
from vines.rig.uncertainty import combined, robust_deviation

__all__ = ["LINEARITY", "Rebounds", "mean_restitution", "measure_rebounds", "stated", "uncalibrated"]

Floats = npt.NDArray[np.float64]

FRICTION = Uncertain(0.046, 0.06)
"""Deceleration of the ball where the laboratory did not measure it [m/s^2]: .0003 to .02 g, evenly in the logarithm;
u is more than the standard deviation of that, .05, since it is skew."""

TILT = Uncertain(0.0, 0.02)
"""Acceleration along the cavity: a tenth of a degree [m/s^2]."""

ROLLS = 0.2
"""Largest deceleration of a ball that slides on its guide [m/s^2]."""

_CENTROID = Uncertain(5.5e-5, 1.6e-5)
"""Centroid of the force of a contact of 70 to 200 us after the touch [s]."""

LINEARITY = 1.5e-3
"""Relative uncertainty of a velocity by the linearity of a displacement sensor, .1 % of its range."""

_SHORT = 2e-3
"""Restitution is not taken from impacts with a shorter flight at one side [s]."""

_MATERIAL = 0.05
"""Least misfit of momentum that contradicts, relative to the median jump: a missed or false impact leaves as much,
friction, tilt and the sensor's linearity do not."""

_DIM = 0.2
"""Largest uncertainty of a restitution that is taken, and, relative to the mean speed, of a speed that is counted."""

_OUTLIES = 6.0

_UNUSUAL = 2.5
"""Standard deviations by which friction must be more than usual for the run alone to tell it."""


@dataclass(frozen=True, slots=True, eq=False)
class Rebounds:
    """What the impacts tell about the ball; arrays are of the K - 2 impacts that have a flight on either side.

    Attributes
    ----------
    alone, joint : MomentumFit
        With mu by momentum only, and with mu as weighed.
    rubbing : Uncertain
        Friction by momentum and the forced response, whatever was known of it [m/s^2].
    course : Course
        How the ball slides and how deep it goes into the walls.
    jumps : Jumps
        Of the oscillator, after `MomentumFit.swapped`.
    motion : BallMotion
    u_r : ndarray
        Standard uncertainty of each r by the noise of the signal.
    long : ndarray of bool
        Whether both flights are long enough to tell velocities.
    contradicts : ndarray of bool
        Whether momentum, restitution or the motion on a flight beside it is not that of one ball: an impact is missing
        or false. A soft impact that tells little does not contradict.
    counted : ndarray of bool
        Whether its velocities count in means.
    measured : ndarray of bool
        Whether it is hard enough to give a restitution of its own.
    law : Restitution
        Fitted to the measured ones.
    weighed, gauge : Uncertain
        mu weighed; b by gauge, contact included [m].
    u_gain : float
        Relative standard uncertainty of the oscillator's sensor.
    """

    alone: MomentumFit
    joint: MomentumFit
    rubbing: Uncertain
    course: Course
    jumps: Jumps
    motion: BallMotion
    u_r: Floats
    long: npt.NDArray[np.bool_]
    contradicts: npt.NDArray[np.bool_]
    counted: npt.NDArray[np.bool_]
    measured: npt.NDArray[np.bool_]
    law: Restitution
    weighed: Uncertain
    gauge: Uncertain
    u_gain: float

    def length(self) -> Uncertain:
        """Return b for instantaneous impacts: in a contact that lasts the ball turns so much beyond where it touches.

        Straight lines before and after a contact meet at the centroid of its force, whatever its law. In metres of the
        oscillator's sensor: momentum compares the walls' distance with what that sensor sees.
        """
        found, speed = self.joint, float(np.median(self.course.deep))
        return combined(found.b.value + speed * found.touch.value, found.spread({"b": 1.0, "touch": speed}))

    def calibrated(self) -> tuple[Uncertain, Uncertain]:
        """Return that b in metres, and the gain of the oscillator's sensor.

        The sensor sees gain times b; of what it sees beside the gauge each takes its share.
        """
        seen, gauge = self.length(), self.gauge
        u_b = gauge.u / gauge.value
        both = np.hypot(u_b, self.u_gain)
        share = float(u_b / both) ** 2
        apart, left = seen.value / gauge.value - 1, float(u_b * self.u_gain / both)
        b, gain = gauge.value * (1 + share * apart), 1 + (1 - share) * apart
        u_seen = seen.u / seen.value
        return combined(b, b * share * u_seen, b * left), combined(gain, (1 - share) * u_seen, left)


def measure_rebounds(
    recording: Recording, response: Response, side: Floats, friction: Uncertain, rubbing: Uncertain
) -> Rebounds:
    """Find the ball's motion.

    Parameters
    ----------
    recording : Recording
        Masses, b and what is known of friction and tilt.
    response : Response
        The oscillator's motion.
    side : ndarray, shape (K,)
        +1 L, -1 R.
    friction, rubbing : Uncertain
        Of the ball, by what was known of it and the forced response, and by that alone [m/s^2].

    Raises
    ------
    RigError
        If fewer than four impacts give a restitution.
    """
    run, fit = recording.run, response.fit
    tilt = stated(run.more.get("tilt"), TILT)
    time = np.diff(fit.jumps.t)
    long = (time[:-1] > _SHORT) & (time[1:] > _SHORT)
    mu = run.m.value / run.M.value
    weighed = combined(mu, mu * run.m.u / run.m.value, mu * run.M.u / run.M.value)
    # Jumps are differences of slopes, of which the sensor's linearity makes more than of a motion.
    known = combined(mu, weighed.u, mu * LINEARITY)
    # All in metres of the oscillator's sensor, whose calibration stands between it and the gauge.
    u_gain = response.channel.u_gain
    b = combined(run.b.value, max(run.b.u, 1e-6), run.b.value * u_gain)
    course = _course(response, side, b.value)

    def solved(mass: Uncertain | None, rubs: Uncertain) -> MomentumFit:
        return fit_momentum(
            fit.jumps, fit.draws, side, course,
            mu=mass, b=b, touch=_CENTROID, friction=rubs, tilt=tilt, usable=long, swap=fit.swap,
        )  # fmt: skip

    free = solved(known, rubbing)
    if "friction" not in run.more and _contradicted(FRICTION, free.friction):
        friction = rubbing
    alone, joint = solved(None, friction), solved(known, friction)
    jumps = fit.jumps.moved(fit.swap, joint.swapped)
    motion = ball_motion(jumps, side, joint.cavity, course)
    noise = ball_motion(fit.draws.moved(fit.swap, joint.swapped), side, joint.cavity, course)
    with np.errstate(invalid="ignore"):
        u_r = np.sqrt(np.nanmean((noise.r - motion.r) ** 2, axis=0))
    u_before, u_after = noise.w_before.std(axis=0), noise.w_after.std(axis=0)
    into, out = motion.w_before * motion.side, -motion.w_after * motion.side
    shaky = ~joint.good & (np.abs(joint.misfit) * joint.u > _MATERIAL * float(np.median(np.abs(fit.jumps.dv))))
    broken = ~(fit.fair[1:-2] & fit.fair[2:-1])
    wrong = (into < -_OUTLIES * u_before) | (out < -_OUTLIES * u_after)
    fair = long & np.isfinite(motion.r) & np.isfinite(u_r)
    contradicts = long & (shaky | broken | wrong)
    told = fair & ~contradicts & (into > 0) & (u_r < _DIM)
    if np.count_nonzero(told) < 4:
        told = np.isfinite(motion.r) & np.isfinite(u_r) & (np.abs(motion.r) < 2)
    measured, law = _law(motion, u_r, told, run.run_id)
    contradicts |= told & ~measured
    speed = float(np.median(np.abs(motion.w_before[measured])))
    counted = fair & ~contradicts & (np.hypot(u_before, u_after) < _DIM * speed)
    counted = counted | measured
    gauge = combined(b.value + speed * _CENTROID.value, max(run.b.u, 1e-6), speed * _CENTROID.u)
    return Rebounds(
        alone, joint, free.friction, course, jumps, motion, u_r, long, contradicts, counted, measured, law, weighed,
        gauge, u_gain,
    )  # fmt: skip


def _contradicted(usual: Uncertain, seen: Uncertain) -> bool:
    """Say whether a run denies what is usual: a ball that rolls, for one, is slowed far more than one that slides."""
    return seen.value - usual.value > _UNUSUAL * float(np.hypot(usual.u, seen.u))


def _course(response: Response, side: Floats, b: float) -> Course:
    """Return how the ball slides on each flight and how fast it comes to each wall, by a first look at its motion."""
    fit = response.fit
    found = slide(fit.motion, fit.jumps.x - side * b)
    speed = np.abs(ball_motion(fit.jumps, side, Cavity(b)).w_before)
    middle = float(np.median(speed))
    # A Hertzian contact of speed v lasts v^(-1/5), so that the ball goes in by v^(4/5); wild speeds are misfits.
    deep = middle * np.clip(np.concatenate([[middle], speed, [middle]]) / middle, 0.0, 3.0) ** 0.8
    return Course(found.before, found.after, deep)


def _law(
    motion: BallMotion, u_r: Floats, told: npt.NDArray[np.bool_], run_id: str
) -> tuple[npt.NDArray[np.bool_], Restitution]:
    """Return which impacts obey a common law of the restitution, and the law."""
    middle = float(np.median(motion.r[told])) if told.any() else 0.5
    away = np.abs(motion.r - middle)
    spread = robust_deviation(away[told]) + 1e-3 if told.any() else 1.0
    law = None
    measured = told & (away < _OUTLIES * np.hypot(spread, u_r))
    for _ in range(2):
        if np.count_nonzero(measured) < 4:
            raise RigError(f"run {run_id!r}: no restitution can be taken from its impacts; are they those of the ball?")
        speed = np.abs(motion.w_before)
        law = restitution(motion.r[measured], u_r[measured], speed[measured], motion.side[measured])
        with np.errstate(divide="ignore", invalid="ignore"):
            away = np.abs(motion.r - law.at(speed))
        spread = robust_deviation(away[measured]) + 1e-3
        measured = told & (away < _OUTLIES * np.hypot(spread, u_r))
    assert law is not None
    return measured, law


def mean_restitution(motion: BallMotion, which: npt.NDArray[np.bool_]) -> float:
    """Return the ratio of the mean speeds after and before impact: an impact counts by its speed.

    Soft impacts, of which nobody can say how many there are in a chatter, hardly count; and noise of the speeds, which
    biases a mean of ratios, falls out of a ratio of means.
    """
    return -float(np.sum((motion.w_after * motion.side)[which]) / np.sum((motion.w_before * motion.side)[which]))


def uncalibrated(
    found: Rebounds, response: Response, side: Floats, what: Callable[[BallMotion], float]
) -> dict[str, float]:
    """Return what calibrations and the cavity leave open of a number of the ball's motion, by their cause."""
    cavity, joint, jumps, swap = found.joint.cavity, found.joint, found.jumps, response.fit.swap

    def mean(moved: Jumps, within: Cavity) -> float:
        return what(ball_motion(moved, side, within, found.course))

    here = mean(jumps, cavity)
    gain = 1 + LINEARITY
    scaled = replace(jumps, x=jumps.x * gain, v_before=jumps.v_before * gain, v_after=jumps.v_after * gain)
    late = 1e-6
    turn = 0.5 * (response.fit.motion.before(2) + response.fit.motion.after(2))
    shifted = replace(
        jumps,
        x=jumps.x + jumps.v_before * late,
        v_before=jumps.v_before + turn * late,
        v_after=jumps.v_after + turn * late,
    )
    step = {"b": 1e-6, "tilt": 1e-3, "touch": 1e-6}
    slopes = {
        name: (mean(jumps, replace(cavity, **{name: getattr(cavity, name) + size})) - here) / size
        for name, size in step.items()
    }
    slopes |= {
        name: (mean(jumps.moved(swap, by), cavity) - here) / 1e-4
        for name, by in (("swap", (1e-4, 0.0)), ("turn", (0.0, 1e-4)))
    }
    return {
        "cavity": joint.spread(slopes),
        "friction": mean(jumps, replace(cavity, friction=cavity.friction + joint.friction.u)) - here,
        "gain": mean(scaled, cavity) - here,
        "delay": 3 * (mean(shifted, cavity) - here),
    }


def stated(given: object, otherwise: Uncertain) -> Uncertain:
    """Return what a laboratory stated of a quantity, or what is taken without that."""
    if isinstance(given, dict) and {"value", "u"} <= given.keys():
        return Uncertain(float(given["value"]), max(float(given["u"]), 1e-6))
    return otherwise
