"""The ball's motion from the oscillator's: sides, velocities at impact, restitution; nothing of it is measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Jumps

__all__ = ["BallMotion", "Cavity", "Course", "ball_motion"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cavity:
    """What the ball's flight depends on.

    Attributes
    ----------
    b : float
        Half the length of the cavity less the ball's radius [m].
    friction : float
        Deceleration of the ball against the cavity [m/s^2].
    tilt : float
        Acceleration of the ball by gravity, to the right [m/s^2].
    touch : float
        Centroid of the force of a contact after the touch [s].
    """

    b: float
    friction: float = 0.0
    tilt: float = 0.0
    touch: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """What a first look at the ball's motion tells of each flight and each impact.

    Attributes
    ----------
    slowed, driven : ndarray, shape (K - 1,)
        By how much friction of 1 m/s^2 lowers the velocity at the end of a flight, and raises that at its start, beside
        the mean velocity [s].
    deep : ndarray, shape (K,)
        How deep the ball goes into the wall for each second from the touch to the centroid of the force [m/s].
    """

    slowed: Floats
    driven: Floats
    deep: Floats


@dataclass(frozen=True, slots=True, eq=False)
class BallMotion:
    """Velocities at the impacts 1 … K - 2 that have a flight before and one after them; shape (..., K - 2).

    Attributes
    ----------
    side : ndarray
        +1 L, -1 R.
    x2 : ndarray, shape (..., K)
        Position of the ball at every impact [m].
    v2_before, v2_after : ndarray
        Velocity of the ball [m/s].
    w_before, w_after : ndarray
        Relative velocity w' = v1 - v2 [m/s].
    r : ndarray
        -w_after/w_before.
    """

    side: Floats
    x2: Floats
    v2_before: Floats
    v2_after: Floats
    w_before: Floats
    w_after: Floats
    r: Floats


def ball_motion(jumps: Jumps, side: Floats, cavity: Cavity, course: Course | None = None) -> BallMotion:
    """Return the ball's velocities at the impacts.

    Parameters
    ----------
    jumps : Jumps
        Of the oscillator, shape (..., K), K >= 3.
    side : ndarray, shape (K,)
        +1 L, -1 R: the sign opposite to that of the oscillator's velocity jump.
    cavity : Cavity
    course : Course, optional
        Without it a ball that crosses the cavity is slowed all the way, and one that comes back to its wall is slowed
        first and driven afterwards, so that its end velocities stay; and contacts take no time.

    Notes
    -----
    At an impact x2 = x1 - side (b + how deep the ball goes in), so the mean velocity of a flight is known; tilt and
    friction tell the end velocities from it.

    Examples
    --------
    >>> t = np.arange(4.0)
    >>> still = Jumps(t, np.zeros(4), np.zeros(4), np.zeros(4))
    >>> ball_motion(still, np.array([1.0, -1.0, 1.0, -1.0]), Cavity(0.5)).w_before
    array([-1.,  1.])
    """
    x2 = jumps.x - side * (cavity.b if course is None else cavity.b + cavity.touch * course.deep)
    time = np.diff(jumps.t, axis=-1)
    mean = np.diff(x2, axis=-1) / time
    pulled = cavity.tilt * time / 2
    across = side[:-1] * (side[:-1] != side[1:]) * time / 2
    slowed, driven = (across, across) if course is None else (course.slowed, course.driven)
    before = (mean + pulled - cavity.friction * slowed)[..., :-1]
    after = (mean - pulled + cavity.friction * driven)[..., 1:]
    w_before = jumps.v_before[..., 1:-1] - before
    w_after = jumps.v_after[..., 1:-1] - after
    with np.errstate(divide="ignore", invalid="ignore"):
        r = -w_after / w_before
    return BallMotion(side[1:-1], x2, before, after, w_before, w_after, r)
