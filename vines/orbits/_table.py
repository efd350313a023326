"""Symmetric 1:1/pT orbits at many parameter points at once: the closed form as a kernel over arrays."""

from __future__ import annotations

import cmath
import math

import numpy as np
import numpy.typing as npt

from vines.bounds import shown
from vines.domains import Whole, stated
from vines.dynamics.kernels import (
    after_impact_kernel,
    constants_kernel,
    jacobian_kernel,
    largest_displacement,
    reversing_kernel,
    segment_integrals,
)
from vines.errors import ParameterError
from vines.kernels import complex_matrix, complex_vector, entry_njit
from vines.model import AMPLITUDE, DAMPING, FREQUENCY, LAM_TABLE_1, MASS, RESTITUTION, Params
from vines.orbits._eigenvalues import eigenvalues_kernel
from vines.orbits._survey import inspect_flight

__all__ = ["symmetric_table"]

_ROW = np.dtype(
    [
        ("exists", np.bool_),
        ("speed", np.float64),
        ("phase", np.float64),
        ("x1", np.float64),
        ("v1", np.float64),
        ("w_dot", np.float64),
        ("half_multipliers", np.complex128, (4,)),
        ("max_multiplier", np.float64),
        ("stable", np.bool_),
        ("admissible", np.bool_),
        ("min_clearance", np.float64),
        ("kinetic_ratio", np.float64),
        ("max_abs_x1", np.float64),
    ]
)


@stated(ParameterError, period=Whole(most=1001))
def symmetric_table(
    mu: npt.ArrayLike,
    A: npt.ArrayLike,
    Omega: npt.ArrayLike = 1.0,
    r: npt.ArrayLike = 0.65,
    lam: npt.ArrayLike = LAM_TABLE_1,
    *,
    period: int = 1,
) -> npt.NDArray[np.void]:
    """Return the symmetric 1:1/pT orbits at many parameter points.

    Parameters
    ----------
    mu, A, Omega, r, lam : array_like
        Parameters, broadcast against each other.
    period : int
        p, odd.

    Returns
    -------
    structured ndarray, shape (..., 2)
        For each point the orbit of the larger speed and the other one. Fields: ``exists`` (all others are 0 where it is
        false), ``speed`` V of the ball, ``phase`` of the forcing at the L impact [rad], ``x1``, ``v1``, ``w_dot`` just
        before it, ``half_multipliers`` (their squares are the multipliers over pT; in no order), ``max_multiplier``
        over pT, ``stable``, ``admissible`` with the certificate of `Orbit`, ``min_clearance``, ``kinetic_ratio`` and
        ``max_abs_x1``.

    Raises
    ------
    ParameterError
        If `period` is not odd and positive, or a parameter is out of its range.

    Notes
    -----
    The same closed forms as `symmetric_orbits`, at under 10 µs a point (benchmarks/orbits.py).

    Examples
    --------
    >>> table = symmetric_table(0.01, [0.007, 0.009, 0.017])
    >>> table["exists"].sum(axis=1), table["stable"][:, 0]
    (array([0, 2, 1]), array([False, False, True]))
    """
    if isinstance(period, bool) or not isinstance(period, int) or period < 1 or period % 2 == 0:
        raise ParameterError(f"period is {period!r}, allowed is 1, 3, 5, …: a symmetric orbit has an odd period")
    given = {"mu": mu, "A": A, "Omega": Omega, "r": r, "lam": lam}
    columns = np.broadcast_arrays(*(_numbers(name, value) for name, value in given.items()))
    shape = columns[0].shape
    points = np.stack([column.ravel() for column in columns], axis=-1)
    # The extremes of every column stand for the rest: the allowed ranges are intervals, resonance apart.
    for corner in (points.min(axis=0), points.max(axis=0)) if len(points) else ():
        Params(*corner.tolist())
    if (np.hypot(1 - points[:, FREQUENCY] ** 2, points[:, DAMPING] * points[:, FREQUENCY]) <= 1e-9).any():
        raise ParameterError("lam is 0 at Omega = 1, where the response grows without bound; give lam > 0")
    out = np.zeros((len(points), 2), dtype=_ROW)
    _table_kernel(points, period, out)
    return out.reshape(*shape, 2)


def _numbers(name: str, value: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return a number or an array of numbers as an array, or raise `ParameterError`."""
    try:
        if not isinstance(value, str | bytes | bool):
            return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    raise ParameterError(f"{name} is {shown(value)}; give a number or an array of numbers")


@entry_njit
def _table_kernel(points, period, out):
    """Fill the table: the closed form of docs/orbits.md, then one flight of each orbit, the other being its mirror."""
    H = complex_matrix(4, 4)
    multipliers = complex_vector(4)
    for i in range(points.shape[0]):
        mu, A, Omega = points[i, MASS], points[i, AMPLITUDE], points[i, FREQUENCY]
        r, lam = points[i, RESTITUTION], points[i, DAMPING]
        c = constants_kernel(mu, A, Omega, r, lam)
        half = math.pi * period / Omega
        s = complex(-c.free.half, c.free.gamma)
        q = 1.0 / (1.0 + cmath.exp(s * half))
        kappa = reversing_kernel(c.law)
        alpha = 2.0 * c.law.ratio * q.imag / c.free.gamma - half / 2.0
        beta = (kappa + 2.0 * c.law.ratio * ((s * q).imag / c.free.gamma - 1.0)) / Omega
        response = complex(c.free.qr, c.free.qi)
        B2 = c.free.qr**2 + c.free.qi**2
        stiffness = alpha * alpha + beta * beta
        discriminant = B2 * stiffness - beta * beta
        if not discriminant >= 0.0:
            continue
        root = math.sqrt(discriminant)
        outer = -alpha + (root if alpha <= 0.0 else -root)
        one = outer / stiffness
        other = (1.0 - B2) / outer if outer != 0.0 else 0.0
        count = 0
        for V in (max(one, other), min(one, other)):
            if not V > 0.0 or (count == 1 and one == other):
                continue
            row = out[i, count]
            count += 1
            phase = cmath.phase(complex(1.0 + alpha * V, -beta * V) / response) % (2.0 * math.pi)
            x1 = 1.0 - half * V / 2.0
            v1 = kappa * V
            row.exists = True
            row.speed = V
            row.phase = phase
            row.x1 = x1
            row.v1 = v1
            row.w_dot = v1 + V
            J, _, _, _ = jacobian_kernel(mu, A, Omega, r, lam, x1, v1, -V, phase, half)
            for j in range(4):
                for k in range(4):
                    H[j, k] = J[j, k] if j == 3 else -J[j, k]
            eigenvalues_kernel(H, multipliers)
            largest = 0.0
            for k in range(4):
                row.half_multipliers[k] = multipliers[k]
                largest = max(largest, abs(multipliers[k]))
            row.max_multiplier = largest * largest
            row.stable = largest < 1.0
            after, _ = after_impact_kernel(c.law, v1, -V)
            clearance, _, wall = inspect_flight(c, 1.0, 1, x1, after, x1 - 1.0, V, phase, half)
            row.min_clearance = clearance
            row.admissible = wall == 0 and clearance > 0.0
            _, v1_square, v2_square, _, _ = segment_integrals(c, 0.0, x1, after, V, phase, half)
            row.kinetic_ratio = mu * v2_square / v1_square
            row.max_abs_x1, _ = largest_displacement(c, 0.0, x1, after, phase, 0.0, half, abs(x1))
