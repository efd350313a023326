"""Parameters of an oscillator with a ball in a cavity and a mass on a cubic spring beside it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from vines.errors import ParameterError
from vines.model import Parameters, System, read_system

__all__ = ["Hybrid"]

_SYSTEM = read_system("hybrid", digest="e2e3a6ac2a4fb047")


def _default(name: str) -> Any:
    return field(default=_SYSTEM.parameter(name).default)


@dataclass(frozen=True, slots=True)
class Hybrid(Parameters):
    """An oscillator with a ball in a cavity and, beside it, a mass on a cubic spring; validated and immutable.

    The ball is that of the vibro-impact nonlinear energy sink. The spring gives the mass
    ``x3'' = k1 u + k3 u³ + l2 u'`` with u = x1 - x3, and pulls the oscillator back with mu_n times that; nothing limits
    its way.

    Parameters
    ----------
    mu : float
        Ratio m/M of the mass of the ball to that of the oscillator, >= 0.
    A : float
        Forcing amplitude E/b, >= 0.
    Omega : float
        Ratio omega/omega0, > 0. Default 1.
    r : float
        Coefficient of restitution of the ball, 0 <= r <= 1. Default .65.
    lam : float
        Damping c/(M omega0), 0 <= lam < 2. Default computed from Table 1 of the paper.
    mu_n : float
        Ratio m_n/M of the mass on the spring to that of the oscillator, >= 0. Default 0.
    k1, k3 : float
        Linear and cubic stiffness; k3 >= 0, k1 may be negative where k3 > 0. Default 0.
    l2 : float
        Damping beside the spring, >= 0. Default 0.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range.

    Notes
    -----
    With mu_n = 0 it is the vibro-impact nonlinear energy sink. No closed form gives its motion: it runs by Taylor
    series (docs/dynamics.md, "A ball beside a spring").

    Examples
    --------
    >>> p = Hybrid(mu=0.01, A=0.03, mu_n=0.01, k3=1.0, l2=0.2)
    >>> print(p)
    mu = 0.01, A = 0.03, Omega = 1, r = 0.65, lam = 0.011998, mu_n = 0.01, k1 = 0, k3 = 1, l2 = 0.2 (dimensionless)

    The rig of Table 1 with a ball of 38 g and a mass of 38 g on a cubic spring:

    >>> print(Hybrid.from_physical(m=0.038, m_n=0.038, E=0.3e-3, omega=55.39, cubic=5.2e5, damper=0.42).k3)
    1.003...
    """

    DECLARATION: ClassVar[System] = _SYSTEM

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    lam: float = _default("lam")
    mu_n: float = _default("mu_n")
    k1: float = _default("k1")
    k3: float = _default("k3")
    l2: float = _default("l2")

    def __post_init__(self) -> None:
        Parameters.__post_init__(self)
        if self.k1 < 0 and self.k3 == 0:
            raise ParameterError(f"k1 is {self.k1:g}, give k1 >= 0 or k3 > 0: nothing holds the mass on the spring")
