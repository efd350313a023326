"""Parameters of a VI-NES whose ball slides with Coulomb friction."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from vines.model import Parameters, System, read_system

__all__ = ["Friction"]

_SYSTEM = read_system("friction", digest="9b71b95ba2ee5468")


def _default(name: str) -> Any:
    return field(default=_SYSTEM.parameter(name).default)


@dataclass(frozen=True, slots=True)
class Friction(Parameters):
    """One oscillator with one ball that slides in its cavity with Coulomb friction; validated and immutable.

    ``x2'' = f sgn(w') - G`` while the ball slides, and the oscillator feels ``- mu f sgn(w')``. Where w' = 0 the ball
    stops in the cavity and rides along as long as ``|x1'' + G| <= f``. With f = G = 0 it is the vibro-impact nonlinear
    energy sink.

    Parameters
    ----------
    mu : float
        Mass ratio m/M, >= 0.
    A : float
        Forcing amplitude E/b, >= 0.
    Omega : float
        Ratio omega/omega0, > 0. Default 1.
    r : float
        Coefficient of restitution, 0 <= r <= 1. Default .65.
    lam : float
        Damping c/(M omega0), 0 <= lam < 2. Default computed from Table 1 of the paper.
    f : float
        Friction over the mass of the ball, force/(m b omega0^2), >= 0; static and kinetic alike. Default 0.
    G : float
        Gravity along the cavity, g sin(tilt)/(b omega0^2), towards the end L if > 0. Default 0: level.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range.

    Examples
    --------
    >>> p = Friction(mu=0.02, A=0.03, f=0.01)
    >>> p.mirrored, p.replace(G=0.01).mirrored
    (True, False)

    The rig of Table 1 with a ball of 76 g that 10 mN hold:

    >>> round(Friction.from_physical(m=0.076, E=0.3e-3, omega=55.39, friction=0.01).f, 5)
    0.00286
    """

    DECLARATION: ClassVar[System] = _SYSTEM

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    lam: float = _default("lam")
    f: float = _default("f")
    G: float = _default("G")
