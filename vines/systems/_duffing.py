"""Parameters of a VI-NES whose oscillator has a cubic spring."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from vines.model import Parameters, System, read_system

__all__ = ["Duffing"]

_SYSTEM = read_system("duffing", digest="e38d9bb328dfa880")


def _default(name: str) -> Any:
    return field(default=_SYSTEM.parameter(name).default)


@dataclass(frozen=True, slots=True)
class Duffing(Parameters):
    """One Duffing oscillator under base excitation with one ball; validated and immutable.

    ``x1'' + lam x1' + x1 + alpha x1³ = A (sin + lam Omega cos)`` between impacts: the linear spring and the damper
    stand on the base that shakes, the cubic spring on the ground, so that the base does no work on it. With alpha = 0
    it is the vibro-impact nonlinear energy sink.

    Parameters
    ----------
    mu : float
        Mass ratio m/M, > 0.
    A : float
        Forcing amplitude E/b, >= 0.
    Omega : float
        Ratio omega/omega0, > 0, with omega0 that of small motions. Default 1.
    r : float
        Coefficient of restitution, 0 <= r <= 1. Default .65.
    lam : float
        Damping c/(M omega0), 0 <= lam < 2. Default computed from Table 1 of the paper.
    alpha : float
        Cubic stiffness c3 b²/k, 0 <= alpha <= 1e4: the spring hardens. Default 0.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range.

    Notes
    -----
    No closed form gives its motion: it runs by Taylor series (docs/dynamics.md, "A Duffing frame").

    Examples
    --------
    >>> p = Duffing(mu=0.02, A=0.03, alpha=0.5)
    >>> print(p)
    mu = 0.02, A = 0.03, Omega = 1, r = 0.65, lam = 0.011998, alpha = 0.5 (dimensionless)

    The rig of Table 1 with a ball of 76 g and a spring of .026 N/mm³ to the ground:

    >>> Duffing.from_physical(m=0.076, E=0.3e-3, omega=55.39, cubic=2.6e7).alpha
    0.500...
    """

    DECLARATION: ClassVar[System] = _SYSTEM

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    lam: float = _default("lam")
    alpha: float = _default("alpha")
