"""Given its flight times an orbit is a linear problem (docs/orbits.md, "All orbits of a word").

The impact law determines the kicks from the forced response Q = a + ib at the first impact, and the momentum balance
leaves N equations that are linear in (a, b, 1). A symmetric orbit is described by its first half, which closes on its
own mirror image: `flip` is then -1 and the span half the period.
"""

from __future__ import annotations

import cmath
import math

from vines.kernels import linked_njit, new_matrix, new_vector, njit
from vines.orbits._elimination import eliminate

__all__ = ["defects_kernel", "linear_kernel", "sample_kernel", "start_kernel"]


@linked_njit
def linear_kernel(c, span, flip, side, tau, R):
    """Fill R, shape (N, 3), with the momentum balance as rows over (a, b, 1); return the factor that clears its poles.

    Parameters
    ----------
    c : vines.dynamics._constants.Constants
    span : float
        Sum of the flight times: the period, or half of it.
    flip : int
        +1 if the orbit closes after the span, -1 if its mirror image does.
    side : (N,) int array
    tau : (N,) float array
        Flight times, the last back to the first impact (or its mirror image).
    R : (N, 3) float array

    Returns
    -------
    float
        The determinant of the impact law times the flight times between opposite walls: minors of R times it are
        entire functions of the flight times.
    """
    N = tau.size
    gamma = c.free.gamma
    s = complex(-c.free.half, gamma)
    around = cmath.exp(s * span)
    weight = 1.0 / (1.0 - flip * around)
    # Rows over the kicks and (a, b, 1): oscillator, its velocity, and the ball after each impact.
    rows = new_matrix(3 * N + 1, N + 3)
    x, v, ball = rows[: N + 1], rows[N + 1 : 2 * N + 1], rows[2 * N + 1 :]
    t = 0.0
    times = new_vector(N)
    for j in range(N):
        times[j] = t
        t += tau[j]
    for j in range(N):
        angle = c.Omega * times[j]
        cosine, sine = math.cos(angle), math.sin(angle)
        x[j, N], x[j, N + 1], x[j, N + 2] = cosine, -sine, 0.0
        v[j, N], v[j, N + 1], v[j, N + 2] = -c.Omega * sine, -c.Omega * cosine, 0.0
        for k in range(N):
            if j == k:
                kernel = flip * weight * around
            elif j > k:
                kernel = weight * cmath.exp(s * (times[j] - times[k]))
            else:
                kernel = flip * weight * cmath.exp(s * (times[j] - times[k] + span))
            x[j, k] = kernel.imag / gamma
            v[j, k] = (s * kernel).imag / gamma
    for k in range(N + 3):
        x[N, k] = flip * x[0, k]
    factor = 1.0
    for j in range(N):
        step = (flip * side[0] if j == N - 1 else side[j + 1]) - side[j]
        for k in range(N + 3):
            ball[j, k] = (x[j + 1, k] - x[j, k]) / tau[j]
        if step != 0:
            ball[j, N + 2] -= step / tau[j]
            factor *= tau[j]
    mu, e = c.law.ratio, c.law.pass1
    law = new_matrix(N, N)
    kicks = new_matrix(N, 3)
    for j in range(N):
        b, sign = (j - 1, 1.0) if j > 0 else (N - 1, float(flip))
        for k in range(N):
            law[j, k] = e * (v[j, k] - sign * ball[b, k])
        law[j, j] += 1.0
        for k in range(3):
            kicks[j, k] = -e * (v[j, N + k] - sign * ball[b, N + k])
    factor *= eliminate(law, kicks)[1]
    for j in range(N):
        b, sign = (j - 1, 1.0) if j > 0 else (N - 1, float(flip))
        for m in range(3):
            R[j, m] = mu * (ball[j, N + m] - sign * ball[b, N + m]) + kicks[j, m]
            for k in range(N):
                R[j, m] += mu * (ball[j, k] - sign * ball[b, k]) * kicks[k, m]
    return factor


@njit
def _cross(R, i, j):
    """Return the cross product of two rows: the null vector (a, b, 1) of both, up to its length."""
    return (
        R[i, 1] * R[j, 2] - R[i, 2] * R[j, 1],
        R[i, 2] * R[j, 0] - R[i, 0] * R[j, 2],
        R[i, 0] * R[j, 1] - R[i, 1] * R[j, 0],
    )


@linked_njit
def defects_kernel(c, span, flip, side, tau, divide, out):
    """Fill `out` with functions of the flight times that all vanish on an orbit at the amplitude of c.

    For N = 2 one: |Q|² less the square of the forced response, cleared of denominators. For N = 3 four: the determinant
    of the three equations, and the former from each pair of them. All are divided by `divide`, a common zero.
    """
    N = tau.size
    R = new_matrix(N, 3)
    factor = linear_kernel(c, span, flip, side, tau, R) / divide
    B2 = c.free.qr**2 + c.free.qi**2
    if N == 2:
        za, zb, z1 = _cross(R, 0, 1)
        out[0] = factor * factor * (za * za + zb * zb - B2 * z1 * z1)
    else:
        for k in range(3):
            za, zb, z1 = _cross(R, (k + 1) % 3, (k + 2) % 3)
            out[1 + k] = factor * factor * (za * za + zb * zb - B2 * z1 * z1)
            if k == 0:
                out[0] = factor * (R[0, 0] * za + R[0, 1] * zb + R[0, 2] * z1)


@linked_njit
def sample_kernel(c, span, flip, side, halves, low, width, nodes, out):
    """Sample `defects_kernel` on boxes of the unit interval (N = 2) or square (N = 3).

    With coordinates y in a box, the flight times are span (y, 1 - y), or span (y0, (1 - y0) y1, (1 - y0) (1 - y1)).

    Parameters
    ----------
    c, span, flip, side
        As for `linear_kernel`.
    halves : bool
        Whether to divide by (1/2 - y), where all functions of a 1:1/pT word with odd p have a zero for symmetry.
    low : (M, N - 1) float array
        Lower corners of the boxes.
    width : float
    nodes : (K,) float array
        Nodes in (0, 1), the same in each direction.
    out : (M, F, K) or (M, F, K, K) float array, flattened to (M, K**(N - 1), F)
    """
    N = side.size
    K = nodes.size
    tau = new_vector(N)
    # Two flights between opposite walls that are short together make all functions vanish.
    opposite = N == 3 and side[1] != side[2] and side[2] != flip * side[0]
    for m in range(low.shape[0]):
        if N == 2:
            for i in range(K):
                y = low[m, 0] + width * nodes[i]
                tau[0], tau[1] = span * y, span * (1.0 - y)
                defects_kernel(c, span, flip, side, tau, 0.5 - y if halves else 1.0, out[m, i])
        else:
            for i in range(K):
                y = low[m, 0] + width * nodes[i]
                for j in range(K):
                    u = low[m, 1] + width * nodes[j]
                    tau[0], tau[1], tau[2] = span * y, span * (1.0 - y) * u, span * (1.0 - y) * (1.0 - u)
                    defects_kernel(c, span, flip, side, tau, 1.0 - y if opposite else 1.0, out[m, i * K + j])


@linked_njit
def start_kernel(c, span, flip, side, tau):
    """Return the time of the first impact that fits the flight times best, for a forcing of phase zero at t = 0.

    The phase is that of the (a, b) with the least squared defect of the N equations.
    """
    N = tau.size
    R = new_matrix(N, 3)
    linear_kernel(c, span, flip, side, tau, R)
    aa = ab = bb = a1 = b1 = 0.0
    for j in range(N):
        aa += R[j, 0] * R[j, 0]
        ab += R[j, 0] * R[j, 1]
        bb += R[j, 1] * R[j, 1]
        a1 -= R[j, 0] * R[j, 2]
        b1 -= R[j, 1] * R[j, 2]
    det = aa * bb - ab * ab
    sign = 1.0 if det >= 0.0 else -1.0
    angle = math.atan2(sign * (aa * b1 - ab * a1), sign * (bb * a1 - ab * b1)) - math.atan2(c.free.qi, c.free.qr)
    return (angle % (2.0 * math.pi)) / c.Omega
