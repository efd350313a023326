"""Is a whole move free of contact: a proof from the motion at its two ends (docs/dynamics.md, "Lanes")."""

from __future__ import annotations

from vines.dynamics import _lane_fields as f
from vines.dynamics._lane_motion import forced_motion
from vines.kernels import fused_njit, loop_njit

__all__ = ["MARGIN", "certify", "stays_inside"]

LANES = f.LANES

MARGIN = 1e-14
"""What rounding changes of a coefficient at most, in units of 1 + |z| + |q|: 31 roundings, see docs/dynamics.md."""


@fused_njit
def stays_inside(tau, w0, v0, a0, j0, w1, v1, a1, j1, most8, inside):
    """Say whether it is certain that |w| < 1 all along a move of length tau, at whose ends |w| <= 1.

    The coefficients are those of the two-point Hermite polynomial of w in Bernstein's form; its remainder widens the
    middle one of degree eight only.

    Parameters
    ----------
    w0, v0, a0, j0, w1, v1, a1, j1 : float
        w and three derivatives at the start and at the end.
    most8 : float
        Bound of the eighth derivative.
    inside : float
        What coefficients must stay below: less than 1 by what rounding may have changed.
    """
    p0 = (1 / 7) * tau * v0
    p1 = (1 / 7) * tau * v1
    square = tau * tau
    q0 = (1 / 42) * square * a0
    q1 = (1 / 42) * square * a1
    cube = (1 / 210) * square * tau
    b1 = w0 + p0
    b2 = b1 + (p0 + q0)
    b3 = w0 + (3.0 * (p0 + q0) + cube * j0)
    b4 = w1 - (3.0 * (p1 - q1) + cube * j1)
    b6 = w1 - p1
    b5 = b6 - (p1 - q1)
    fourth = square * square
    middle = abs(0.5 * (b3 + b4)) + (1 / 2822400) * most8 * fourth * fourth
    near_start = (abs(b1) < inside) & (abs(b2) < inside) & (abs(b3) < inside)
    near_end = (abs(b4) < inside) & (abs(b5) < inside) & (abs(b6) < inside)
    return near_start & near_end & (middle < inside)


@loop_njit
def certify(L):
    """Say of every lane whether its move is certified, and then whether it ends at an impact."""
    for i in range(LANES):
        omega = L[f.OMEGA + i]
        omega2 = omega * omega
        lam = L[f.LAM + i]
        q_re = L[f.Q_RE + i]
        q_im = L[f.Q_IM + i]
        speed = L[f.SPEED + i]
        ball = L[f.BALL + i]
        step = L[f.STEP + i]
        most = L[f.AMPLITUDE + i]
        xh = L[f.X_FREE + i]
        vh = L[f.V_FREE + i]
        xq, _, vq = forced_motion(q_re, q_im, omega, L[f.COS + i], L[f.SIN + i])
        ah = -lam * vh - xh
        jh = -lam * ah - vh
        w0 = (xh + xq) - ball
        v0 = (vh + vq) - speed
        a0 = ah - omega2 * xq
        j0 = jh - omega2 * vq
        xh = L[f.END_X + i]
        vh = L[f.END_V + i]
        xq, _, vq = forced_motion(q_re, q_im, omega, L[f.END_COS + i], L[f.END_SIN + i])
        ah = -lam * vh - xh
        jh = -lam * ah - vh
        w1 = (xh + xq) - (ball + speed * step)
        v1 = (vh + vq) - speed
        a1 = ah - omega2 * xq
        j1 = jh - omega2 * vq
        inside = L[f.MARGIN + i] - MARGIN * most
        certain = stays_inside(step, w0, v0, a0, j0, w1, v1, a1, j1, most + L[f.FORCED8 + i], inside)
        certain = certain & (step >= 0.0) & (L[f.LEFT + i] > step) & (L[f.WAITS + i] == 0.0)
        close = L[f.CLOSE + i] > 0.0
        L[f.HIT + i] = 1.0 if certain & close else 0.0
        L[f.CLEAR + i] = 1.0 if certain & (not close) & (abs(w1) < inside) else 0.0
