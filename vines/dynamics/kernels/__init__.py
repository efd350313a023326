"""What rooms above compile into kernels of their own: constants, flight, impact, events, energies, tangent maps.

Two modules stand here by name: `rows` for the columns of rows of events and of a run's state, `totals` for those of
energy totals.
"""

from vines.dynamics import _advance as rows
from vines.dynamics import _totals as totals
from vines.dynamics._advance import advance, begin, pass_over, set_state, shift_time, state_now
from vines.dynamics._batches import BATCHES, close_batch, standard_errors
from vines.dynamics._constants import Constants, constants, constants_kernel, oscillator
from vines.dynamics._flight import derivatives, fourth_bound, phasors, turn
from vines.dynamics._impact_law import (
    after_impact,
    after_impact_kernel,
    impact_law,
    impact_law_kernel,
    reversing,
    reversing_kernel,
)
from vines.dynamics._integrals import largest_displacement, segment_integrals
from vines.dynamics._saltation import jacobian_kernel
from vines.dynamics._tangent import flow_basis, jump_basis, lyapunov_blocks, tangent_product
from vines.dynamics._totals import window_totals
from vines.dynamics._window import open_window, run_window, with_room

__all__ = [
    "BATCHES",
    "Constants",
    "advance",
    "after_impact",
    "after_impact_kernel",
    "begin",
    "close_batch",
    "constants",
    "constants_kernel",
    "derivatives",
    "flow_basis",
    "fourth_bound",
    "impact_law",
    "impact_law_kernel",
    "jacobian_kernel",
    "jump_basis",
    "largest_displacement",
    "lyapunov_blocks",
    "open_window",
    "oscillator",
    "pass_over",
    "phasors",
    "reversing",
    "reversing_kernel",
    "rows",
    "run_window",
    "segment_integrals",
    "set_state",
    "shift_time",
    "standard_errors",
    "state_now",
    "tangent_product",
    "totals",
    "turn",
    "window_totals",
    "with_room",
]
