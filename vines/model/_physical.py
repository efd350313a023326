"""Physical parameters in SI units and their way to and from the dimensionless ones."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from vines.errors import ParameterError
from vines.model._params import Params
from vines.model._vi_nes import VI_NES

__all__ = ["PhysicalParams"]


def _default(name: str) -> Any:
    return field(default=next(each.default for each in VI_NES.rig if each.name == name))


@dataclass(frozen=True, slots=True)
class PhysicalParams:
    """The rig in SI units; the defaults are Table 1 of the paper.

    Parameters
    ----------
    M : float
        Mass of the linear oscillator [kg], > 0.
    c : float
        Damping coefficient [N s/m], >= 0.
    k : float
        Linear stiffness [N/m], > 0.
    b : float
        Half the length of the cavity [m], > 0.
    r : float
        Coefficient of restitution [1], between 0 and 1.

    Raises
    ------
    ParameterError
        If a value is out of its range.

    Examples
    --------
    >>> si = PhysicalParams()
    >>> round(si.omega0, 4), round(si.lam, 7)
    (55.3898, 0.011998)
    >>> p = si.dimensionless(E=0.3e-3, omega=si.omega0, m=0.03807)
    >>> round(p.A, 12), round(p.mu, 12), p.Omega
    (0.02, 0.01, 1.0)
    >>> print(si)
    M = 3.807 kg, c = 2.53 N s/m, k = 11680 N/m, b = 0.015 m, r = 0.65; omega0 = 55.3898 rad/s
    """

    M: float = _default("M")
    c: float = _default("c")
    k: float = _default("k")
    b: float = _default("b")
    r: float = _default("r")

    def __post_init__(self) -> None:
        for each in VI_NES.rig:
            object.__setattr__(self, each.name, each.check(getattr(self, each.name)))
        if self.lam >= 2:
            most = 2 * math.sqrt(self.k * self.M)
            raise ParameterError(
                f"c is {self.c:g} N s/m, allowed is c < {most:g} N s/m: the oscillator must be underdamped"
            )

    @property
    def omega0(self) -> float:
        """Natural frequency sqrt(k/M) [rad/s] (paper, eq. (6))."""
        return math.sqrt(self.k / self.M)

    @property
    def lam(self) -> float:
        """Dimensionless damping c/(M omega0) (paper, eq. (6)), as c/sqrt(k M)."""
        return self.c / math.sqrt(self.k * self.M)

    def dimensionless(self, *, E: float, omega: float, m: float) -> Params:
        """Return the dimensionless parameters of one experiment.

        Parameters
        ----------
        E : float
            Amplitude of the base displacement [m].
        omega : float
            Angular frequency of the base [rad/s].
        m : float
            Mass of the ball [kg].

        Raises
        ------
        ParameterError
            If a dimensionless parameter comes out of its range.
        """
        E, omega, m = (each.check(value) for each, value in zip(VI_NES.run, (E, omega, m), strict=True))
        return Params(mu=m / self.M, A=E / self.b, Omega=omega / self.omega0, r=self.r, lam=self.lam)

    def physical(self, p: Params) -> dict[str, float]:
        """Return E [m], omega [rad/s], m [kg] of dimensionless parameters on this rig: the inverse of `dimensionless`.

        Raises
        ------
        ParameterError
            If r or lam of `p` are not those of this rig (to 1e-9).

        Examples
        --------
        >>> {k: round(v, 6) for k, v in PhysicalParams().physical(Params(mu=0.01, A=0.02, Omega=1)).items()}
        {'E': 0.0003, 'omega': 55.389824, 'm': 0.03807}
        """
        for name in ("r", "lam"):
            ours, theirs = getattr(self, name), getattr(p, name)
            if abs(ours - theirs) > 1e-9:
                raise ParameterError(f"{name} of the parameters is {theirs:g}, of this rig {ours:g}; they must agree")
        return {"E": p.A * self.b, "omega": p.Omega * self.omega0, "m": p.mu * self.M}

    def displacement(self, x: float) -> float:
        """Return q = b x [m] of a dimensionless displacement x."""
        return self.b * x

    def velocity(self, v: float) -> float:
        """Return b omega0 v [m/s] of a dimensionless velocity v."""
        return self.b * self.omega0 * v

    def time(self, t: float) -> float:
        """Return tau = t/omega0 [s] of a dimensionless time t (paper, eq. (7))."""
        return t / self.omega0

    def __str__(self) -> str:
        listed = ", ".join(
            f"{each.name} = {getattr(self, each.name):g}" + ("" if each.unit == "1" else f" {each.unit}")
            for each in VI_NES.rig
        )
        return f"{listed}; omega0 = {self.omega0:.4f} rad/s"
