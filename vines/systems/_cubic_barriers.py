"""Parameters of an oscillator with a mass on a cubic spring, between barriers or without."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from vines.errors import ParameterError
from vines.model import Parameters, System, read_system

__all__ = ["CubicBarriers"]

_SYSTEM = read_system("cubic_barriers", digest="38beb3372390a001")


def _default(name: str) -> Any:
    return field(default=_SYSTEM.parameter(name).default)


@dataclass(frozen=True, slots=True)
class CubicBarriers(Parameters):
    """An oscillator with a mass on a spring, whose way barriers may limit; validated and immutable.

    The spring gives the mass ``x2'' = k1 w + k3 w³ + l2 w'`` with w = x1 - x2, and pulls the oscillator back with mu
    times that. An impact on w = 1 or w = -1 turns w' into ``-r w'`` and keeps momentum.

    Parameters
    ----------
    mu : float
        Ratio m/M of the mass on the spring to that of the oscillator, > 0.
    A : float
        Forcing amplitude E/b, >= 0.
    Omega : float
        Ratio omega/omega0, > 0. Default 1.
    r : float
        Coefficient of restitution, 0 <= r <= 1. Default .65.
    lam : float
        Damping c/(M omega0), 0 <= lam < 2. Default computed from Table 1 of the paper.
    k1, k3 : float
        Linear and cubic stiffness; k3 >= 0, k1 may be negative. Default 0.
    l2 : float
        Damping beside the spring, >= 0. Default 0.
    walls : bool
        Whether there are barriers. Default True.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range.

    Notes
    -----
    With k1 = k3 = l2 = 0 it is the vibro-impact nonlinear energy sink, without barriers a cubic one. No closed form
    gives its motion: it runs by Taylor series (docs/dynamics.md, "Taylor series").

    Examples
    --------
    >>> p = CubicBarriers(mu=0.02, A=0.03, k3=1.0, l2=0.2)
    >>> p.k3, p.replace(walls=False).walls
    (1.0, 0.0)
    >>> print(CubicBarriers.from_physical(m=0.076, E=0.3e-3, omega=55.39, cubic=1.04e6, damper=0.84, walls=True).k3)
    1.003...
    """

    DECLARATION: ClassVar[System] = _SYSTEM

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    lam: float = _default("lam")
    k1: float = _default("k1")
    k3: float = _default("k3")
    l2: float = _default("l2")
    walls: float = _default("walls")

    def __post_init__(self) -> None:
        if isinstance(self.walls, bool):
            object.__setattr__(self, "walls", float(self.walls))
        Parameters.__post_init__(self)
        if self.walls not in (0.0, 1.0):
            raise ParameterError(f"walls is {self.walls:g}, allowed are 1 and 0: there are barriers or there are none")
        if self.k1 < 0 and self.k3 == 0 and not self.walls:
            raise ParameterError(f"k1 is {self.k1:g} without barriers, give k1 >= 0 or k3 > 0: nothing holds it")
