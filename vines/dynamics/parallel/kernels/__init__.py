"""Columns of the rows of several balls and what the kernels know of each ball, for rooms above."""

from vines.dynamics.parallel._constants import BETA, frame_with, law_of_ball, of_ball
from vines.dynamics.parallel._layout import (
    B_DECIDE,
    B_RELEASED,
    B_V2,
    B_WALL,
    B_X2,
    BALL,
    R_V2,
    R_X2,
    at,
)

__all__ = [
    "BALL",
    "BETA",
    "B_DECIDE",
    "B_RELEASED",
    "B_V2",
    "B_WALL",
    "B_X2",
    "R_V2",
    "R_X2",
    "at",
    "frame_with",
    "law_of_ball",
    "of_ball",
]
