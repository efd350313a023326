"""The layout of the lanes: one flat array, a field of all lanes after the other.

LLVM vectorises a loop over lanes only if it can prove that no store changes what another lane loads; with all fields in
one array at constant distances of at least the length of a vector it can.
"""

from __future__ import annotations

from vines.dynamics._totals import TOTALS

__all__ = ["LANES", "SIZE", "STRIDE"]

LANES = 64
"""Lanes that run side by side: eight vectors of eight doubles, and all fields of all lanes stay in the first cache."""

STRIDE = LANES + 8
"""Distance of two fields: not a power of two, so that fields do not lie at equal places of 4 KB pages."""

# Parameters of the lane: oscillator, forcing, impact law, bounds.
HALF = 0 * STRIDE
GAMMA = 1 * STRIDE
INVERSE = 2 * STRIDE
OMEGA = 3 * STRIDE
LAM = 4 * STRIDE
PASS1 = 5 * STRIDE
PASS2 = 6 * STRIDE
Q_RE = 7 * STRIDE
Q_IM = 8 * STRIDE
FORCED8 = 9 * STRIDE
MARGIN = 10 * STRIDE
LIMIT = 11 * STRIDE
NEAR = 12 * STRIDE
CORRECTION = 13 * STRIDE
HEIGHT = 14 * STRIDE
PERIOD = 15 * STRIDE

# State where the certified part of the flight ends: homogeneous part of the oscillator, unit phasor of the forcing,
# ball, time left; and a bound of the free amplitude for the whole flight.
X_FREE = 16 * STRIDE
V_FREE = 17 * STRIDE
COS = 18 * STRIDE
SIN = 19 * STRIDE
BALL = 20 * STRIDE
SPEED = 21 * STRIDE
LEFT = 22 * STRIDE
AMPLITUDE = 23 * STRIDE

# Bookkeeping of the search: next move; how many of this flight were not certified; the last two flights and a mean of
# many; is the next one not likely to be as long as that before the last.
MOVE = 24 * STRIDE
TRIES = 25 * STRIDE
LAST = 26 * STRIDE
ONE_BEFORE = 27 * STRIDE
USUAL = 28 * STRIDE
ROUGH = 29 * STRIDE

# Since the last event: time, the wall it was on, whether it was a release, impacts in a row on that wall.
TAU = 30 * STRIDE
WALL = 31 * STRIDE
RELEASED = 32 * STRIDE
CHAIN = 33 * STRIDE

# Events of the running period and when it began; impacts in all; the lane waits for the scalar kernel.
BUSY = 34 * STRIDE
BEGAN = 35 * STRIDE
IMPACTS = 36 * STRIDE
WAITS = 37 * STRIDE

# The impact of this tick, if there was one: its flag, the length of the flight before it, velocities just before.
HIT = 38 * STRIDE
FLIGHT = 39 * STRIDE
BEFORE1 = 40 * STRIDE
BEFORE2 = 41 * STRIDE

# Within a tick: where the move ends; the wall aimed at, the rest of the way to the contact; how long the move was.
END_X = 42 * STRIDE
END_V = 43 * STRIDE
END_COS = 44 * STRIDE
END_SIN = 45 * STRIDE
SIDE = 46 * STRIDE
ROOT = 47 * STRIDE
AHEAD = 48 * STRIDE
STEP = 49 * STRIDE

# Is the move's end a contact; is the move certified though it is none.
CLOSE = 50 * STRIDE
CLEAR = 51 * STRIDE

# Constants of the measures (see `fill_measures`): force and 1/(i Omega - s) at phase 0, the base's velocity in units of
# the force, 1/|s + i Omega|^2, loss of an impact in units of w'^2, the time recorded.
G_RE = 52 * STRIDE
G_IM = 53 * STRIDE
E_RE = 54 * STRIDE
E_IM = 55 * STRIDE
B_RE = 56 * STRIDE
B_IM = 57 * STRIDE
SUM2 = 58 * STRIDE
LOSS = 59 * STRIDE
LENGTH = 60 * STRIDE

# The segment whose measures are taken at the next impact: oscillator, phasor, time since the last event at its start.
FROM_X = 61 * STRIDE
FROM_V = 62 * STRIDE
FROM_COS = 63 * STRIDE
FROM_SIN = 64 * STRIDE
FROM_TAU = 65 * STRIDE

# Is the lane's time recorded; time left at the end of the running part; does the scalar kernel have to take the whole
# segment (1) or look for its largest displacement (2); may the segment hold a new largest displacement.
RECORDED = 66 * STRIDE
PART_ENDS = 67 * STRIDE
MEND = 68 * STRIDE
SEEK = 69 * STRIDE

# Totals of the running part, in the order of `vines.dynamics._totals`.
PART = 70 * STRIDE

# The number 1 (see `vines.dynamics._lane_motion.kept`).
UNIT = PART + TOTALS * STRIDE

# Square of the steady amplitude over |i Omega - s|: its rounding is that of the integral of |u|^2.
LARGE = UNIT + STRIDE

SIZE = LARGE + STRIDE
