"""Columns of the rows of several modes, and what begins their motion, for rooms above."""

from vines.dynamics.modes._constants import GAMMA, LAM, PHI, STIFFNESS, of_mode
from vines.dynamics.modes._energies import of_row
from vines.dynamics.modes._jet import modal_at
from vines.dynamics.modes._layout import BALL, BEFORE, R_MODAL
from vines.dynamics.modes._motion import kick, note
from vines.dynamics.modes._structure import oscillator_at

__all__ = [
    "BALL", "BEFORE", "GAMMA", "LAM", "PHI", "R_MODAL", "STIFFNESS", "kick", "modal_at", "note", "of_mode", "of_row",
    "oscillator_at",
]  # fmt: skip
