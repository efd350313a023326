"""The ball's motion from the oscillator's: sides, velocities at impact, restitution; nothing of it is measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig._jumps import Jumps

__all__ = ["BallMotion", "Cavity", "ball_motion"]

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
    """

    b: float
    friction: float = 0.0
    tilt: float = 0.0


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


def ball_motion(jumps: Jumps, side: Floats, cavity: Cavity) -> BallMotion:
    """Return the ball's velocities at the impacts.

    Parameters
    ----------
    jumps : Jumps
        Of the oscillator, shape (..., K), K >= 3.
    side : ndarray, shape (K,)
        +1 L, -1 R: the sign opposite to that of the oscillator's velocity jump.
    cavity : Cavity

    Notes
    -----
    At an impact x2 = x1 - side b, so the mean velocity of a flight is known. Friction and tilt are constant
    accelerations to a good approximation: a flight from wall to wall is slowed all the way, one that comes back to its
    wall is slowed first and driven afterwards, which leaves its mean and, to first order, its end velocities.

    Examples
    --------
    >>> t = np.arange(4.0)
    >>> still = Jumps(t, np.zeros(4), np.zeros(4), np.zeros(4))
    >>> ball_motion(still, np.array([1.0, -1.0, 1.0, -1.0]), Cavity(0.5)).w_before
    array([-1.,  1.])
    """
    x2 = jumps.x - side * cavity.b
    time = np.diff(jumps.t, axis=-1)
    mean = np.diff(x2, axis=-1) / time
    across = side[:-1] * (side[:-1] != side[1:])
    push = (cavity.tilt - cavity.friction * across) * time / 2
    before, after = (mean + push)[..., :-1], (mean - push)[..., 1:]
    w_before = jumps.v_before[..., 1:-1] - before
    w_after = jumps.v_after[..., 1:-1] - after
    with np.errstate(divide="ignore", invalid="ignore"):
        r = -w_after / w_before
    return BallMotion(side[1:-1], x2, before, after, w_before, w_after, r)
