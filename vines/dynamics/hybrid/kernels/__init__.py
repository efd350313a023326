"""What rooms above compile into kernels of their own: places in rows, motion between events, accelerations."""

from vines.dynamics.hybrid._advance import set_hybrid
from vines.dynamics.hybrid._flights import carry, of_row
from vines.dynamics.hybrid._layout import HYBRID_STATE, R_V3, R_X3, fill
from vines.dynamics.hybrid._series import Z, accelerations, expand_both

__all__ = [
    "HYBRID_STATE",
    "R_V3",
    "R_X3",
    "Z",
    "accelerations",
    "carry",
    "expand_both",
    "fill",
    "of_row",
    "set_hybrid",
]
