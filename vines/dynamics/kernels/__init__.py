"""What rooms above compile into kernels of their own: constants, flight, impact, events, energies, tangent maps.

Two modules stand here by name: `rows` for the columns of rows of events and of a run's state, `totals` for those of
energy totals.
"""

from vines.dynamics import _advance as rows
from vines.dynamics import _totals as totals
from vines.dynamics._advance import advance, begin, pass_over, set_state, shift_time, state_now
from vines.dynamics._batches import KNOWN_CORRELATION, spread_of_mean
from vines.dynamics._constants import (
    Constants,
    ParameterTable,
    constants_at,
    constants_kernel,
    oscillator,
)
from vines.dynamics._contact import CONTACT
from vines.dynamics._flight import (
    ball_flown,
    derivatives,
    drift,
    flight,
    fourth_bound,
    free_ball,
    launched,
    phasors,
    pull,
    rate_alone,
    relative,
    ringing,
    speed_terms,
    turn,
)
from vines.dynamics._impact_law import (
    after_impact,
    after_impact_kernel,
    impact_law,
    impact_law_kernel,
    reversing,
    reversing_kernel,
)
from vines.dynamics._integrals import largest_displacement, segment_integrals
from vines.dynamics._room import Room, Slopes, constants, room_of, table_of
from vines.dynamics._saltation import jacobian_kernel
from vines.dynamics._scatter_table import colour_at
from vines.dynamics._sticking import next_release
from vines.dynamics._tangent import (
    carry_basis,
    directions,
    flow_basis,
    jump_basis,
    lyapunov_blocks,
    offset,
    tangent_product,
)
from vines.dynamics._totals import ball_mass, segment_state, window_totals
from vines.dynamics._travel import accelerations
from vines.dynamics._window import open_window, run_window, width_of, with_room

__all__ = [
    "CONTACT",
    "KNOWN_CORRELATION",
    "Constants",
    "ParameterTable",
    "Room",
    "Slopes",
    "accelerations",
    "advance",
    "after_impact",
    "after_impact_kernel",
    "ball_flown",
    "ball_mass",
    "begin",
    "carry_basis",
    "colour_at",
    "constants",
    "constants_at",
    "constants_kernel",
    "derivatives",
    "directions",
    "drift",
    "flight",
    "flow_basis",
    "fourth_bound",
    "free_ball",
    "impact_law",
    "impact_law_kernel",
    "jacobian_kernel",
    "jump_basis",
    "largest_displacement",
    "launched",
    "lyapunov_blocks",
    "next_release",
    "offset",
    "open_window",
    "oscillator",
    "pass_over",
    "phasors",
    "pull",
    "rate_alone",
    "relative",
    "reversing",
    "reversing_kernel",
    "ringing",
    "room_of",
    "rows",
    "run_window",
    "segment_integrals",
    "segment_state",
    "set_state",
    "shift_time",
    "speed_terms",
    "spread_of_mean",
    "state_now",
    "table_of",
    "tangent_product",
    "totals",
    "turn",
    "width_of",
    "window_totals",
    "with_room",
]
