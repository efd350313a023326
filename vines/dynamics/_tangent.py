"""Growth of small disturbances along a run: tangent map, Floquet multipliers, Lyapunov spectrum.

Disturbances are taken at fixed time, in (x1, v1, x2, v2). Between events they follow the homogeneous equations; an
impact acts by its saltation matrix, a merge projects on the common motion, a release changes nothing
(docs/dynamics.md; of the merge docs/sticking.md).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from vines.domains import Number, Of, stated
from vines.dynamics._advance import A_V1, A_V2, IMPACT, KIND, MODE, PHASE, SIDE, STICK, TAU, TIME, V1, V2, X1, X2
from vines.dynamics._batches import GROWTHS, errors_of_rates
from vines.dynamics._constants import Constants
from vines.dynamics._flight import decay, derivatives, phasors
from vines.dynamics._impact_law import after_impact_kernel
from vines.dynamics._room import constants, room_of
from vines.dynamics._sincos import sincos
from vines.dynamics._trajectory import Trajectory
from vines.errors import StateError
from vines.kernels import by_type, fused_njit, identity, linked_njit, njit, zero_matrix, zero_vector

__all__ = [
    "DEAD",
    "carry_basis",
    "directions",
    "flow_basis",
    "jump_basis",
    "log_growth",
    "lyapunov_blocks",
    "lyapunov_spectrum",
    "offset",
    "orthonormalise",
    "swing",
    "swing_of",
    "tangent_map",
    "tangent_product",
]


DEAD = 1e-150
"""Growth below which a direction counts as gone: sticking removes it exactly."""


@by_type(Constants)
@njit
def directions(c):
    """Return something as long as a disturbance: the numbers of the state that are not given by the time."""
    return 0, 0, 0, 0


@fused_njit
def swing_of(o, tau):
    """Return sine, over the frequency, and cosine of an oscillator's free swing after a time tau."""
    size = decay(o.half * tau)
    sine, cosine = sincos(o.gamma * tau)
    sine *= size * o.inverse
    cosine *= size
    return sine, cosine


@fused_njit
def swing(o, sine, cosine, Y, j):
    """Carry a disturbance of an oscillator, the first two rows of a column of Y; see `swing_of`."""
    x = Y[0, j]
    v = Y[1, j]
    Y[0, j] = (cosine + o.half * sine) * x + sine * v
    Y[1, j] = -o.stiffness * sine * x + (cosine - o.half * sine) * v


@by_type(Constants)
@fused_njit
def flow_basis(c, mode, tau, Y):
    """Carry the disturbances that are the columns of Y over a time tau between events."""
    o = c.stuck if mode != 0.0 else c.free
    sine, cosine = swing_of(o, tau)
    for j in range(4):
        swing(o, sine, cosine, Y, j)
        if mode != 0.0:
            Y[2, j] = Y[0, j]
            Y[3, j] = Y[1, j]
        else:
            Y[2, j] += tau * Y[3, j]


@by_type(Constants)
@fused_njit
def carry_basis(c, row, tau, Y):
    """Carry the disturbances over a time tau that begins just after a row, before the next one."""
    flow_basis(c, row[MODE], tau, Y)


@by_type(Constants)
@fused_njit
def jump_basis(c, row, Y):
    """Apply the effect of an event to the disturbances."""
    if row[KIND] == IMPACT:
        v1, v2 = row[V1], row[V2]
        after1, after2 = after_impact_kernel(c.law, v1, v2)
        ur, ui, gr, gi = phasors(c.free, c.Omega, row[X1], v1, row[PHASE])
        _, _, a, _, _ = derivatives(c.free, c.Omega, ur, ui, gr, gi)
        a_after = a - c.lam * (after1 - v1)
        closing = v1 - v2
        for j in range(4):
            # The disturbed run hits earlier by `shift`; before that it has the one motion, after it the other.
            shift = (Y[0, j] - Y[2, j]) / closing if closing != 0.0 else 0.0
            x1 = Y[0, j] - v1 * shift
            w1 = Y[1, j] - a * shift
            x2 = Y[2, j] - v2 * shift
            w1, w2 = after_impact_kernel(c.law, w1, Y[3, j])
            Y[0, j] = x1 + after1 * shift
            Y[1, j] = w1 + a_after * shift
            Y[2, j] = x2 + after2 * shift
            Y[3, j] = w2
    elif row[KIND] == STICK:
        share = 1.0 / (1.0 + c.mu)
        # What is left of the chatter closes the gap of a disturbed run; meanwhile the damper acts on the common motion.
        damped = c.lam * c.mu * share * share
        for j in range(4):
            x = share * (Y[0, j] + c.mu * Y[2, j])
            v = share * (Y[1, j] + c.mu * Y[3, j]) + damped * (Y[0, j] - Y[2, j])
            Y[0, j] = x
            Y[2, j] = x
            Y[1, j] = v
            Y[3, j] = v


@by_type(Constants)
@njit
def offset(c, row, event, late, scale, away):
    """Fill `away` with the disturbance that a run is of an orbit, just after an impact of both.

    Parameters
    ----------
    row, event : ndarray, shape (ROW,)
        The impact of the run with what comes after, and that of the orbit with what comes before.
    late : float
        By how much later the run has it.
    scale : float
        Unit of the disturbance.
    away : ndarray, shape (d,)
    """
    x1, v1, v2 = event[X1], event[V1], event[V2]
    after1, after2 = after_impact_kernel(c.law, v1, v2)
    ur, ui, gr, gi = phasors(c.free, c.Omega, x1, v1, event[PHASE])
    _, _, a, _, _ = derivatives(c.free, c.Omega, ur, ui, gr, gi)
    away[0] = (row[X1] - x1 - after1 * late) / scale
    away[1] = (row[A_V1] - after1 - (a - c.lam * (after1 - v1)) * late) / scale
    away[2] = (row[X2] - (x1 - event[SIDE]) - after2 * late) / scale
    away[3] = (row[A_V2] - after2) / scale


@linked_njit
def tangent_product(c, rows, first, last):
    """Return the tangent map, square, from just after row `first` to just after row `last`."""
    Y = identity(len(directions(c)))
    for i in range(first + 1, last + 1):
        carry_basis(c, rows[i - 1], rows[i, TAU], Y)
        jump_basis(c, rows[i], Y)
    return Y


@fused_njit
def orthonormalise(directions, Y, gains):
    """Gram–Schmidt in place; the lengths before normalisation go to `gains` (0 where a direction has died).

    `directions` is as long as there are columns; of a tuple the compiler knows the length of the loops.
    """
    n = len(directions)
    for j in range(n):
        for k in range(j):
            dot = 0.0
            for i in range(n):
                dot += Y[i, k] * Y[i, j]
            for i in range(n):
                Y[i, j] -= dot * Y[i, k]
        square = 0.0
        for i in range(n):
            square += Y[i, j] * Y[i, j]
        length = math.sqrt(square)
        gains[j] = length
        scale = 1.0 / length if length > DEAD else 0.0
        for i in range(n):
            Y[i, j] *= scale


@linked_njit
def lyapunov_blocks(c, rows, n, start, stop, blocks, Y):
    """Return logarithmic growth of the d directions in equal blocks of time, and each block's length: (blocks, d + 1).

    The columns of Y, orthonormal at the first row, are carried on in place; growth before `start` is not counted.
    """
    every = directions(c)
    d = len(every)
    out = zero_matrix(blocks, d + 1)
    gains, factors = zero_vector(d), zero_vector(d)
    for j in range(d):
        factors[j] = 1.0
    width = (stop - start) / blocks
    block = -1
    for i in range(1, n):
        carry_basis(c, rows[i - 1], rows[i, TAU], Y)
        jump_basis(c, rows[i], Y)
        orthonormalise(every, Y, gains)
        t = rows[i, TIME]
        if t > start:
            b = min(int((t - start) / width), blocks - 1)
            if b != block:
                if block >= 0:
                    log_growth(factors, out[block])
                block = b
            full = False
            for j in range(d):
                factors[j] *= gains[j] if gains[j] > DEAD else 0.0
                full |= not DEAD < factors[j] < 1.0 / DEAD
            if full:
                log_growth(factors, out[block])
            out[b, d] += min(rows[i, TAU], t - start)
    if block >= 0:
        log_growth(factors, out[block])
    return out


@linked_njit
def log_growth(factors, growth):
    """Move growth from factors to logarithms: one logarithm for many events."""
    for k in range(factors.shape[0]):
        growth[k] += math.log(factors[k]) if factors[k] > 0.0 else -math.inf
        factors[k] = 1.0


@stated(run=Of("Trajectory|ParallelRun", how="as vines.simulate returns it"))
def tangent_map(run: Trajectory) -> npt.NDArray[np.float64]:
    """Return the tangent map of a whole run: disturbances of (x1, v1, x2, v2) at its end by those at its start.

    Of the impact pair disturbances are those of the ball, (x2, v2).

    Parameters
    ----------
    run : Trajectory
        Any run; over a period of a periodic orbit the eigenvalues are its Floquet multipliers.

    Returns
    -------
    ndarray, shape (d, d)
        With every impact followed one by one, its determinant is r^(2 N) exp(-lam t) for N impacts in a time t.

    Examples
    --------
    >>> from vines.dynamics import simulate
    >>> from vines.model import Params
    >>> p = Params(mu=0.01, A=0.015)
    >>> run = simulate(p, periods=10)
    >>> J = tangent_map(run)
    >>> expected = p.r ** (2 * len(run.impacts)) * np.exp(-p.lam * 10 * p.period)
    >>> bool(abs(np.linalg.det(J) / expected - 1) < 1e-6)
    True
    """
    return tangent_product(constants(run.params), run.rows, 0, len(run.rows) - 1)


@stated(run=Of("Trajectory|ParallelRun", how="as vines.simulate returns it"), skip=Number(least=0))
def lyapunov_spectrum(run: Trajectory, *, skip: float = 0.0) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the Lyapunov exponents of a run and their standard errors, per unit of dimensionless time.

    Parameters
    ----------
    run : Trajectory
        A run on the attractor.
    skip : float
        Forcing periods at the start during which the directions align and growth is not counted.

    Returns
    -------
    exponents, errors : ndarray, shape (d,)
        As many as a disturbance has numbers, in descending order; -inf for directions that sticking removes. Errors
        come from the scatter of parts of the run, nan where the parts are not independent (docs/dynamics.md).

    Raises
    ------
    StateError
        If nothing of the run is left after `skip`.

    Notes
    -----
    They sum to -lam + 2 (impacts per time) ln r where no sticking occurs (docs/dynamics.md).
    """
    start = run.t_start + skip * run.params.period
    if not start < run.t_end:
        raise StateError(f"skip is {skip!r} periods; allowed is less than the length of the run")
    c = constants(run.params)
    every = np.eye(room_of(run.params).layout(run.params).directions)
    grown = lyapunov_blocks(c, run.rows, len(run.rows), start, run.t_end, GROWTHS, every)
    return exponents_of(grown)


def exponents_of(grown: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return exponents and standard errors from growth by blocks, as `lyapunov_blocks` gives it."""
    d = grown.shape[1] - 1
    exponents, errors = np.full(d, -np.inf), np.zeros(d)
    length = grown[:, d].sum()
    alive = np.all(np.isfinite(grown[:, :d]), axis=0)
    exponents[alive] = grown[:, :d][:, alive].sum(axis=0) / length
    errors_of_rates(np.ascontiguousarray(grown), errors)
    return exponents, errors
