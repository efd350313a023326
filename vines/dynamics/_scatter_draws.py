"""What is drawn for the pieces of a run with scatter, so many at once: held forces, coloured ones, turns of the phase.

Everything is a function of the seed, the stream and the number of the piece: a run may go back, and draws are the same.
"""

from __future__ import annotations

import math

from vines.dynamics._random import fill_normals, normal
from vines.dynamics._scatter_constants import AHEAD, COLOURS, COSINES, DRAWS, FIRST, SINES, TURNS
from vines.dynamics._sincos import sincos
from vines.kernels import doubles_at, linked_njit

__all__ = ["coloured_at", "fill"]

HELD = 1
"""Series of draws for held forces; impact j takes number 2 j, held force n number 2 n + 1."""

PHASE, NODES, HALVES = 1 << 40, 2 << 40, 3 << 40
"""Numbers of the first draws for turns of the phase, for the coloured force at given times, and for its halves."""

STEPS = AHEAD // 2
"""Steps of the coloured force in what is drawn at once."""


@linked_njit
def _node(c, low, high, gap, step):
    """Return the coloured force half-way between two times, given what it is there; `gap` steps lie to each side."""
    share = math.exp(-gap * c.colour.rate)
    less = -math.expm1(-2.0 * gap * c.colour.rate)
    spread = c.colour.size * math.sqrt(less / (1.0 + share * share))
    return share / (1.0 + share * share) * (low + high) + spread * normal(c.key, c.stream, NODES + step)


@linked_njit
def _later(c, now, gap, step):
    """Return the coloured force `gap` steps later."""
    less = -math.expm1(-2.0 * gap * c.colour.rate)
    return math.exp(-gap * c.colour.rate) * now + c.colour.size * math.sqrt(less) * normal(
        c.key, c.stream, NODES + step
    )


@linked_njit
def coloured_at(c, step):
    """Return the coloured force after so many steps, a multiple of STEPS.

    From its begin on the times are doubled until the step is passed, and then halved between the last two: a Gaussian
    process without memory but its value is known at a time between two others from these alone.
    """
    begun = c.colour.begun
    low = c.colour.size * normal(c.key, c.stream, NODES) if math.isnan(begun) else begun
    if step == 0:
        return low
    at, gap = 0, STEPS
    high = _later(c, low, gap, gap)
    while at + gap < step:
        # The times 0, 1, 2, 4, 8, … of STEPS.
        low, at = high, at + gap
        gap = at
        high = _later(c, low, gap, at + gap)
    if at + gap == step:
        return high
    while True:
        gap //= 2
        middle = _node(c, low, high, gap, at + gap)
        if at + gap == step:
            return middle
        if at + gap < step:
            low, at = middle, at + gap
        else:
            high = middle


@linked_njit
def _fill_colours(c, first):
    """Fill the coloured force at the begins of the steps from piece `first` on."""
    step = first // 2
    values = doubles_at(c.room + 8 * COLOURS, STEPS + 1)
    values[0], values[STEPS] = coloured_at(c, step), coloured_at(c, step + STEPS)
    gap = STEPS
    while gap > 1:
        half = gap // 2
        for k in range(0, STEPS, gap):
            values[k + half] = _node(c, values[k], values[k + gap], half, step + k + half)
        gap = half


@linked_njit
def fill(c, index):
    """Draw what pieces need from the multiple of AHEAD on in which `index` lies."""
    room = doubles_at(c.room, DRAWS)
    first = int(index) // AHEAD * AHEAD
    room[FIRST] = first
    forces = doubles_at(c.room + 8 * DRAWS, AHEAD)
    if c.noise > 0.0:
        fill_normals(c.key, c.stream, 2 * first + HELD, 2, forces)
    for k in range(AHEAD):
        forces[k] = c.noise * forces[k] if c.noise > 0.0 else 0.0
    if c.colour.size > 0.0:
        _fill_colours(c, first)
        y, size, n = doubles_at(c.room + 8 * COLOURS, STEPS + 1), c.colour.size, c.colour
        for k in range(STEPS):
            g = size * normal(c.key, c.stream, HALVES + first + 2 * k)
            h = size * normal(c.key, c.stream, HALVES + first + 2 * k + 1)
            forces[2 * k] += n.p11 * y[k] + n.p12 * y[k + 1] + n.l11 * g
            forces[2 * k + 1] += n.p21 * y[k] + n.p22 * y[k + 1] + n.l21 * g + n.l22 * h
    if c.diffusion > 0.0:
        turns = doubles_at(c.room + 8 * TURNS, AHEAD)
        cosines, sines = doubles_at(c.room + 8 * COSINES, AHEAD), doubles_at(c.room + 8 * SINES, AHEAD)
        fill_normals(c.key, c.stream, PHASE + first, 1, turns)
        for k in range(AHEAD):
            turns[k] *= c.diffusion
            sines[k], cosines[k] = sincos(turns[k])
