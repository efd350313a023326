"""Columns of the rows of several balls and what the kernels know of each ball, for rooms above."""

from vines.dynamics.parallel._constants import BETA, law_of_ball, of_ball
from vines.dynamics.parallel._layout import BALL, R_V2, R_X2

__all__ = ["BALL", "BETA", "R_V2", "R_X2", "law_of_ball", "of_ball"]
