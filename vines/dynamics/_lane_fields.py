"""The layout of the lanes: one flat array, a field of all lanes after the other.

LLVM vectorises a loop over lanes only if it can prove that no store changes what another lane loads; with all fields in
one array at constant distances of at least the length of a vector it can.
"""

from __future__ import annotations

__all__ = ["LANES"]

LANES = 64
"""Lanes that run side by side: eight vectors of eight doubles, and all fields of all lanes stay in the first cache."""

# Parameters of the lane: oscillator, forcing, impact law, bounds.
HALF = 0 * LANES
GAMMA = 1 * LANES
INVERSE = 2 * LANES
OMEGA = 3 * LANES
LAM = 4 * LANES
PASS1 = 5 * LANES
PASS2 = 6 * LANES
Q_RE = 7 * LANES
Q_IM = 8 * LANES
FORCED5 = 9 * LANES
WINDOW = 10 * LANES
NEAR = 11 * LANES
CORRECTION = 12 * LANES
PERIOD = 13 * LANES

# State: homogeneous part of the oscillator, unit phasor of the forcing, ball, time left.
X_FREE = 14 * LANES
V_FREE = 15 * LANES
COS = 16 * LANES
SIN = 17 * LANES
BALL = 18 * LANES
SPEED = 19 * LANES
LEFT = 20 * LANES

# Bookkeeping of the search: next move, bound of the free part, polishing steps so far, the wall aimed at, what is
# left of its bracket and how far the move has gone in it.
MOVE = 21 * LANES
FREE5 = 22 * LANES
POLISH = 23 * LANES
SIDE = 24 * LANES
REACH = 25 * LANES
GONE = 26 * LANES

# Since the last event: time, the wall it was on, whether it was a release, impacts in a row on that wall.
TAU = 27 * LANES
WALL = 28 * LANES
RELEASED = 29 * LANES
CHAIN = 30 * LANES

# Events of the running period and when it began; impacts in all; the lane waits for the scalar kernel.
BUSY = 31 * LANES
BEGAN = 32 * LANES
IMPACTS = 33 * LANES
WAITS = 34 * LANES

# The impact of this tick, if there was one: its flag, the length of the flight before it, velocities just before.
HIT = 35 * LANES
FLIGHT = 36 * LANES
BEFORE1 = 37 * LANES
BEFORE2 = 38 * LANES

SIZE = 39 * LANES
