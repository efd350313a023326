"""What happens at one instant: balls hit, perhaps together, and those that ride on a wall are struck or left behind.

Balls that arrive together are struck by the law of all of them at once, ``dv1 = -sum mu_i (1 + r_i) w_i' / (1 + sum
mu_i)`` and ``w_i' -> -r_i w_i'``, or one after the other where the state says so. One that arrives while others ride on
the other wall has its own impact first; they are struck then, all at once, with the velocity that it has given the
frame. Those on its own wall are left behind.
"""

from __future__ import annotations

from vines.dynamics._advance import IMPACT, RELEASE, RUN, S_DECIDE, S_IMPACTS, S_MODE, S_V1
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics.parallel._constants import MU, R, law_of_ball, of_ball
from vines.dynamics.parallel._layout import (
    B_DECIDE,
    B_MODE,
    B_RELEASED,
    B_RUN,
    B_RUN_SIDE,
    B_STEP,
    B_V2,
    B_WALL,
    S_IN_TURN,
    S_TIES,
    at,
)
from vines.dynamics.parallel._rows import count_riding, write
from vines.kernels import fused_njit, linked_njit, rounded_once

__all__ = ["PASSES", "strike", "strike_alone"]

PASSES = 32
"""Times in one instant that balls may be struck until none approaches its wall any more."""


@fused_njit
def _count_hit(state, i, wall):
    """Count an impact of a ball in its chatter."""
    if wall != state[at(i, B_RUN_SIDE)] or state[at(i, B_RELEASED)] != 0.0:
        state[at(i, B_RUN)] = 0.0
    state[at(i, B_RUN)] += 1.0
    state[at(i, B_RUN_SIDE)] = wall
    state[at(i, B_RELEASED)] = 0.0


@fused_njit
def strike_alone(c, state, i, tau, rows, count):
    """Let one ball hit at the present instant, while no other is on a wall; return how many rows there are then."""
    wall, before, v2 = state[at(i, B_STEP)], state[S_V1], state[at(i, B_V2)]
    law = law_of_ball(c.each, i)
    # As the compiler rounds `after_impact_kernel` for the VI-NES: one ball is the VI-NES to the last bit.
    state[S_V1] = rounded_once(law.pass1, v2, law.keep1 * before)
    state[at(i, B_V2)] = rounded_once(law.keep2, v2, law.pass2 * before)
    state[S_IMPACTS] += 1.0
    _count_hit(state, i, wall)
    state[at(i, B_WALL)] = wall
    state[at(i, B_DECIDE)] = state[S_DECIDE] = 1.0
    write(c.balls, rows[count], state, IMPACT, wall, tau, i, before, v2, 0.0, 0.0)
    return count + 1


@linked_njit
def strike(c, state, hits, tau, rows, count):
    """Let balls hit at the present instant, and write what happens.

    Parameters
    ----------
    c : ParallelConstants
    state : ndarray
        At the instant, before the first impact; B_STEP holds the wall of each ball that hits.
    hits : int
        Their set.
    tau : float
        Time since the row before.
    rows, count
        Room for what is written, and how much there is.

    Returns
    -------
    (count, whole)
        Whether no ball approached a wall any more when PASSES was reached.
    """
    n = c.balls
    arrived = 0
    for i in range(n):
        if hits & (1 << i):
            state[at(i, B_WALL)] = state[at(i, B_STEP)]
            arrived += 1
    if arrived > 1:
        state[S_TIES] += 1.0
    now = hits
    modes = state[S_MODE]
    for _ in range(PASSES):
        if state[S_IN_TURN] != 0.0:
            # Had they come one after the other, those that ride would have been struck between two of them.
            now = now & ~hits if now & ~hits else now & -now
        together = 0
        momentum, mass, only = 0.0, 1.0, 0
        before = state[S_V1]
        for i in range(n):
            if now & (1 << i):
                together += 1
                only = i
                momentum += of_ball(c.each, i, MU) * (1.0 + of_ball(c.each, i, R)) * (before - state[at(i, B_V2)])
                mass += of_ball(c.each, i, MU)
        after = before - momentum / mass
        if together == 1:
            after, _ = after_impact_kernel(law_of_ball(c.each, only), before, state[at(only, B_V2)])
        state[S_V1] = after
        group = now if together > 1 else 0
        for i in range(n):
            if now & (1 << i):
                wall, v2 = state[at(i, B_WALL)], state[at(i, B_V2)]
                if together == 1:
                    _, state[at(i, B_V2)] = after_impact_kernel(law_of_ball(c.each, i), before, v2)
                else:
                    state[at(i, B_V2)] = after + of_ball(c.each, i, R) * (before - v2)
                state[S_IMPACTS] += 1.0
                _count_hit(state, i, wall)
                state[at(i, B_MODE)] = 0.0
                count_riding(c.balls, state)
                state[at(i, B_DECIDE)] = state[S_DECIDE] = 1.0
                others = arrived - 1.0 if hits & (1 << i) else together - 1.0
                write(c.balls, rows[count], state, IMPACT, wall, tau, i, before, v2, others, modes)
                rows[count, RUN] = group
                group = -abs(group)
                tau, modes = 0.0, 0.0
                count += 1
        now = 0
        for i in range(n):
            wall = state[at(i, B_WALL)]
            if wall != 0.0 and wall * (state[S_V1] - state[at(i, B_V2)]) > 0.0:
                now |= 1 << i
        if now == 0:
            break
    for i in range(n):
        wall = state[at(i, B_MODE)]
        if wall != 0.0 and wall * (state[S_V1] - state[at(i, B_V2)]) < 0.0:
            # The frame was kicked away from under it.
            state[at(i, B_MODE)] = 0.0
            # It may have been so little that it rides on.
            state[at(i, B_DECIDE)] = state[S_DECIDE] = 1.0
            count_riding(c.balls, state)
            write(c.balls, rows[count], state, RELEASE, wall, 0.0, i, state[S_V1], state[at(i, B_V2)], 0.0, modes)
            count += 1
    return count, now == 0
