"""Columns of the rows of several balls, for rooms above: the number of the ball, and where all balls are."""

from vines.dynamics.parallel._layout import BALL, R_V2, R_X2

__all__ = ["BALL", "R_V2", "R_X2"]
