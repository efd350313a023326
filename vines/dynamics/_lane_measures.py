"""Energies and largest displacement of a flight, in all lanes at once, when its impact has come.

The energies are those of `vines.dynamics._integrals`. For the largest displacement it is shown that the phase of
u' turns one way all along the flight, so that signs of v1 at its ends tell how often v1 vanishes between them
(docs/dynamics.md, "Lanes"). What does not fit raises the flag MEND; the scalar kernel then does it.
"""

from __future__ import annotations

import math

from vines.dynamics import _lane_fields as f
from vines.dynamics import _totals as entry
from vines.dynamics._integrals import base_per_force, quadratic_forms
from vines.dynamics._lane_motion import MOST_DECAY, MOST_TURN, flow, forced_motion, free_derivatives, kept
from vines.dynamics._steps import taylor_root
from vines.kernels import fused_njit, linked_njit, loop_njit

__all__ = ["MEND_PEAK", "lane_energies", "lane_peak", "measure", "open_measures", "renew"]

LANES = f.LANES
STRIDE = f.STRIDE

MEND_PEAK = 2.0
"""Value of the flag MEND where only the largest displacement is left to do; 1 stands for all."""

NEAR_PEAK = 0.02
"""Longest last step to a zero of v1: over it the seventh derivative changes x1 by less than a rounding."""

FINE = 45_000.0
"""Largest ratio of LARGE to the integral of |u|^2, which in lanes is then right to 5e-12 of itself; beyond, near
resonance, the scalar kernel integrates in the turning frame.
"""

STEADY = 0.5
"""Largest share of the forcing in the turning of u' with which the search does without the scalar kernel."""

PI = 3.141592653589793


@fused_njit
def _mean_decay(y):
    """Return (1 - exp(-y))/y for 0 <= y <= 2 MOST_DECAY: Taylor at an eighth of it, doubled three times."""
    w = 0.125 * y
    m = 1.0 / 720.0 - w * (1.0 / 5040.0 - w * (1.0 / 40320.0 - w * (1.0 / 362880.0)))
    m = 1.0 - w * (1.0 / 2.0 - w * (1.0 / 6.0 - w * (1.0 / 24.0 - w * (1.0 / 120.0 - w * m))))
    # The mean over twice the time is the mean of m and of m exp(-w).
    for _ in range(3):
        m = m * (1.0 - 0.5 * w * m)
        w = 2.0 * w
    return m


@fused_njit
def _turned(a, b):
    """Return roughly (within .002) the angle of (b, a), a > 0, between 0 and pi."""
    t = b / (a + abs(b))
    n = abs(t)
    arc = t * (1.04528186 + n * (0.31046019 + n * (4.02424667 - n * (6.36215009 - n * 2.55405198))))
    return 0.5 * PI - arc


@linked_njit
def open_measures(c, L, i, length, x1):
    """Put what the measures of a run need into a lane: constants, and a part that begins at displacement x1."""
    o = c.free
    base = base_per_force(o, c.Omega, c.lam)
    L[f.G_RE + i], L[f.G_IM + i] = o.gr, o.gi
    L[f.E_RE + i], L[f.E_IM + i] = o.er, o.ei
    L[f.B_RE + i], L[f.B_IM + i] = base.real, base.imag
    L[f.SUM2 + i] = 1.0 / (o.c2r * o.c2r + o.c2i * o.c2i)
    L[f.LOSS + i] = 0.5 * c.mu / (1.0 + c.mu) * (1.0 - c.r * c.r)
    L[f.LARGE + i] = (o.qr * o.qr + o.qi * o.qi) / math.hypot(o.dr, o.di)
    L[f.LENGTH + i] = length
    for k in range(entry.TOTALS):
        L[f.PART + k * STRIDE + i] = 0.0
    L[f.PART + entry.MAX_ABS_X1 * STRIDE + i] = abs(x1)
    L[f.RECORDED + i] = 1.0
    L[f.MEND + i] = 0.0


@fused_njit
def lane_energies(L, i):
    """Add the energies of a flight that has ended in this tick, and say where its peak may be a new largest."""
    half = L[f.HALF + i]
    gamma = L[f.GAMMA + i]
    inverse = L[f.INVERSE + i]
    omega = L[f.OMEGA + i]
    lam = L[f.LAM + i]
    g = complex(L[f.G_RE + i], L[f.G_IM + i])
    e = complex(L[f.E_RE + i], L[f.E_IM + i])
    cosine = L[f.COS + i]
    sine = L[f.SIN + i]
    from_x = L[f.FROM_X + i]
    v2 = L[f.BEFORE2 + i]
    v1 = L[f.BEFORE1 + i]
    left = L[f.LEFT + i]
    length = L[f.FLIGHT + i] - L[f.FROM_TAU + i]
    g0 = g * complex(L[f.FROM_COS + i], L[f.FROM_SIN + i])
    g1 = g * complex(cosine, sine)
    xq, _, _ = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, cosine, sine)
    x1 = L[f.X_FREE + i] + xq
    u0 = complex(from_x, (g0.real - half * from_x - L[f.FROM_V + i]) * inverse)
    u1 = complex(x1, (g1.real - half * x1 - v1) * inverse)
    # The integrals of u conj(G) and |u|^2 from the free part and the steady response.
    q0 = g0 * e
    q1 = g1 * e
    z0 = u0 - q0
    z1 = u1 - q1
    cross = (z0 * q0.conjugate() - z1 * q1.conjugate()) * e
    free = (z0.real * z0.real + z0.imag * z0.imag) * length * _mean_decay(lam * length)
    straight = (g0.real * g0.real + g0.imag * g0.imag) * length
    ug = (straight - (u1 * g1.conjugate() - u0 * g0.conjugate())) * e
    uu = free + 2.0 * cross.real + (q0.real * q0.real + q0.imag * q0.imag) * length
    base = complex(L[f.B_RE + i], L[f.B_IM + i])
    xx, vv, work, loss = quadratic_forms(
        half, gamma, 1.0, omega, lam, L[f.SUM2 + i], base, u0, g0, u1, g1, ug, uu, length
    )
    closing = v1 - v2
    lost = L[f.LOSS + i] * closing * closing
    ended = (L[f.HIT + i] > 0.0) & (L[f.RECORDED + i] > 0.0)
    plain = ended & (left >= L[f.PART_ENDS + i]) & (lam * length <= 2.0 * MOST_DECAY) & (L[f.LARGE + i] <= FINE * uu)
    on_left = plain & (L[f.WALL + i] > 0.0)
    on_right = plain & (L[f.WALL + i] < 0.0)
    L[f.PART + entry.DURATION * STRIDE + i] += length if plain else 0.0
    L[f.PART + entry.X1_SQUARE * STRIDE + i] += xx if plain else 0.0
    L[f.PART + entry.V1_SQUARE * STRIDE + i] += vv if plain else 0.0
    L[f.PART + entry.V2_SQUARE * STRIDE + i] += v2 * v2 * length if plain else 0.0
    L[f.PART + entry.BASE_WORK * STRIDE + i] += work if plain else 0.0
    L[f.PART + entry.DAMPER_LOSS * STRIDE + i] += loss if plain else 0.0
    L[f.PART + entry.LOSS_LEFT * STRIDE + i] += lost if on_left else 0.0
    L[f.PART + entry.LOSS_RIGHT * STRIDE + i] += lost if on_right else 0.0
    L[f.PART + entry.IMPACTS_LEFT * STRIDE + i] += 1.0 if on_left else 0.0
    L[f.PART + entry.IMPACTS_RIGHT * STRIDE + i] += 1.0 if on_right else 0.0

    # The end itself; then a bound of all in between: |u| leaves the chord of u exp(-i Omega t) only so far.
    best = kept(L[f.PART + entry.MAX_ABS_X1 * STRIDE + i], L[f.UNIT + i])
    when = kept(L[f.PART + entry.T_MAX_ABS_X1 * STRIDE + i], L[f.UNIT + i])
    higher = plain & (abs(x1) > best)
    best = abs(x1) if higher else best
    L[f.PART + entry.MAX_ABS_X1 * STRIDE + i] = best
    L[f.PART + entry.T_MAX_ABS_X1 * STRIDE + i] = L[f.LENGTH + i] - left if higher else when
    detuning = complex(half, omega - gamma)
    rate = g0 - detuning * u0
    bulge = (abs(detuning.real) + abs(detuning.imag)) * (abs(rate.real) + abs(rate.imag)) * length * length
    below = best - 0.125 * bulge
    here = max(u0.real * u0.real + u0.imag * u0.imag, u1.real * u1.real + u1.imag * u1.imag)
    seek = plain & (not ((below > 0.0) & (here <= below * below)))
    L[f.SEEK + i] = 1.0 if seek else 0.0
    L[f.MEND + i] = 1.0 if ended & (not plain) else 0.0


@fused_njit
def lane_peak(L, i):
    """Find the zero of v1 of a flight that may hold a new largest displacement."""
    half = L[f.HALF + i]
    gamma = L[f.GAMMA + i]
    inverse = L[f.INVERSE + i]
    omega = L[f.OMEGA + i]
    lam = L[f.LAM + i]
    q_re = L[f.Q_RE + i]
    q_im = L[f.Q_IM + i]
    c1 = L[f.COS + i]
    s1 = L[f.SIN + i]
    c0 = L[f.FROM_COS + i]
    s0 = L[f.FROM_SIN + i]
    left = L[f.LEFT + i]
    length = L[f.FLIGHT + i] - L[f.FROM_TAU + i]
    v0 = L[f.FROM_V + i]
    v1 = L[f.BEFORE1 + i]
    xq0, _, vq0 = forced_motion(q_re, q_im, omega, c0, s0)
    xq1, _, vq1 = forced_motion(q_re, q_im, omega, c1, s1)
    xh0 = L[f.FROM_X + i] - xq0
    xh1 = L[f.X_FREE + i]
    vh0 = v0 - vq0
    vh1 = v1 - vq1
    # Im u' at both ends: that of s z, and that of the steady response.
    w0 = gamma * xh0 + half * (vh0 + half * xh0) * inverse + omega * xq0
    w1 = gamma * xh1 + half * (vh1 + half * xh1) * inverse + omega * xq1
    # |u'| is nowhere below `least`; its phase turns at gamma to within force/least, forward if that is less.
    size0 = 0.9238 * (max(abs(v0), abs(w0)) + 0.4142 * min(abs(v0), abs(w0)))
    size1 = 0.9238 * (max(abs(v1), abs(w1)) + 0.4142 * min(abs(v1), abs(w1)))
    force = omega * (abs(L[f.G_RE + i]) + abs(L[f.G_IM + i]))
    least = 0.5 * (size0 * (1.0 - half * length) + size1 - force * length)
    steady = force <= STEADY * gamma * least
    turning = length * (gamma * least + force)
    crosses = ((v0 > 0.0) & (v1 < 0.0)) | ((v0 < 0.0) & (v1 > 0.0))
    stays = ((v0 > 0.0) & (v1 > 0.0)) | ((v0 < 0.0) & (v1 < 0.0))
    # The angle from the start to the next zero, and from the end: the phase turns almost evenly between them.
    first = _turned(abs(v0), w0 if v0 > 0.0 else -w0)
    rest = _turned(abs(v1), w1 if v1 > 0.0 else -w1)
    once = steady & (turning < 6.28 * least)
    one = once & crosses
    none = once & (not crosses) & ((turning < 3.14 * least) | (stays & (first > rest + 0.01)))
    h = length * first / (first + (PI - rest))
    late = h + h > length
    xh = xh1 if late else xh0
    vh = vh1 if late else vh0
    cosine = c1 if late else c0
    sine = s1 if late else s0
    step = h - length if late else h
    fits = (omega * abs(step) <= MOST_TURN) & (abs(step) <= MOST_TURN) & (half * abs(step) <= MOST_DECAY)
    step = step if fits else 0.0
    xh, vh, cosine, sine = flow(half, gamma, inverse, omega, xh, vh, cosine, sine, step)
    xq, _, vq = forced_motion(q_re, q_im, omega, cosine, sine)
    ah, jh, kh, lh, mh = free_derivatives(lam, xh, vh)
    omega2 = omega * omega
    aq = -omega2 * xq
    jq = -omega2 * vq
    kq = -omega2 * aq
    lq = -omega2 * jq
    x = xh + xq
    v = vh + vq
    a = ah + aq
    j = jh + jq
    k = kh + kq
    fifth = lh + lq
    sixth = mh - omega2 * kq
    h, correction = taylor_root(-v, a, j, k, fifth, sixth, 0.0)
    near = fits & (abs(h) <= NEAR_PEAK) & (abs(correction) <= 1e-4 * abs(h) + 1e-12)
    tail = (1 / 24) * k + h * ((1 / 120) * fifth + h * (1 / 720) * sixth)
    x += h * (v + h * (0.5 * a + h * ((1 / 6) * j + h * tail)))
    since = h + step
    since = since + length if late else since
    found = one & near & (since > -1e-9) & (since < length + 1e-9)
    seek = L[f.SEEK + i] > 0.0
    best = kept(L[f.PART + entry.MAX_ABS_X1 * STRIDE + i], L[f.UNIT + i])
    when = kept(L[f.PART + entry.T_MAX_ABS_X1 * STRIDE + i], L[f.UNIT + i])
    mend = kept(L[f.MEND + i], L[f.UNIT + i])
    higher = seek & found & (abs(x) > best)
    L[f.PART + entry.MAX_ABS_X1 * STRIDE + i] = abs(x) if higher else best
    L[f.PART + entry.T_MAX_ABS_X1 * STRIDE + i] = L[f.LENGTH + i] - left - length + since if higher else when
    L[f.MEND + i] = MEND_PEAK if seek & (not (found | none)) else mend


@loop_njit
def _take_energies(L):
    for i in range(LANES):
        lane_energies(L, i)


@loop_njit
def _seek_peaks(L):
    for i in range(LANES):
        lane_peak(L, i)


@loop_njit
def measure(L):
    """Take the measures of every recorded flight that has ended in this tick; MEND says what is left to do."""
    _take_energies(L)
    _seek_peaks(L)


@loop_njit
def renew(L):
    """Begin the next segment where a flight has ended in this tick."""
    for i in range(LANES):
        unit = L[f.UNIT + i]
        ended = (L[f.HIT + i] > 0.0) & (L[f.RECORDED + i] > 0.0)
        omega = L[f.OMEGA + i]
        cosine = L[f.COS + i]
        sine = L[f.SIN + i]
        xq, _, vq = forced_motion(L[f.Q_RE + i], L[f.Q_IM + i], omega, cosine, sine)
        x = L[f.X_FREE + i] + xq
        v = L[f.V_FREE + i] + vq
        from_x = kept(L[f.FROM_X + i], unit)
        from_v = kept(L[f.FROM_V + i], unit)
        from_cos = kept(L[f.FROM_COS + i], unit)
        from_sin = kept(L[f.FROM_SIN + i], unit)
        from_tau = kept(L[f.FROM_TAU + i], unit)
        L[f.FROM_X + i] = x if ended else from_x
        L[f.FROM_V + i] = v if ended else from_v
        L[f.FROM_COS + i] = cosine if ended else from_cos
        L[f.FROM_SIN + i] = sine if ended else from_sin
        L[f.FROM_TAU + i] = 0.0 if ended else from_tau
