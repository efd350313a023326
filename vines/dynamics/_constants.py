"""The numbers that every kernel needs, worked out once from the parameters."""

from __future__ import annotations

import math
from typing import NamedTuple

from vines.dynamics._jit import njit
from vines.errors import ParameterError
from vines.model import Params

__all__ = ["Constants", "Oscillator", "constants", "constants_kernel"]


class Oscillator(NamedTuple):
    """One damped oscillator under the forcing: x = Re[z exp(s t) + q exp(i Omega t)], s = -half + i gamma.

    ``qr + i qi`` is the response to the forcing at phase 0; ``s2r … s4i`` are powers of s, ``size`` its modulus.
    """

    half: float
    gamma: float
    qr: float
    qi: float
    s2r: float
    s2i: float
    s3r: float
    s3i: float
    s4r: float
    s4i: float
    size: float


class Constants(NamedTuple):
    """Parameters, impact law (paper, eq. (12)), the free and the loaded oscillator, and bounds for certified steps."""

    mu: float
    A: float
    Omega: float
    r: float
    lam: float
    keep1: float
    pass1: float
    keep2: float
    pass2: float
    Omega4: float
    detuning: float
    window: float
    near: float
    correction: float
    free: Oscillator
    stuck: Oscillator


@njit
def _oscillator(mass, A, Omega, lam):
    half = 0.5 * lam / mass
    gamma = math.sqrt(1.0 / mass - half * half)
    s = complex(-half, gamma)
    q = A * complex(lam * Omega, -1.0) / complex(1.0 - mass * Omega * Omega, lam * Omega)
    s2 = s * s
    s3 = s2 * s
    s4 = s2 * s2
    return Oscillator(half, gamma, q.real, q.imag, s2.real, s2.imag, s3.real, s3.imag, s4.real, s4.imag, abs(s))


@njit
def constants_kernel(mu, A, Omega, r, lam):
    """Return the `Constants` at bare parameter values, which must be those of a valid `Params`."""
    mass = 1.0 + mu
    free = _oscillator(1.0, A, Omega, lam)
    fastest = max(1.0, Omega)
    cube = 1.0 - r * r * r
    return Constants(
        mu,
        A,
        Omega,
        r,
        lam,
        (1.0 - r * mu) / mass,
        mu * (1.0 + r) / mass,
        (mu - r) / mass,
        (1.0 + r) / mass,
        Omega * Omega * Omega * Omega,
        math.sqrt(free.half * free.half + (free.gamma - Omega) * (free.gamma - Omega)),
        0.9 / fastest,
        1e-4 / (fastest * math.sqrt(math.sqrt(fastest))),
        2.0 / 3.0 * mu / (mass * mass) / cube if cube > 0.0 else math.inf,
        free,
        _oscillator(mass, A, Omega, lam),
    )


def constants(p: Params) -> Constants:
    """Return the constants of the kernels.

    Raises
    ------
    ParameterError
        If damping vanishes at the resonance of oscillator and stuck ball together, (1 + mu) Omega² = 1.

    Examples
    --------
    >>> c = constants(Params(mu=0.01, A=0.02))
    >>> print(f"{c.keep1 + c.pass1:.3f} {c.free.gamma:.6f}")
    1.000 0.999982
    """
    for mass in (1.0, 1.0 + p.mu):
        if math.hypot(1.0 - mass * p.Omega**2, p.lam * p.Omega) < 1e-9:
            raise ParameterError(
                f"lam is {p.lam:g} at the resonance of mass {mass:g}; allowed is lam > 0 there: "
                "without damping the response grows without bound"
            )
    return constants_kernel(p.mu, p.A, p.Omega, p.r, p.lam)
