"""One step of the series of frame and mass: ``m x1'' = F - lam x1' - x1 - mu_n f``, ``z'' = x1'' - f``.

``f = k1 z + k3 z³ + l2 z'`` with z = x1 - x3, and m = 1, or 1 + mu while the ball rides on a wall. The ball in flight
goes straight, so that its gap has the coefficients of x1 but for the first two.
"""

from __future__ import annotations

from vines.dynamics._sincos import sincos
from vines.dynamics.taylor._constants import LENGTH
from vines.dynamics.taylor._series import DISTURBED, W, X, at, coefficients, cube, rate, reach, times_square
from vines.kernels import fused_njit, loop_njit

__all__ = ["PUSH", "Z", "accelerations", "disturb", "expand_both"]

Z, PUSH, DISTURBANCES = DISTURBED, DISTURBED + LENGTH, DISTURBED + 2 * LENGTH
"""Where the series of z stands in the room, that of x1'' while the ball rides, those of disturbances of x1 and z."""

PAIRS = 3
"""Disturbances for which there is room at once."""


@loop_njit
def expand_both(f, load, x, v, w, u, z, y, phase):
    """Fill the room with the series of x1, w and z from a state, and return how long the step may be.

    Parameters
    ----------
    f : SpringField
    load : float
        Mass that rides on a wall, 0 in flight.
    x, v, w, u, z, y, phase : float
        x1, x1', w, w', z, z' and the phase of the forcing.
    """
    a = coefficients(f)
    mu_n, lam, k1, k3, l2 = f.mu_n, f.lam, f.k1, f.k3, f.l2
    a[X], a[X + 1], a[W], a[W + 1], a[Z], a[Z + 1] = x, v, w, u, z, y
    sine, cosine = sincos(phase)
    force = f.A * (sine + lam * f.Omega * cosine)
    later = f.A * f.Omega * (cosine - lam * f.Omega * sine)
    turn = f.Omega * f.Omega
    lighter = 1.0 / (1.0 + load)
    flies = 1.0 if load == 0.0 else 0.0
    for k in range(f.order - 1):
        spring = k1 * a[Z + k] + k3 * cube(a, Z, k) + l2 * (k + 1) * a[Z + k + 1]
        own = lighter * (force - lam * (k + 1) * a[X + k + 1] - a[X + k] - mu_n * spring)
        share = 1.0 / ((k + 1.0) * (k + 2.0))
        a[X + k + 2] = share * own
        a[W + k + 2] = flies * share * own
        a[Z + k + 2] = share * (own - spring)
        force, later = later, -share * turn * force
    return reach(a, f.order, Z, max(abs(x), abs(v), abs(z), abs(y), f.A), f.longest)


@fused_njit
def accelerations(f, load, x, v, z, y, phase):
    """Return x1'' and x3'' at a state."""
    sine, cosine = sincos(phase)
    spring = rate(f, z, y)
    return (f.A * (sine + f.lam * f.Omega * cosine) - f.lam * v - x - f.mu_n * spring) / (1.0 + load), spring


@loop_njit
def disturb(f, load, h, Y):
    """Carry disturbances of (x1, x1', …, z, z'), the columns of Y, over h of the step that the room holds.

    z and z' are the last two; what stands between is left as it is.
    """
    a = coefficients(f)
    order = f.order
    lighter = 1.0 / (1.0 + load)
    last = Y.shape[0] - 2
    for j in range(Y.shape[1]):
        dx = DISTURBANCES + 2 * LENGTH * (j % PAIRS)
        dz = dx + LENGTH
        a[dx], a[dx + 1], a[dz], a[dz + 1] = Y[0, j], Y[1, j], Y[last, j], Y[last + 1, j]
        for k in range(order - 1):
            spring = f.k1 * a[dz + k] + 3.0 * f.k3 * times_square(a, dz, k) + f.l2 * (k + 1) * a[dz + k + 1]
            own = lighter * (-f.lam * (k + 1) * a[dx + k + 1] - a[dx + k] - f.mu_n * spring)
            share = 1.0 / ((k + 1.0) * (k + 2.0))
            a[dx + k + 2] = share * own
            a[dz + k + 2] = share * (own - spring)
        Y[0, j], Y[1, j] = at(a, dx, order, h)
        Y[last, j], Y[last + 1, j] = at(a, dz, order, h)
