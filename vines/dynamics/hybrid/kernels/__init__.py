"""What rooms above compile into kernels of their own: places in rows, motion between events, accelerations."""

from vines.dynamics.hybrid._layout import R_V3, R_X3

__all__ = ["R_V3", "R_X3"]
