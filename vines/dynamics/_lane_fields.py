"""The layout of the lanes: one flat array, a field of all lanes after the other.

LLVM vectorises a loop over lanes only if it can prove that no store changes what another lane loads; with all fields in
one array at constant distances of at least the length of a vector it can.
"""

from __future__ import annotations

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
GROW5 = 9 * STRIDE
FORCED5 = 10 * STRIDE
WINDOW = 11 * STRIDE
LIMIT = 12 * STRIDE
NEAR = 13 * STRIDE
CORRECTION = 14 * STRIDE
HEIGHT = 15 * STRIDE
PERIOD = 16 * STRIDE

# State: homogeneous part of the oscillator, unit phasor of the forcing, ball, time left.
X_FREE = 17 * STRIDE
V_FREE = 18 * STRIDE
COS = 19 * STRIDE
SIN = 20 * STRIDE
BALL = 21 * STRIDE
SPEED = 22 * STRIDE
LEFT = 23 * STRIDE

# Bookkeeping of the search: next move; the fifth derivative at the start of the flight and a bound for all its time;
# polishing ticks so far, the wall aimed at, what is left of its bracket and how far the lane has gone in it.
MOVE = 24 * STRIDE
FREE5 = 25 * STRIDE
MOST5 = 26 * STRIDE
POLISH = 27 * STRIDE
SIDE = 28 * STRIDE
REACH = 29 * STRIDE
GONE = 30 * STRIDE

# Since the last event: time, the wall it was on, whether it was a release, impacts in a row on that wall.
TAU = 31 * STRIDE
WALL = 32 * STRIDE
RELEASED = 33 * STRIDE
CHAIN = 34 * STRIDE

# Events of the running period and when it began; impacts in all; the lane waits for the scalar kernel.
BUSY = 35 * STRIDE
BEGAN = 36 * STRIDE
IMPACTS = 37 * STRIDE
WAITS = 38 * STRIDE

# Within a tick: the way to the root, whether it is certain, whether it is so near that Taylor's polynomial is exact.
ROOT = 39 * STRIDE
AIMED = 40 * STRIDE
CLOSE = 41 * STRIDE

# The impact of this tick, if there was one: its flag, the length of the flight before it, velocities just before.
HIT = 42 * STRIDE
FLIGHT = 43 * STRIDE
BEFORE1 = 44 * STRIDE
BEFORE2 = 45 * STRIDE

# Constants of the measures (see `fill_measures`): force and 1/(i Omega - s) at phase 0, the base's velocity in units of
# the force, 1/|s + i Omega|^2, loss of an impact in units of w'^2, the time recorded.
G_RE = 46 * STRIDE
G_IM = 47 * STRIDE
E_RE = 48 * STRIDE
E_IM = 49 * STRIDE
B_RE = 50 * STRIDE
B_IM = 51 * STRIDE
SUM2 = 52 * STRIDE
LOSS = 53 * STRIDE
LENGTH = 54 * STRIDE

# The segment whose measures are taken at the next impact: oscillator, phasor, time since the last event at its start.
FROM_X = 55 * STRIDE
FROM_V = 56 * STRIDE
FROM_COS = 57 * STRIDE
FROM_SIN = 58 * STRIDE
FROM_TAU = 59 * STRIDE

# Is the lane's time recorded; time left at the end of the running part; does the scalar kernel have to take the whole
# segment (1) or look for its largest displacement (2); may the segment hold a new largest displacement.
RECORDED = 60 * STRIDE
PART_ENDS = 61 * STRIDE
MEND = 62 * STRIDE
SEEK = 63 * STRIDE

# Totals of the running part, in the order of `vines.dynamics._totals`.
PART = 64 * STRIDE

# The number 1 (see `vines.dynamics._lane_motion.kept`).
UNIT = (64 + 15) * STRIDE

# Within a tick: may the ball that has struck be about to stick.
MERGES = (64 + 16) * STRIDE

# Square of the steady amplitude over |i Omega - s|: its rounding is that of the integral of |u|^2.
LARGE = (64 + 17) * STRIDE

SIZE = (64 + 18) * STRIDE
