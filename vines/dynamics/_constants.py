"""The numbers that every kernel needs, worked out once from the parameters."""

from __future__ import annotations

import math
from typing import NamedTuple

from vines.errors import ParameterError
from vines.model import Params

__all__ = ["Constants", "Oscillator", "constants"]


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
    mass = 1.0 + p.mu
    free = _oscillator(1.0, p)
    fastest = max(1.0, p.Omega)
    cube = 1.0 - p.r**3
    return Constants(
        mu=p.mu,
        A=p.A,
        Omega=p.Omega,
        r=p.r,
        lam=p.lam,
        keep1=(1.0 - p.r * p.mu) / mass,
        pass1=p.mu * (1.0 + p.r) / mass,
        keep2=(p.mu - p.r) / mass,
        pass2=(1.0 + p.r) / mass,
        Omega4=p.Omega**4,
        detuning=math.hypot(free.half, free.gamma - p.Omega),
        window=0.9 / fastest,
        near=1e-4 / fastest**1.25,
        correction=2.0 / 3.0 * p.mu / mass**2 / cube if cube > 0.0 else math.inf,
        free=free,
        stuck=_oscillator(mass, p),
    )


def _oscillator(mass: float, p: Params) -> Oscillator:
    half = 0.5 * p.lam / mass
    gamma = math.sqrt(1.0 / mass - half * half)
    s = complex(-half, gamma)
    detuning = complex(1.0 - mass * p.Omega**2, p.lam * p.Omega)
    if abs(detuning) < 1e-9:
        raise ParameterError(
            f"lam is {p.lam:g} at the resonance of mass {mass:g}; allowed is lam > 0 there: "
            "without damping the response grows without bound"
        )
    q = p.A * complex(p.lam * p.Omega, -1.0) / detuning
    s2, s3, s4 = s * s, s * s * s, s * s * s * s
    return Oscillator(half, gamma, q.real, q.imag, s2.real, s2.imag, s3.real, s3.imag, s4.real, s4.imag, abs(s))
