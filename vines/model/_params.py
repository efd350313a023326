"""Dimensionless parameters of the vibro-impact nonlinear energy sink."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields, replace

from vines.errors import ParameterError, nearest

__all__ = ["LAM_TABLE_1", "PARAMETER_NAMES", "Params"]

LAM_TABLE_1 = 2.53 / math.sqrt(11680.0 * 3.807)
"""c/(M omega0) from Table 1 of the paper, .0119979670…; the paper prints the truncated .01199."""

PARAMETER_NAMES = ("mu", "A", "Omega", "r", "lam")


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
    Omega: float = 1.0
    r: float = 0.65
    lam: float = LAM_TABLE_1

    def __post_init__(self) -> None:
        for name in PARAMETER_NAMES:
            object.__setattr__(self, name, finite(name, getattr(self, name)))
        _require("mu", self.mu, self.mu > 0, "mu > 0", "mu is the mass ratio m/M")
        _require("A", self.A, self.A >= 0, "A >= 0", "a negative amplitude is a phase shift of half a period")
        _require("Omega", self.Omega, self.Omega > 0, "Omega > 0", "Omega is the frequency ratio omega/omega0")
        _require("r", self.r, 0 <= self.r <= 1, "0 <= r <= 1", "r is the coefficient of restitution")
        _require("lam", self.lam, 0 <= self.lam < 2, "0 <= lam < 2", "the oscillator must be underdamped")

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
            if name not in PARAMETER_NAMES:
                raise ParameterError(f"unknown parameter {name!r}: {nearest(name, PARAMETER_NAMES)}")
        return replace(self, **changes)

    def as_dict(self) -> dict[str, float]:
        """Return the parameters by name, in the order mu, A, Omega, r, lam."""
        return asdict(self)

    def __str__(self) -> str:
        return ", ".join(f"{f.name} = {getattr(self, f.name):.6g}" for f in fields(self)) + " (dimensionless)"


def finite(name: str, value: object, unit: str = "") -> float:
    """Return a value as a float, or raise `ParameterError` if it is not a finite number."""
    try:
        number = math.nan if isinstance(value, bool | str) else float(value)  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        shown = " ".join(repr(value).split())
        raise ParameterError(f"{name} is {shown}; give a finite number{unit and f' in {unit}'}")
    return number


def _require(name: str, value: float, holds: bool, allowed: str, why: str) -> None:
    if not holds:
        raise ParameterError(f"{name} is {value:g}, allowed is {allowed}: {why}")
