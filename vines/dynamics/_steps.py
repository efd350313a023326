"""Certified steps: how far one may go along a smooth function without its reaching a level, and where it surely does.

A level lies at the height `gap` over a function with derivatives d1, d2, d3, d4 and a bound of the fifth. The
derivations and constants are in docs/dynamics.md, "Next impact, found for certain". What has no branch is shared by
the scalar kernel and the lanes.
"""

from __future__ import annotations

import math

from vines.kernels import fused_njit, njit

__all__ = ["leaving_step", "only_root", "safe_step", "step_ahead", "step_back", "taylor_root"]

HALVINGS = 60
"""How often a first step from a level may be halved: 2**-60 of a window is below what double precision resolves."""

UNRESOLVED = 1e-17
"""Height that is lost in the rounding of a gap near 1."""


@fused_njit
def step_ahead(gap, pace, d2, d3, d4, fifth, span):
    """Return h <= span before whose end a function that rises at `pace` >= 0 does not reach the level."""
    bend = d2 + span * ((1 / 3) * max(d3, 0.0) + span * ((1 / 12) * max(d4, 0.0) + span * ((1 / 60) * fifth)))
    root = pace * pace + 2.0 * bend * gap
    forth = 2.0 * gap / (pace + math.sqrt(max(root, 0.0)))
    never = (root < 0.0) | ((pace <= 0.0) & (bend <= 0.0))
    return span if never else min(span, forth)


@fused_njit
def step_back(gap, pace, d2, d3, d4, fifth, span):
    """Return h <= span before whose end a function that falls at `pace` >= 0 does not reach the level."""
    bend = d2 + span * ((1 / 3) * max(d3, 0.0) + span * ((1 / 12) * max(d4, 0.0) + span * ((1 / 60) * fifth)))
    root = pace * pace + 2.0 * bend * gap
    back = (math.sqrt(max(root, 0.0)) + pace) / bend
    return min(span, back) if bend > 0.0 else span


@fused_njit
def certain_ways(gap, behind, pace, d2, d3, d4, fifth, window):
    """Return (forth, back), times up to `window` before which a moving ball is certain not to meet either wall.

    Parameters
    ----------
    gap, behind : float
        Distances from the wall that it moves to and from that behind it, at least 0.
    pace, d2, d3, d4 : float
        Its velocity and further derivatives against the frame, towards the wall ahead.
    fifth : float
        Bound of the fifth derivative.
    window : float
    """
    span = min(window, 1.5 * gap / pace) if pace > 0.0 else window
    forth = step_ahead(gap, pace, d2, d3, d4, fifth, span)
    back = step_back(behind, pace, -d2, -d3, -d4, fifth, window)
    h = min(forth, back)
    if h < 0.25 * window:
        # Over a shorter span the curvature is bounded more closely.
        span = 2.0 * h
        forth = max(forth, step_ahead(gap, pace, d2, d3, d4, fifth, span))
        back = max(back, step_back(behind, pace, -d2, -d3, -d4, fifth, span))
    return forth, back


@fused_njit
def only_root(gap, d1, d2, d3, d4, fifth, reach):
    """Say whether a rising function is certain to reach the level exactly once in [0, reach]."""
    rising = d1 + reach * (
        min(d2, 0.0) + reach * (0.5 * min(d3, 0.0) + reach * ((1 / 6) * min(d4, 0.0) - reach * ((1 / 24) * fifth)))
    )
    arrives = reach * (
        d1 + reach * (0.5 * d2 + reach * ((1 / 6) * d3 + reach * ((1 / 24) * d4 - reach * ((1 / 120) * fifth))))
    )
    return (d1 > 0.0) & (reach >= 0.0) & (rising > 0.0) & (arrives >= gap)


@fused_njit
def taylor_root(gap, d1, d2, d3, d4, d5, d6):
    """Return (h, last correction) of two of Halley's steps to the root of the Taylor polynomial nearest to 0."""
    h = 2.0 * gap * d1 / (2.0 * d1 * d1 + d2 * gap)
    value = h * (
        d1 + h * (0.5 * d2 + h * ((1 / 6) * d3 + h * ((1 / 24) * d4 + h * ((1 / 120) * d5 + h * ((1 / 720) * d6)))))
    )
    value -= gap
    first = d1 + h * (d2 + h * (0.5 * d3 + h * ((1 / 6) * d4 + h * ((1 / 24) * d5 + h * ((1 / 120) * d6)))))
    second = d2 + h * (d3 + h * (0.5 * d4 + h * ((1 / 6) * d5 + h * ((1 / 24) * d6))))
    correction = 2.0 * value * first / (2.0 * first * first - value * second)
    return h - correction, correction


@njit
def safe_step(gap, slope, curvature, window):
    """Return h <= window with slope h' + curvature h'^2/2 <= gap for every h' in [0, h]; gap >= 0."""
    discriminant = slope * slope + 2.0 * curvature * gap
    if discriminant < 0.0:
        return window
    if slope >= 0.0:
        reach = slope + math.sqrt(discriminant)
        if reach <= 0.0:
            return 0.0 if curvature > 0.0 else window
        return min(2.0 * gap / reach, window)
    if curvature <= 0.0:
        return window
    return min((math.sqrt(discriminant) - slope) / curvature, window)


@njit
def leaving_step(speed, second, third, bound, window):
    """Return a step from the level itself, left at `speed` >= 0, over which the level is not reached again.

    The height over the level is at most h (-speed + second h/2 + third h^2/6 + bound h^3/24).
    """
    rising = max(third, 0.0)
    best = 0.0
    if second <= 0.0 and third < 0.0:
        best = min(window, -4.0 * third / bound) if bound > 0.0 else window
    for _ in range(HALVINGS):
        curvature = second + rising * window / 3.0 + bound * window * window / 12.0
        if curvature * window <= 2.0 * speed:
            return max(best, window)
        best = max(best, 2.0 * speed / curvature)
        if best >= 0.5 * window:
            return best
        window *= 0.5
    return max(best, _unresolved_step(second, rising, bound))


@njit
def _unresolved_step(second, third, bound):
    """Return a step over which the height cannot rise by more than double precision resolves.

    It is needed only where speed, second and third derivative all vanish, so that no sign tells where the motion goes.
    """
    h = 1e-3
    if second > 0.0:
        h = min(h, math.sqrt(2.0 * UNRESOLVED / second))
    if third > 0.0:
        h = min(h, (6.0 * UNRESOLVED / third) ** (1.0 / 3.0))
    if bound > 0.0:
        h = min(h, (24.0 * UNRESOLVED / bound) ** 0.25)
    return h
