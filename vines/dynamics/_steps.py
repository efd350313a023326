"""Certified steps: how far one may go along a smooth function without its reaching a level.

The derivation and its constants are in docs/dynamics.md, "Next impact, found for certain".
"""

from __future__ import annotations

import math

from vines.dynamics._jit import njit

__all__ = ["leaving_step", "quartic_root", "safe_step"]

HALVINGS = 60
"""How often a first step from a level may be halved: 2**-60 of a window is below what double precision resolves."""

UNRESOLVED = 1e-17
"""Height that is lost in the rounding of a gap near 1."""


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


@njit
def quartic_root(gap, d1, d2, d3, d4):
    """Return the root near gap/d1 of d1 h + d2 h^2/2 + d3 h^3/6 + d4 h^4/24 = gap, by Halley's iteration."""
    h = gap / d1
    for _ in range(8):
        value = h * (d1 + h * (0.5 * d2 + h * (d3 / 6.0 + h * (d4 / 24.0)))) - gap
        first = d1 + h * (d2 + h * (0.5 * d3 + h * (d4 / 6.0)))
        second = d2 + h * (d3 + h * 0.5 * d4)
        step = 2.0 * value * first / (2.0 * first * first - value * second)
        h -= step
        if abs(step) <= 1e-16 * abs(h):
            break
    return h
