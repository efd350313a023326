"""Dimensionless parameters of the vibro-impact nonlinear energy sink."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from vines.model._parameters import Parameters
from vines.model._system import System
from vines.model._vi_nes import VI_NES

__all__ = ["Params"]


def _default(name: str) -> Any:
    return field(default=VI_NES.parameter(name).default)


@dataclass(frozen=True, slots=True)
class Params(Parameters):
    """Dimensionless parameters (paper, eq. (6)); validated, immutable and hashable.

    Parameters
    ----------
    mu : float
        Ratio m/M of the masses of ball and oscillator, > 0.
    A : float
        Forcing amplitude E/b, >= 0.
    Omega : float
        Ratio omega/omega0 of the frequencies of forcing and oscillator, > 0.
    r : float
        Coefficient of restitution, 0 <= r <= 1. Default .65 (Table 1).
    lam : float
        Damping c/(M omega0), 0 <= lam < 2. Default computed from Table 1. Without damping at Omega = 1 the oscillator
        alone has no steady motion: runs are exact there too, closed forms of periodic orbits refuse it.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range.

    Examples
    --------
    >>> p = Params(mu=0.01, A=0.02, Omega=1.0)
    >>> print(p)
    mu = 0.01, A = 0.02, Omega = 1, r = 0.65, lam = 0.011998 (dimensionless)
    >>> round(p.period, 6)
    6.283185
    """

    DECLARATION: ClassVar[System] = VI_NES

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    lam: float = _default("lam")
