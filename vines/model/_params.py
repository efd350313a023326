"""Dimensionless parameters of the vibro-impact nonlinear energy sink."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from vines.model._vi_nes import VI_NES

__all__ = ["Params"]


def _default(name: str) -> Any:
    return field(default=VI_NES.parameter(name).default)


@dataclass(frozen=True, slots=True)
class Params:
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

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    lam: float = _default("lam")

    def __post_init__(self) -> None:
        for parameter in VI_NES.parameters:
            object.__setattr__(self, parameter.name, parameter.check(getattr(self, parameter.name)))

    @property
    def period(self) -> float:
        """Forcing period T = 2 pi/Omega (dimensionless time)."""
        return 2 * math.pi / self.Omega

    def replace(self, **changes: float) -> Params:
        """Return a copy with some parameters changed.

        Raises
        ------
        ParameterError
            If a name is not a parameter or a value is out of range.

        Examples
        --------
        >>> Params(mu=0.01, A=0.02).replace(A=0.03).A
        0.03
        """
        for name in changes:
            VI_NES.parameter(name)
        return replace(self, **changes)

    def as_dict(self) -> dict[str, float]:
        """Return the parameters by name, in the order mu, A, Omega, r, lam."""
        return asdict(self)

    def __str__(self) -> str:
        return ", ".join(f"{f.name} = {getattr(self, f.name):.6g}" for f in fields(self)) + " (dimensionless)"
