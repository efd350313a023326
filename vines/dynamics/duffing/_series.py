"""Series of the frame and of the gap, in flight and while the ball rides; that of x1² stands for that of w²."""

from __future__ import annotations

from vines.dynamics._sincos import sincos
from vines.dynamics.duffing._constants import DuffingField
from vines.dynamics.taylor.kernels import (
    DIRECTIONS,
    DISTURBED,
    LENGTH,
    W,
    X,
    at,
    coefficients,
    cube,
    expand,
    expand_disturbances,
    reach,
    slopes,
    times_square,
)
from vines.kernels import fused_njit, loop_njit

__all__: list[str] = []


@expand.register(DuffingField)
@loop_njit
def _expand(f, x, v, w, u, phase):
    a = coefficients(f)
    lam, alpha, inverse, free = f.lam, f.alpha, f.inverse, f.free
    a[X], a[X + 1], a[W], a[W + 1] = x, v, w, u
    sine, cosine = sincos(phase)
    force = f.A * (sine + lam * f.Omega * cosine)
    later = f.A * f.Omega * (cosine - lam * f.Omega * sine)
    turn = f.Omega * f.Omega
    for k in range(f.order - 1):
        share = 1.0 / ((k + 1.0) * (k + 2.0))
        own = inverse * (force - lam * (k + 1) * a[X + k + 1] - a[X + k] - alpha * cube(a, X, k))
        a[X + k + 2] = share * own
        a[W + k + 2] = free * share * own
        force, later = later, -share * turn * force
    return reach(a, f.order, W, max(abs(x), abs(v), abs(w), abs(u), f.A), f.longest)


@slopes.register(DuffingField)
@fused_njit
def _slopes(f, x, v, w, u, phase):
    sine, cosine = sincos(phase)
    return f.A * (sine + f.lam * f.Omega * cosine) - f.lam * v - x - f.alpha * x * x * x, 0.0


@expand_disturbances.register(DuffingField)
@loop_njit
def _expand_disturbances(f, h, Y):
    a = coefficients(f)
    order = f.order
    for j in range(Y.shape[1]):
        dx = DISTURBED + 2 * LENGTH * (j % DIRECTIONS)
        dw = dx + LENGTH
        a[dx], a[dx + 1], a[dw], a[dw + 1] = Y[0, j], Y[1, j], Y[2, j], Y[3, j]
        for k in range(order - 1):
            share = 1.0 / ((k + 1.0) * (k + 2.0))
            push = f.lam * (k + 1) * a[dx + k + 1] + a[dx + k] + 3.0 * f.alpha * times_square(a, dx, k)
            own = -f.inverse * push
            a[dx + k + 2] = share * own
            a[dw + k + 2] = f.free * share * own
        Y[0, j], Y[1, j] = at(a, dx, order, h)
        Y[2, j], Y[3, j] = at(a, dw, order, h)
