"""The numbers that every kernel needs, worked out once from the parameters."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._impact_law import ImpactLaw, impact_law_kernel
from vines.kernels import by_type, fused_njit, linked_njit, njit

__all__ = ["Constants", "Oscillator", "ParameterTable", "constants_at", "constants_kernel", "oscillator"]

NARROW = 1.0 / 256.0
"""|i Omega - s| below which motion is written without dividing by it, whatever the amplitude."""

LARGE = 16.0
"""Steady amplitude (half-widths of the cavity) above which it is, too: beyond, a difference of two large parts."""


class Oscillator(NamedTuple):
    """One damped oscillator under the forcing: x = Re u with u' = s u + G, G = g exp(i Omega t), s = -half + i gamma.

    ``gr + i gi`` is g at forcing phase 0, ``qr + i qi`` the steady response to it (not finite at exact resonance),
    ``dr + i di`` the detuning i Omega - s and ``er + i ei`` its inverse; ``reach`` is the time up to which the two
    exponentials are taken as one and a slow factor (0 away from resonance); ``sum`` is Omega + gamma. The n-th
    derivative of u is s^n u + c_n G, c_n the sum of s^(n-1-k) (i Omega)^k over k < n: ``s2r … c6i``.
    """

    half: float
    gamma: float
    inverse: float
    stiffness: float
    gr: float
    gi: float
    qr: float
    qi: float
    dr: float
    di: float
    er: float
    ei: float
    reach: float
    sum: float
    s2r: float
    s2i: float
    c2r: float
    c2i: float
    s3r: float
    s3i: float
    c3r: float
    c3i: float
    s4r: float
    s4i: float
    c4r: float
    c4i: float
    s5r: float
    s5i: float
    c5r: float
    c5i: float
    s6r: float
    s6i: float
    c6r: float
    c6i: float


class Constants(NamedTuple):
    """Parameters, the law of impact, the free and the loaded oscillator, and bounds for certified steps."""

    mu: float
    A: float
    Omega: float
    r: float
    lam: float
    Omega4: float
    Omega5: float
    period: float
    window: float
    near: float
    correction: float
    law: ImpactLaw
    free: Oscillator
    stuck: Oscillator


@fused_njit
def oscillator(mass, A, Omega, lam):
    """Return the `Oscillator` of a mass under the model's forcing; there is one at every valid parameter."""
    half = 0.5 * lam / mass
    gamma = math.sqrt(1.0 / mass - half * half)
    s = complex(-half, gamma)
    io = complex(0.0, Omega)
    g = (A / mass) * complex(lam * Omega, -1.0) / complex(half, Omega + gamma)
    # i Omega - s, without cancellation in Omega - gamma.
    close = (Omega * Omega - 1.0 / mass + half * half) / (Omega + gamma)
    detuning = complex(half, close)
    size = abs(detuning)
    inverse = complex(0.0, 0.0) if size == 0.0 else 1.0 / detuning
    q = complex(math.inf, math.inf) if size == 0.0 else g * inverse
    reach = 0.0
    if size == 0.0:
        reach = math.inf
    elif size < NARROW or abs(q) > LARGE:
        reach = 1.0 / size
    s2 = s * s
    s3 = s2 * s
    s4 = s2 * s2
    c2 = s + io
    c3 = s * c2 + io * io
    c4 = s * c3 + io * io * io
    c5 = s * c4 + io * io * io * io
    s5 = s4 * s
    c6 = s * c5 + io * io * io * io * io
    s6 = s3 * s3
    return Oscillator(
        half,
        gamma,
        1.0 / gamma,
        1.0 / mass,
        g.real,
        g.imag,
        q.real,
        q.imag,
        detuning.real,
        detuning.imag,
        inverse.real,
        inverse.imag,
        reach,
        Omega + gamma,
        s2.real,
        s2.imag,
        c2.real,
        c2.imag,
        s3.real,
        s3.imag,
        c3.real,
        c3.imag,
        s4.real,
        s4.imag,
        c4.real,
        c4.imag,
        s5.real,
        s5.imag,
        c5.real,
        c5.imag,
        s6.real,
        s6.imag,
        c6.real,
        c6.imag,
    )


@linked_njit
def constants_kernel(mu, A, Omega, r, lam):
    """Return the `Constants` at bare parameter values, which must be those of a valid `Params`."""
    mass = 1.0 + mu
    fastest = max(1.0, Omega)
    cube = 1.0 - r * r * r
    return Constants(
        mu,
        A,
        Omega,
        r,
        lam,
        Omega * Omega * Omega * Omega,
        Omega * Omega * Omega * Omega * Omega,
        2.0 * math.pi / Omega,
        2.0 / fastest,
        4e-3 / (fastest * math.sqrt(math.sqrt(fastest))),
        2.0 / 3.0 * mu / (mass * mass) / cube if cube > 0.0 else math.inf,
        impact_law_kernel(mu, r),
        oscillator(1.0, A, Omega, lam),
        oscillator(mass, A, Omega, lam),
    )


class ParameterTable(NamedTuple):
    """Parameters of many runs, one a row; the type of such a table says of which system they are."""

    values: npt.NDArray[np.float64]


@by_type(ParameterTable)
@njit
def constants_at(table, k):
    """Return the constants at row k of a table of parameters."""
    values = table.values
    return constants_kernel(values[k, 0], values[k, 1], values[k, 2], values[k, 3], values[k, 4])
