"""The second rig's motion by an adaptive Runge-Kutta pair of Dormand and Prince, written for it.

State: oscillator x1, v1; ball x2, v2; velocity u of the ball's surface by its spin; table q, q'; impulse of the contact
force and its first moment in time. The base is either where it should be (q of the state is not used) or a table on a
suspension that a force drives:

    M x1'' = -k (1 + k3 d^2) d - c d' + rub - F,   d = x1 - q
    m x2'' = F + m pull - rub,   (2/5) m u' = rub where the ball spins,   rub = m f tanh(slip/v_s)
    Mb q'' = drive - kb q - cb q' + k (1 + k3 d^2) d + c d'

with slip = v2 - v1 - u. F is a spring and a dashpot that only push: the restitution is that of the damping ratio,
whatever the speed, and a contact lasts equally long.
"""

from __future__ import annotations

import math

import numba
import numpy as np

NAMES = (
    *("M", "c", "k", "k3", "mu", "friction", "slip", "spins", "pull", "left", "right", "kc", "E", "omega", "phi"),
    *("h2", "phi2", "h3", "phi3", "drift_E", "soft", "begin", "span", "Mb", "kb", "cb", "reacts", "ball", "m"),
)
"""Parameters, in the order of the array that the integrator takes; `reacts` and `ball` are 0 or 1, `soft` the relative
change of omega0 over `span` seconds from `begin`."""

N = 9
(_M, _c, _k, _k3, _mu, _f, _slip, _spins, _pull, _left, _right, _kc, _E, _omega, _phi, _h2, _phi2) = range(17)
(_h3, _phi3, _ramp, _soft, _begin, _span, _Mb, _kb, _cb, _reacts, _ball, _m) = range(17, 29)

ROWS = ("t", "side", "x1", "v1", "x2", "v2", "w_dot", "w_dot_after", "r", "t_end", "t_mid")
"""Columns of the contacts, at the touch but for `w_dot_after` and `t_end`; `t_mid` is the centroid of the force."""

_A = np.array([
    [0, 0, 0, 0, 0, 0],
    [1 / 5, 0, 0, 0, 0, 0],
    [3 / 40, 9 / 40, 0, 0, 0, 0],
    [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
    [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
])  # fmt: skip
_C = np.array([0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1])
_ERROR = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
_SCALE = np.array([1e-2, 0.5, 1e-2, 0.5, 0.5, 1e-3, 5e-2])
"""Of the first components; the integrals follow them."""


def damping_ratio(r: float) -> float:
    """Return the damping ratio of a spring and dashpot that only push, for a restitution.

    Force ends, before the depth does, where omega d + 2 zeta d' = 0; the speed is then r = exp(-zeta omega t) of that
    of the touch.

    Examples
    --------
    >>> round(damping_ratio(0.65), 4)
    0.1682
    """
    low, high = 1e-6, 0.999
    for _ in range(80):
        middle = 0.5 * (low + high)
        if math.exp(-middle / math.sqrt(1 - middle**2) * _angle(middle)) > r:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _angle(zeta: float) -> float:
    """Return omega_d times the length of a contact."""
    root = math.sqrt(1 - zeta**2)
    return math.atan2(2 * zeta * root, 2 * zeta**2 - 1)


def stiffness(contact_time: float, r: float, reduced_mass: float) -> float:
    """Return the stiffness of the contact for which it lasts a given time [N/m]."""
    zeta = damping_ratio(r)
    return reduced_mass * (_angle(zeta) / (math.sqrt(1 - zeta**2) * contact_time)) ** 2


@numba.njit(cache=True)
def base(t, p):
    """Return displacement and velocity of a base that is where it should be."""
    size = p[_E] * (1.0 + p[_ramp] * min(1.0, max(0.0, (t - p[_begin]) / p[_span])))
    a = p[_omega] * t + p[_phi]
    q = math.sin(a) + p[_h2] * math.sin(2 * a + p[_phi2]) + p[_h3] * math.sin(3 * a + p[_phi3])
    v = math.cos(a) + 2 * p[_h2] * math.cos(2 * a + p[_phi2]) + 3 * p[_h3] * math.cos(3 * a + p[_phi3])
    return size * q, size * p[_omega] * v


@numba.njit(cache=True)
def _drive(t, p):
    """Return the force under which the table alone would move as it should."""
    total = 0.0
    for n, size, shift in ((1, 1.0, 0.0), (2, p[_h2], p[_phi2]), (3, p[_h3], p[_phi3])):
        w = n * p[_omega]
        a = n * (p[_omega] * t + p[_phi]) + shift
        total += size * ((p[_kb] - p[_Mb] * w * w) * math.sin(a) + p[_cb] * w * math.cos(a))
    return p[_E] * total


@numba.njit(cache=True)
def rates(t, y, side, cc, p, out):
    """Write the time derivative of the state; `side` is the wall in contact (0 for none), `cc` its dashpot."""
    q, dq = (y[5], y[6]) if p[_reacts] > 0 else base(t, p)
    d, dd = y[0] - q, y[1] - dq
    warm = 1.0 + p[_soft] * min(1.0, max(0.0, (t - p[_begin]) / p[_span]))
    spring = p[_k] * warm * warm * d * (1.0 + p[_k3] * d * d) + p[_c] * dd
    slip = y[3] - y[1] - y[4]
    rub = p[_f] * math.tanh(slip / p[_slip]) * p[_ball]
    force = 0.0
    if side != 0.0:
        depth = y[0] - y[2] - p[_left] if side > 0 else y[2] - y[0] - p[_right]
        force = max(0.0, p[_kc] * depth + cc * side * (y[1] - y[3]))
    out[0] = y[1]
    out[1] = -(spring + side * force) / p[_M] + p[_mu] * rub
    out[2] = y[3]
    out[3] = side * force / p[_m] + p[_pull] - rub
    out[4] = 2.5 * rub * p[_spins]
    if p[_reacts] > 0:
        out[5] = dq
        out[6] = (_drive(t, p) - p[_kb] * q - p[_cb] * dq + spring) / p[_Mb]
    else:
        out[5] = 0.0
        out[6] = 0.0
    out[7] = -side * force
    out[8] = -side * force * t


@numba.njit(cache=True)
def _try(t, h, y, side, cc, p, k, new):
    """Write the state after a step of h; k[0] holds the rates at its start. Return the error, 1 is the limit."""
    stage = np.empty(N)
    for i in range(1, 7):
        for j in range(N):
            total = 0.0
            for n in range(i):
                total += _A[i, n] * k[n, j]
            stage[j] = y[j] + h * total
        rates(t + _C[i] * h, stage, side, cc, p, k[i])
    worst = 0.0
    for j in range(N):
        new[j] = stage[j]
        if j < len(_SCALE):
            wrong = 0.0
            for i in range(7):
                wrong += _ERROR[i] * k[i, j]
            worst = max(worst, abs(h * wrong) / _SCALE[j])
    return worst


@numba.njit(cache=True)
def _depth(y, side, p):
    return y[0] - y[2] - p[_left] if side > 0 else y[2] - y[0] - p[_right]


@numba.njit(cache=True)
def run(y, start, p, step, count, dashpots, tolerance, out, rows, at):
    """Integrate from a time over `count` steps of a recorder.

    Parameters
    ----------
    y : ndarray, shape (9,)
        State; overwritten with that at the end.
    start : float
        Time of the first row [s].
    p : ndarray
        Parameters, see `NAMES`.
    step, count
        Of the recorder.
    dashpots : ndarray, shape (n, 2)
        Restitution and dashpot of each contact, in turn.
    tolerance : float
        Relative to `_SCALE`, a step.
    out : ndarray, shape (count + 1, 9)
        Gets the state.
    rows : ndarray, shape (n, 11)
        Gets the contacts, see `ROWS`.
    at : int
        Number of the first contact.

    Returns
    -------
    int
        Contacts.
    """
    k, new, mid, first = np.empty((7, N)), np.empty(N), np.empty(N), np.empty(N)
    t, h, side, cc, found, recorded = start, 1e-5, 0.0, 0.0, 0, 0
    pushed, moment = 0.0, 0.0
    rates(t, y, side, cc, p, k[0])
    while recorded <= count:
        error = _try(t, h, y, side, cc, p, k, new)
        if error > tolerance:
            h *= max(0.2, 0.9 * (tolerance / error) ** 0.2)
            rates(t, y, side, cc, p, k[0])
            continue
        used, event = h, 0.0
        if side == 0.0 and p[_ball] > 0:
            for wall in (1.0, -1.0):
                if _depth(new, wall, p) > 0 and wall * (new[1] - new[3]) > 0:
                    event = wall
        elif side != 0.0 and _depth(new, side, p) <= 0:
            event = side
        if event != 0.0 and abs(_depth(new, event, p)) > 1e-13:
            # The step that ends where the depth is 0: the root is bracketed from outside by trial steps.
            low, high, first[:] = 0.0, h, k[0]
            inside = _depth(y, event, p) > 0
            for _ in range(60):
                used = 0.5 * (low + high)
                k[0] = first
                _try(t, used, y, side, cc, p, k, new)
                if (_depth(new, event, p) > 0) == inside:
                    low = used
                else:
                    high = used
                if high - low < 1e-14:
                    break
        # Rows of the recorder inside this step, by Hermite's cubic between the states.
        rates(t + used, new, side, cc, p, mid)
        while recorded <= count and start + recorded * step <= t + used:
            s = (start + recorded * step - t) / used
            for j in range(N):
                a, b = used * k[0, j], used * mid[j]
                gap = new[j] - y[j]
                out[recorded, j] = y[j] + s * (a + s * (3 * gap - 2 * a - b + s * (a + b - 2 * gap)))
            recorded += 1
        t += used
        y[:] = new
        if event != 0.0:
            if side == 0.0:
                side, number = event, at + found
                cc = dashpots[number % len(dashpots), 1]
                pushed, moment = y[7], y[8]
                values = (t, side, y[0], y[1], y[2], y[3], y[1] - y[3], math.nan, dashpots[number % len(dashpots), 0])
                if found < len(rows):
                    for i in range(9):
                        rows[found, i] = values[i]
                    rows[found, 9] = rows[found, 10] = math.nan
                found += 1
            else:
                if 0 < found <= len(rows):
                    rows[found - 1, 7], rows[found - 1, 9] = y[1] - y[3], t
                    rows[found - 1, 10] = (y[8] - moment) / (y[7] - pushed)
                side, cc = 0.0, 0.0
            h = 2e-6
        else:
            h = min(1.5e-3, used * min(4.0, 0.9 * (tolerance / max(error, 1e-3 * tolerance)) ** 0.2))
        rates(t, y, side, cc, p, k[0])
    return found
