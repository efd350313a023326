"""The synthetic rig's motion: a Runge-Kutta integrator of fourth order with steps of the recorder, finer in contact.

Positions are in metres, positive to the right. The base moves as e(t); the oscillator obeys

    M x1'' = -c (x1' - e') - k(t) (x1 - e) + M g sin(tilt) + friction - F,

the ball m x2'' = F + m g sin(tilt) - friction, with the contact force F of :mod:`vines.rig.synth._contact`, positive
on the left end, where x1 - x2 has reached its half length. Structural modes of the oscillator are struck by F and ring
into its accelerometer.
"""

from __future__ import annotations

import math

import numpy as np

from vines.kernels import njit
from vines.model import V1, V2, X1, X2

__all__ = ["IMPACT", "NAMES", "NUMBER", "PHASE", "ROW", "advance"]

NAMES = (
    *("M", "m", "c", "k", "E", "omega", "phi", "h2", "phi2", "h3", "phi3"),
    *("left", "right", "K", "friction", "pull", "softening", "T0", "T1", "span", "r", "exponent", "reference", "pause"),
)
"""Parameters of the kernel, in the order of its array: SI units; `friction` and `pull` are accelerations, `left` and
`right` the half lengths at which contact begins, `softening` the relative change of k a kelvin, T0 and T1 temperatures
relative to that of k at the start and after `span` seconds; `r`, `exponent`, `reference` those of the law
r (v/reference)^-exponent; `pause` the length of a step in contact."""

(_M, _m, _c, _k, _E, _omega, _phi, _h2, _phi2, _h3, _phi3, _left, _right, _K, _friction, _pull) = range(16)
(_softening, _T0, _T1, _span, _r, _exponent, _reference, _pause) = range(16, 24)

IMPACT = ("t", "side", "x1", "v1", "x2", "v2", "w_dot", "w_dot_after", "v1_after", "v2_after", "r", "t_end", "t_mid")
"""Columns of the impacts: SI, state when contact begins and velocities when it ends; `r` is the restitution set,
`t_mid` the centroid of the force."""

_W_DOT_AFTER, _V1_AFTER, _V2_AFTER, _T_END, _T_MID = map(
    IMPACT.index, ("w_dot_after", "v1_after", "v2_after", "t_end", "t_mid")
)

_SIDE, _CHI, ROW, NUMBER, PHASE = range(4, 9)
"""Places in the state of a run behind those of oscillator and ball: the contact that the ball is in (0 if none), its
chi, its row among the impacts, contacts so far; then the phase of the base, which the kernel leaves alone."""

_SLOW = 1e-3
"""[m/s] Below this speed of approach the loss stays what it is there: the law would else damp without bound."""


@njit
def _course(t, knots):
    """Return what a course is at a time, and its slope: straight between its knots, level beyond them."""
    n = knots.shape[1]
    if t <= knots[0, 0]:
        return knots[1, 0], 0.0
    for k in range(1, n):
        if t < knots[0, k]:
            slope = (knots[1, k] - knots[1, k - 1]) / (knots[0, k] - knots[0, k - 1])
            return knots[1, k - 1] + slope * (t - knots[0, k - 1]), slope
    return knots[1, n - 1], 0.0


@njit
def _base(t, p, swell):
    """Return displacement and velocity of the base."""
    theta = p[_omega] * t + p[_phi]
    e = math.sin(theta)
    de = math.cos(theta)
    if p[_h2] != 0.0 or p[_h3] != 0.0:
        e += p[_h2] * math.sin(2 * theta + p[_phi2]) + p[_h3] * math.sin(3 * theta + p[_phi3])
        de += 2 * p[_h2] * math.cos(2 * theta + p[_phi2]) + 3 * p[_h3] * math.cos(3 * theta + p[_phi3])
    if swell.shape[1] > 0:
        size, slope = _course(t, swell)
        return p[_E] * size * e, p[_E] * (p[_omega] * size * de + slope * e)
    return p[_E] * e, p[_E] * p[_omega] * de


@njit
def _rates(t, e, de, x1, v1, x2, v2, side, chi, p):
    """Return the accelerations of oscillator and ball; side is 0 in flight."""
    stiff = p[_k] * (1.0 + p[_softening] * (p[_T0] + (p[_T1] - p[_T0]) * t / p[_span]))
    a1 = -(p[_c] * (v1 - de) + stiff * (x1 - e)) / p[_M] + p[_pull]
    a2 = p[_pull]
    slip = (v2 - v1) * 1e4
    rub = p[_friction] * min(1.0, max(-1.0, slip))
    a2 -= rub
    a1 += rub * p[_m] / p[_M]
    if side != 0.0:
        w = x1 - x2
        d = w - p[_left] if side > 0.0 else -w - p[_right]
        if d > 0.0:
            force = p[_K] * d * math.sqrt(d) * (1.0 + chi * side * (v1 - v2))
            if force > 0.0:
                a1 -= side * force / p[_M]
                a2 += side * force / p[_m]
    return a1, a2


@njit
def _step(t, h, x1, v1, x2, v2, side, chi, p, swell):
    """Return the state after one step of the classical Runge-Kutta method."""
    e0, d0 = _base(t, p, swell)
    em, dm = _base(t + 0.5 * h, p, swell)
    e1, d1 = _base(t + h, p, swell)
    a, b = _rates(t, e0, d0, x1, v1, x2, v2, side, chi, p)
    u1 = v1 + 0.5 * h * a
    u2 = v2 + 0.5 * h * b
    a2, b2 = _rates(t + 0.5 * h, em, dm, x1 + 0.5 * h * v1, u1, x2 + 0.5 * h * v2, u2, side, chi, p)
    w1 = v1 + 0.5 * h * a2
    w2 = v2 + 0.5 * h * b2
    a3, b3 = _rates(t + 0.5 * h, em, dm, x1 + 0.5 * h * u1, w1, x2 + 0.5 * h * u2, w2, side, chi, p)
    z1 = v1 + h * a3
    z2 = v2 + h * b3
    a4, b4 = _rates(t + h, e1, d1, x1 + h * w1, z1, x2 + h * w2, z2, side, chi, p)
    return (
        x1 + h / 6.0 * (v1 + 2.0 * u1 + 2.0 * w1 + z1),
        v1 + h / 6.0 * (a + 2.0 * a2 + 2.0 * a3 + a4),
        x2 + h / 6.0 * (v2 + 2.0 * u2 + 2.0 * w2 + z2),
        v2 + h / 6.0 * (b + 2.0 * b2 + 2.0 * b3 + b4),
    )


@njit
def _depth(x1, x2, side, p):
    """Return how far the ball is in the wall of a side; negative while it is not."""
    return x1 - x2 - p[_left] if side > 0.0 else x2 - x1 - p[_right]


@njit
def _until_touch(t, h, x1, v1, x2, v2, now, chi, side, p, swell):
    """Return the part of a step after which the depth in a wall changes sign, by bisection to a femtosecond."""
    low = 0.0
    high = h
    into = _depth(x1, x2, side, p) <= 0.0
    while high - low > 1e-15:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        y1, _, y2, _ = _step(t, middle, x1, v1, x2, v2, now, chi, p, swell)
        if (_depth(y1, y2, side, p) > 0.0) == into:
            high = middle
        else:
            low = middle
    return high


@njit
def _ring(y, s, h):
    """Let the modes ring for a time: their complex amplitudes turn and decay."""
    for i in range(len(y)):
        y[i] *= np.exp(s[i] * h)


@njit
def _modal_velocity(y, s):
    """Return the velocity of all modes together where the accelerometer sits."""
    total = 0.0
    for i in range(len(y)):
        total += (s[i] * y[i]).imag / s[i].imag
    return total


@njit
def advance(state, first, count, h, p, draws, quiet, table_r, table_a, modes, gains, swell, worn, ball, out, rows):
    """Integrate over steps of the recorder.

    Parameters
    ----------
    state : ndarray, shape (9,)
        Overwritten with the end state.
    first, count : int
        Number of the first step since the clock began, and of steps.
    h : float
        Their length [s].
    p : ndarray, shape (24,)
        Parameters, see `NAMES`.
    draws : ndarray
        What is added to r at each impact, in turn, from the start again when they are used up.
    quiet : ndarray of bool
        Contacts that don't make the modes ring, in turn.
    table_r, table_a : ndarray
        Of :func:`vines.rig.synth._contact.damping_table`.
    modes : ndarray of complex, shape (n,)
        Eigenvalues s of the structural modes [1/s].
    gains : ndarray of complex, shape (2, n)
        Their participation, and their amplitudes, which are overwritten.
    swell, worn : ndarray, shape (2, n)
        Times [s] and what E is multiplied with, and what is added to r, then; none without columns.
    ball : bool
        Whether the ball is in the cavity.
    out : ndarray, shape (5, count + 1)
        Gets x1, v1, x2, v2 at the steps and, from the second, what the accelerometer saw over the step before [m/s^2]:
        the mean, as a converter that integrates over its sample time; without columns nothing is recorded.
    rows : ndarray, shape (n, 13)
        Gets the impacts, see `IMPACT`; more than n are not recorded.

    Returns
    -------
    int
        Number of impacts recorded.
    """
    x1, v1, x2, v2, side, chi = state[X1], state[V1], state[X2], state[V2], state[_SIDE], state[_CHI]
    row = int(state[ROW])
    number = int(state[NUMBER])
    found = 0
    pushed = 0.0
    rings = gains[1]
    record = out.shape[1] > 0
    if record:
        out[0, 0], out[1, 0], out[2, 0], out[3, 0], out[4, 0] = x1, v1, x2, v2, 0.0
    seen = v1 + _modal_velocity(rings, modes)
    for k in range(count):
        start = (first + k) * h
        done = 0.0
        while done < h:
            rest = h - done
            t = start + done
            if side == 0.0:
                y1, u1, y2, u2 = _step(t, rest, x1, v1, x2, v2, 0.0, 0.0, p, swell)
                hit = 0.0
                if ball:
                    if y1 - y2 > p[_left] and u1 > u2:
                        hit = 1.0
                    elif y2 - y1 > p[_right] and u2 > u1:
                        hit = -1.0
                if hit == 0.0:
                    x1, v1, x2, v2 = y1, u1, y2, u2
                    _ring(rings, modes, rest)
                    break
                part = rest
                if _depth(x1, x2, hit, p) < 0.0:
                    part = _until_touch(t, rest, x1, v1, x2, v2, 0.0, 0.0, hit, p, swell)
                    x1, v1, x2, v2 = _step(t, part, x1, v1, x2, v2, 0.0, 0.0, p, swell)
                    _ring(rings, modes, part)
                    done += part
                side = hit
                speed = max(abs(v1 - v2), _SLOW)
                r = p[_r] * (speed / p[_reference]) ** -p[_exponent] + draws[number % len(draws)]
                if worn.shape[1] > 0:
                    r += _course(start + done, worn)[0]
                r = min(max(r, table_r[0]), table_r[-1])
                chi = np.interp(r, table_r, table_a) / speed
                number += 1
                pushed = 0.0
                row = -1
                if record and found < len(rows):
                    row = found
                    values = (
                        start + done,
                        side,
                        x1,
                        v1,
                        x2,
                        v2,
                        v1 - v2,
                        math.nan,
                        math.nan,
                        math.nan,
                        r,
                        math.nan,
                        0.0,
                    )
                    for i in range(13):
                        rows[row, i] = values[i]
                    found += 1
                continue
            part = min(p[_pause], rest)
            y1, u1, y2, u2 = _step(t, part, x1, v1, x2, v2, side, chi, p, swell)
            leaves = _depth(y1, y2, side, p) <= 0.0
            if leaves and _depth(x1, x2, side, p) > 0.0:
                part = _until_touch(t, part, x1, v1, x2, v2, side, chi, side, p, swell)
                y1, u1, y2, u2 = _step(t, part, x1, v1, x2, v2, side, chi, p, swell)
            _ring(rings, modes, part)
            struck = -(p[_m] / p[_M]) * (u2 - v2) * (0.02 if quiet[(number - 1) % len(quiet)] else 1.0)
            pushed += u2 - v2
            if row >= 0:
                rows[row, _T_MID] += (u2 - v2) * (t + 0.5 * part)
            for i in range(len(rings)):
                rings[i] += struck * gains[0, i]
            x1, v1, x2, v2 = y1, u1, y2, u2
            done += part
            if leaves and side * (v1 - v2) <= 0.0:
                if row >= 0:
                    rows[row, _W_DOT_AFTER], rows[row, _V1_AFTER], rows[row, _V2_AFTER] = v1 - v2, v1, v2
                    rows[row, _T_END] = start + done
                    rows[row, _T_MID] /= pushed
                side = 0.0
        if record:
            now = v1 + _modal_velocity(rings, modes)
            out[0, k + 1], out[1, k + 1], out[2, k + 1], out[3, k + 1] = x1, v1, x2, v2
            out[4, k + 1] = (now - seen) / h
            seen = now
    state[X1], state[V1], state[X2], state[V2] = x1, v1, x2, v2
    state[_SIDE], state[_CHI], state[ROW], state[NUMBER] = side, chi, float(row), float(number)
    return found
