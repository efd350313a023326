"""The ball's motion from the oscillator's: momentum, velocities at the impacts, restitution."""

from vines.rig.ball._ball import BallMotion, Cavity, ball_motion
from vines.rig.ball._momentum import SWAPPED, MomentumFit
from vines.rig.ball._rebound import (
    FRICTION,
    LINEARITY,
    ROLLS,
    TILT,
    Rebounds,
    mean_restitution,
    measure_rebounds,
    stated,
    uncalibrated,
)

__all__ = [
    "FRICTION",
    "LINEARITY",
    "ROLLS",
    "SWAPPED",
    "TILT",
    "BallMotion",
    "Cavity",
    "MomentumFit",
    "Rebounds",
    "ball_motion",
    "mean_restitution",
    "measure_rebounds",
    "stated",
    "uncalibrated",
]
