"""Scatter as in a real rig: restitution drawn at each impact, noise and a second harmonic of the base.

A kernel of its own, for its forcing is not that of the model: two harmonics and a held random force. Motion between
events is exact all the same, contacts are found by the same certified steps (docs/dynamics.md, "Scatter").
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._batches import BATCHES, close_batch, standard_errors
from vines.dynamics._flight import advance_phase
from vines.dynamics._impact_law import exchanged_kernel, impact_law_kernel
from vines.dynamics._random import normal
from vines.dynamics._sincos import sincos
from vines.dynamics._steps import leaving_step, quartic_root, safe_step
from vines.errors import ParameterError
from vines.kernels import entry_njit, linked_njit, njit, zero_matrix, zero_vector

__all__ = ["Scatter", "scatter_block"]


@dataclass(frozen=True, slots=True)
class Scatter:
    """What varies from impact to impact and in the base, with the seed of the draws.

    Parameters
    ----------
    sigma_r : float
        Standard deviation of the restitution; each impact has r - r_speed |w'| + sigma_r g, cut to [0, 1], g normal.
    r_speed : float
        Decrease of the restitution with the relative speed before impact.
    noise : float
        Standard deviation of a random force on the oscillator, in units of A, held for a part of a period.
    hold : int
        How often in a forcing period that force is drawn.
    second : float
        Amplitude of the second harmonic of the base, in units of A.
    second_phase : float
        Its phase when that of the first is 0 [rad].
    seed : int
        Seed; trajectory k draws from the stream (seed, k), whatever runs beside it.

    Raises
    ------
    ParameterError
        If a number is not finite, a standard deviation negative, or `hold` or `seed` out of range.

    Examples
    --------
    >>> Scatter(sigma_r=0.02, seed=7).seed
    7
    """

    sigma_r: float = 0.0
    r_speed: float = 0.0
    noise: float = 0.0
    hold: int = 32
    second: float = 0.0
    second_phase: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("sigma_r", "r_speed", "noise", "second", "second_phase"):
            value = getattr(self, name)
            if not math.isfinite(value) or (value < 0 and name in ("sigma_r", "noise", "second")):
                raise ParameterError(f"{name} is {value!r}; give a finite number, not negative")
        if not 1 <= self.hold <= 4096:
            raise ParameterError(f"hold is {self.hold!r}; allowed is 1 to 4096 draws in a forcing period")
        if not 0 <= self.seed < 2**53:
            raise ParameterError(f"seed is {self.seed!r}; allowed is 0 to 2**53 - 1")

    def check(self, table: npt.NDArray[np.float64]) -> None:
        """Raise where the model with scatter, which is written over the steady response, does not exist.

        Parameters
        ----------
        table : ndarray, shape (n, 5)
            mu, A, Omega, r, lam.

        Raises
        ------
        ParameterError
            If damping vanishes at the resonance of a harmonic with the oscillator, alone or with the ball on a wall.
        """
        mu, _, Omega, _, lam = table.T
        for w in (Omega, 2.0 * Omega) if self.second > 0 else (Omega,):
            for mass in (np.ones_like(mu), 1.0 + mu):
                bad = np.hypot(1.0 - mass * w * w, lam * w) < 1e-9
                if bad.any():
                    k = int(np.flatnonzero(bad)[0])
                    raise ParameterError(
                        f"lam is {lam[k]:g} at the resonance of mass {mass[k]:g} in run {k}; allowed with scatter is "
                        "lam > 0 there"
                    )

    def numbers(self) -> npt.NDArray[np.float64]:
        """Return the fields as an array, for the kernel."""
        return np.array(
            [self.sigma_r, self.r_speed, self.noise, self.hold, self.second, self.second_phase, self.seed], dtype=float
        )


# The kernel's view of one oscillator: half, gamma, and the responses to both harmonics at phase 0.
HALF, GAMMA, Q1R, Q1I, Q2R, Q2I, STATIC = range(7)

# The running state.
X, V, BALL, SPEED, PHASE, HELD, MODE, WALL = range(8)

MAX_STEPS = 100_000
"""Certified steps in one period; more means that something is wrong, and end the run with a status."""

NODES = np.array([0.1252334085114689, 0.3678314989981802, 0.5873179542866175, 0.7699026741943047,
                  0.9041172563704749, 0.9815606342467193])  # fmt: skip
WEIGHTS = np.array([0.2491470458134028, 0.2334925365383548, 0.2031674267230659, 0.1600783285433462,
                    0.1069393259953184, 0.0471753363865118])  # fmt: skip
"""Gauss–Legendre of twelve points: exact to rounding for energies over a certified step."""


@njit
def _oscillator(o, mass, p, numbers):
    A, Omega, lam = p[1], p[2], p[4]
    o[HALF] = 0.5 * lam / mass
    o[GAMMA] = math.sqrt(1.0 / mass - o[HALF] * o[HALF])
    q1 = A * complex(lam * Omega, -1.0) / complex(1.0 - mass * Omega * Omega, lam * Omega)
    w = 2.0 * Omega
    shift = complex(math.cos(numbers[5]), math.sin(numbers[5]))
    q2 = complex(0.0, 0.0)
    if numbers[4] > 0.0:
        q2 = numbers[4] * A * complex(lam * w, -1.0) / complex(1.0 - mass * w * w, lam * w) * shift
    o[Q1R], o[Q1I], o[Q2R], o[Q2I], o[STATIC] = q1.real, q1.imag, q2.real, q2.imag, 1.0


@njit
def _look(o, Omega, s, d):
    """Put x1 and its first four derivatives at the state into d[0:5], the size of the free part into d[5]."""
    sine, cosine = sincos(s[PHASE])
    sine2, cosine2 = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
    x1 = o[Q1R] * cosine - o[Q1I] * sine
    y1 = o[Q1R] * sine + o[Q1I] * cosine
    x2 = o[Q2R] * cosine2 - o[Q2I] * sine2
    y2 = o[Q2R] * sine2 + o[Q2I] * cosine2
    w2 = 2.0 * Omega
    square = o[HALF] * o[HALF] + o[GAMMA] * o[GAMMA]
    xh = s[X] - x1 - x2 - s[HELD]
    vh = s[V] + Omega * y1 + w2 * y2
    ah = -2.0 * o[HALF] * vh - square * xh
    jh = -2.0 * o[HALF] * ah - square * vh
    kh = -2.0 * o[HALF] * jh - square * ah
    d[0] = s[X]
    d[1] = s[V]
    d[2] = ah - Omega**2 * x1 - w2**2 * x2
    d[3] = jh + Omega**3 * y1 + w2**3 * y2
    d[4] = kh + Omega**4 * x1 + w2**4 * x2
    zi = (vh + o[HALF] * xh) / o[GAMMA]
    d[5] = math.sqrt(xh * xh + zi * zi)


@njit
def _at(o, Omega, s, h):
    """Return x1 and v1 a time h after the state."""
    sine, cosine = sincos(s[PHASE])
    later, along = sincos(s[PHASE] + Omega * h)
    x = v = 0.0
    xh = s[X] - s[HELD]
    vh = s[V]
    for harmonic in range(2):
        n = harmonic + 1.0
        qr, qi = o[Q1R + 2 * harmonic], o[Q1I + 2 * harmonic]
        if harmonic == 1:
            sine, cosine = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
            later, along = 2.0 * later * along, 1.0 - 2.0 * later * later
        xh -= qr * cosine - qi * sine
        vh += n * Omega * (qr * sine + qi * cosine)
        x += qr * along - qi * later
        v -= n * Omega * (qr * later + qi * along)
    decay = math.exp(-o[HALF] * h)
    sine, cosine = sincos(o[GAMMA] * h)
    sine *= decay / o[GAMMA]
    cosine *= decay
    drag = o[HALF] * sine
    square = o[HALF] * o[HALF] + o[GAMMA] * o[GAMMA]
    x += (cosine + drag) * xh + sine * vh + s[HELD]
    v += (cosine - drag) * vh - square * sine * xh
    return x, v


@njit
def _go(o, Omega, s, h):
    """Move the state on by h."""
    s[X], s[V] = _at(o, Omega, s, h)
    s[PHASE] = advance_phase(s[PHASE], Omega * h)
    if s[MODE] != 0.0:
        s[BALL] = s[X] - s[MODE]
        s[SPEED] = s[V]
    else:
        s[BALL] += s[SPEED] * h


@njit
def _towards(d, s, side, bound, window, fresh):
    """Return (certified step towards a wall, step to its only contact in a bracket or nan)."""
    slope = side * (d[1] - s[SPEED])
    a, j, k = side * d[2], side * d[3], side * d[4]
    if fresh:
        return leaving_step(max(-slope, 0.0), a, j, bound, window), math.nan
    gap = 1.0 - side * (d[0] - s[BALL])
    if gap < 0.0 < slope:
        # The jump to the contact went a little too far: a step back.
        return math.inf, quartic_root(gap, slope, a, j, k)
    gap = max(gap, 0.0)
    if slope > 0.0 and 2.0 * gap <= slope * window:
        reach = 2.0 * gap / slope
        if slope * slope > 2.0 * gap * (abs(a) + reach * (abs(j) + 0.5 * bound * reach)):
            return math.inf, quartic_root(gap, slope, a, j, k)
    h = safe_step(gap, slope, a + window * (max(j, 0.0) / 3.0 + bound * window / 12.0), window)
    shorter = min(1.5 * h, window)
    h = max(h, safe_step(gap, slope, a + shorter * (max(j, 0.0) / 3.0 + bound * shorter / 12.0), shorter))
    return h, math.nan


@linked_njit
def _energies(o, p, numbers, s, h, total, t):
    """Add the energies of a step of length h to the totals."""
    A, Omega, lam = p[1], p[2], p[4]
    square = speed = ball = work = loss = 0.0
    best, when = total[entry.MAX_ABS_X1], -1.0
    for k in range(12):
        u = 0.5 * h * (1.0 + (NODES[k // 2] if k % 2 else -NODES[k // 2]))
        weight = 0.5 * h * WEIGHTS[k // 2]
        x, v = _at(o, Omega, s, u)
        sine, cosine = sincos(s[PHASE] + Omega * u)
        sine2, cosine2 = sincos(2.0 * (s[PHASE] + Omega * u) + numbers[5])
        base = A * (sine + numbers[4] * sine2)
        rate = A * Omega * (cosine + 2.0 * numbers[4] * cosine2)
        square += weight * x * x
        speed += weight * v * v
        ball += weight * (v * v if s[MODE] != 0.0 else s[SPEED] * s[SPEED])
        work += weight * (rate * (base - x + lam * (rate - v)) + _force(o, s) * v)
        loss += weight * lam * (v - rate) ** 2
        if abs(x) > best:
            best, when = abs(x), u
    if when >= 0.0:
        # The peak lies near the best of the nodes: two of Newton's steps on v1 = 0.
        for _ in range(3):
            x, v = _at(o, Omega, s, when)
            _, nearby = _at(o, Omega, s, when + 1e-5)
            slope = (nearby - v) / 1e-5
            moved = when - v / slope if slope != 0.0 else when
            if not 0.0 <= moved <= h:
                break
            when = moved
        x, _ = _at(o, Omega, s, when)
        total[entry.MAX_ABS_X1] = max(best, abs(x))
        total[entry.T_MAX_ABS_X1] = t + when
    total[entry.DURATION] += h
    total[entry.X1_SQUARE] += square
    total[entry.V1_SQUARE] += speed
    total[entry.V2_SQUARE] += ball
    total[entry.BASE_WORK] += work
    total[entry.DAMPER_LOSS] += loss


@njit
def _force(o, s):
    """Return the held random force: the displacement that it would cause at rest, for a spring of stiffness 1."""
    return o[STATIC] * s[HELD]


@njit
def _energy(p, numbers, s):
    base = p[1] * (math.sin(s[PHASE]) + numbers[4] * math.sin(2.0 * s[PHASE] + numbers[5]))
    return 0.5 * (s[V] ** 2 + p[0] * s[SPEED] ** 2 + (s[X] - base) ** 2)


@njit
def _write(events, filled, who, kind, side, t, tau, s, v1, v2):
    row = events[filled]
    row[:] = 0.0
    row[col.KIND], row[col.SIDE], row[col.TIME], row[col.TAU] = kind, side, t, tau
    row[col.PHASE], row[col.X1], row[col.X2] = s[PHASE], s[X], s[BALL]
    row[col.V1], row[col.V2], row[col.A_V1], row[col.A_V2] = v1, v2, s[V], s[SPEED]
    row[col.MODE], row[col.ROW] = s[MODE], who


@entry_njit
def scatter_block(
    parameters, starts, first, lengths, cap, what, finals, totals, errors, counts, status, events, numbers, base
):
    """Run a block of trajectories with scatter; arguments as for `run_block`, `base` the number of the first one.

    Returns
    -------
    int
        Events filled.
    """
    filled = 0
    free, stuck = zero_vector(7), zero_vector(7)
    none, total, values = zero_vector(entry.TOTALS), zero_vector(entry.TOTALS), zero_matrix(BATCHES, 3)
    s, d = zero_vector(8), zero_vector(6)
    key = int(numbers[6])
    for who in range(parameters.shape[0]):
        p = parameters[who]
        mu, A, Omega, r0 = p[0], p[1], p[2], p[3]
        _oscillator(free, 1.0, p, numbers)
        _oscillator(stuck, 1.0 + mu, p, numbers)
        s[:5] = starts[who]
        s[5:] = 0.0
        w = s[X] - s[BALL]
        if abs(w) >= 1.0 - 1e-14:
            side = 1.0 if w > 0.0 else -1.0
            s[BALL] = s[X] - side
            s[WALL] = side if side * (s[V] - s[SPEED]) <= 0.0 else 0.0
        size1 = math.sqrt(free[Q1R] ** 2 + free[Q1I] ** 2)
        size2 = math.sqrt(free[Q2R] ** 2 + free[Q2I] ** 2)
        forced = (size1 + 16.0 * size2) * Omega**4
        window = 0.45 / max(1.0, Omega)
        near = 1e-4 / max(1.0, Omega) ** 1.25
        parts = int(numbers[3]) if numbers[2] > 0.0 else 1
        grid = 2.0 * math.pi / Omega / parts
        t, tau, stop, draws, held, busy, steps = -first[who], 0.0, lengths[who], 0, 0, 0, 0
        next_draw = t
        counts[who] = 0
        status[who] = 0
        # Measures are gathered for one of the equal parts of the recorded time after the other.
        width, batch = stop / BATCHES, 0
        whole = totals[who] if what & 1 else none
        whole[:] = 0.0
        total[:] = 0.0
        opened = False
        while True:
            if not opened and t >= 0.0:
                opened = True
                total[entry.MAX_ABS_X1] = abs(s[X])
                whole[entry.ENERGY_CHANGE] = -_energy(p, numbers, s)
            if t >= stop:
                break
            if batch < BATCHES - 1 and t >= (batch + 1) * width:
                close_batch(mu, total, whole, values[batch])
                batch += 1
                total[entry.MAX_ABS_X1], total[entry.T_MAX_ABS_X1] = abs(s[X]), t
            if t >= next_draw - 1e-12:
                # A new held force; position and velocity go on as they were.
                s[HELD] = numbers[2] * A * normal(key, base + who, 2 * held + 1) if numbers[2] > 0.0 else 0.0
                held += 1
                next_draw += grid
                if held % parts == 0:
                    busy = steps = 0
            until = min(next_draw, stop)
            if t < 0.0:
                until = min(until, 0.0)
            elif batch < BATCHES - 1:
                until = min(until, (batch + 1) * width)
            room = until - t
            steps += 1
            if steps > MAX_STEPS:
                status[who] = 2
                break
            o = stuck if s[MODE] != 0.0 else free
            _look(o, Omega, s, d)
            if s[MODE] != 0.0:
                side = s[MODE]
                bound = (1.0 + mu) * (d[5] + (size1 + 32.0 * size2) * Omega**4 * max(1.0, Omega))
                if side * d[2] < 0.0:
                    s[MODE] = 0.0
                    s[WALL] = side
                    if what & 2 and t >= 0.0:
                        if filled >= events.shape[0]:
                            status[who] = 3
                            return filled
                        _write(events, filled, who, col.RELEASE, side, t, tau, s, s[V], s[SPEED])
                        filled += 1
                    tau = 0.0
                    continue
                h = safe_step(side * d[2], -side * d[3], -side * d[4] + bound * window / 3.0, window)
                h = max(h, 1e-9)
                hit = False
            else:
                bound = d[5] + forced
                fresh = s[WALL]
                if fresh != 0.0 and fresh * (d[1] - s[SPEED]) >= 0.0 and fresh * d[2] > 0.0:
                    # No speed is left and the wall pushes: the ball rides on it.
                    share = (s[V] + mu * s[SPEED]) / (1.0 + mu)
                    total[entry.STICKS_LEFT if fresh > 0.0 else entry.STICKS_RIGHT] += 1.0 if t >= 0.0 else 0.0
                    before1, before2 = s[V], s[SPEED]
                    s[V], s[SPEED], s[MODE], s[WALL] = share, share, fresh, 0.0
                    if what & 2 and t >= 0.0:
                        if filled >= events.shape[0]:
                            status[who] = 3
                            return filled
                        _write(events, filled, who, col.STICK, fresh, t, tau, s, before1, before2)
                        filled += 1
                    tau = 0.0
                    continue
                up, root_up = _towards(d, s, 1.0, bound, window, fresh > 0.0)
                down, root_down = _towards(d, s, -1.0, bound, window, fresh < 0.0)
                h = min(up, down)
                hit = False
                side = 1.0
                if not math.isnan(root_up):
                    h, side, hit = root_up, 1.0, abs(root_up) <= near
                elif not math.isnan(root_down):
                    h, side, hit = root_down, -1.0, abs(root_down) <= near
                if not hit and h < 1e-12 and fresh == 0.0:
                    hit, side = True, (1.0 if up <= down else -1.0)
                s[WALL] = 0.0
            if h >= room:
                h, hit = room, False
            if t >= 0.0 and what & 1 and h != 0.0:
                _energies(o, p, numbers, s, h, total, t)
            _go(o, Omega, s, h)
            t = until if h >= room else t + h
            tau += h
            if not hit:
                continue
            closing = s[V] - s[SPEED]
            r = r0 - numbers[1] * abs(closing)
            if numbers[0] > 0.0:
                r += numbers[0] * normal(key, base + who, 2 * draws)
            draws += 1
            r = min(max(r, 0.0), 1.0)
            before1, before2 = s[V], s[SPEED]
            loss, gain = exchanged_kernel(impact_law_kernel(mu, r), closing)
            s[V] -= loss
            s[SPEED] += gain
            s[BALL] = s[X] - side
            s[WALL] = side
            push = side * d[2]
            left = abs(s[V] - s[SPEED])
            if push > 0.0 and left * left < 1e-14 * push:
                # What is left of the chatter lasts too short to be resolved: the ball rides on the wall from here.
                s[SPEED] = s[V] = (s[V] + mu * s[SPEED]) / (1.0 + mu)
                left = 0.0
            counts[who] += 1
            busy += 1
            if t >= 0.0:
                lost = 0.5 * mu / (1.0 + mu) * (closing * closing - left * left)
                total[entry.LOSS_LEFT if side > 0.0 else entry.LOSS_RIGHT] += lost
                total[entry.IMPACTS_LEFT if side > 0.0 else entry.IMPACTS_RIGHT] += 1.0
                if what & 2:
                    if filled >= events.shape[0]:
                        status[who] = 3
                        return filled
                    _write(events, filled, who, col.IMPACT, side, t, tau, s, before1, before2)
                    filled += 1
            tau = 0.0
            if busy > cap:
                status[who] = 1
                break
        complete = batch == BATCHES - 1 and t >= stop
        close_batch(mu, total, whole, values[batch])
        whole[entry.ENERGY_CHANGE] += _energy(p, numbers, s)
        if what & 1:
            errors[who, :] = math.nan
            if complete:
                standard_errors(values, errors[who])
        finals[who, :5] = s[:5]
        finals[who, 5] = s[MODE]
    return filled
