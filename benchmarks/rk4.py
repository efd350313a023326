"""The paper's method as a peer: Runge–Kutta of fourth order, the step halved before a wall until the gap is 1e-9."""

from __future__ import annotations

import math

from vines.kernels import njit

__all__ = ["rk4_run"]


@njit
def _rate(A, Omega, lam, x, v, t, phase):
    angle = Omega * t + phase
    return A * math.sin(angle) + lam * Omega * A * math.cos(angle) - lam * v - x


@njit
def _step(A, Omega, lam, x, v, t, phase, h):
    a1 = _rate(A, Omega, lam, x, v, t, phase)
    v2 = v + 0.5 * h * a1
    a2 = _rate(A, Omega, lam, x + 0.5 * h * v, v2, t + 0.5 * h, phase)
    v3 = v + 0.5 * h * a2
    a3 = _rate(A, Omega, lam, x + 0.5 * h * v2, v3, t + 0.5 * h, phase)
    v4 = v + h * a3
    a4 = _rate(A, Omega, lam, x + h * v3, v4, t + h, phase)
    return x + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


@njit
def rk4_run(mu, A, Omega, r, lam, x1, v1, x2, v2, phase, stop, parts, speeds):
    """Run to `stop` with `parts` steps a period; put |w'| of each impact into `speeds` and return their number."""
    h0 = 2.0 * math.pi / Omega / parts
    t = 0.0
    impacts = 0
    while t < stop:
        h = h0
        while True:
            xn, vn = _step(A, Omega, lam, x1, v1, t, phase, h)
            bn = x2 + v2 * h
            over = abs(xn - bn) - 1.0
            if over <= 0.0 or h < 1e-16:
                break
            if over <= 1e-9:
                break
            h *= 0.5
        x1, v1, x2 = xn, vn, bn
        t += h
        w = x1 - x2
        if 1.0 - abs(w) <= 1e-9 and w * (v1 - v2) > 0.0:
            closing = v1 - v2
            if impacts < speeds.shape[0]:
                speeds[impacts] = abs(closing)
            impacts += 1
            v1 -= mu * (1.0 + r) / (1.0 + mu) * closing
            v2 += (1.0 + r) / (1.0 + mu) * closing
    return impacts
