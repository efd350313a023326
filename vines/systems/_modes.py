"""Parameters of a structure of several modes with a ball in a cavity at a place of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import Any

from vines.errors import ParameterError
from vines.model import Parameters, System, counted, read_system

__all__ = ["Modes"]

_MOST = counted("modes")[1]
_ONE = read_system("modes", 1, digest="31de62e09bed3d70")
_OF_A_MODE = ("omega", "lam", "phi", "gamma")


def _default(name: str) -> Any:
    return field(default=_ONE.parameter(name).default)


@dataclass(frozen=True, slots=True, init=False)
class Modes(Parameters):
    """A structure of one to six modes whose base is shaken, with a ball in a cavity at a place of it.

    Validated and immutable. ``x1 = e + sum phi_k eta_k`` is where the cavity is, e = A sin(Omega t), and between
    impacts each mode obeys ``eta_k'' + lam_k eta_k' + omega_k² eta_k = -gamma_k e''``; an impulse J on the structure
    at the cavity changes eta_k' by phi_k J.

    Parameters
    ----------
    mu : float
        Mass ratio m/M, >= 0; modes are normalised to the mass M.
    A : float
        Forcing amplitude E/b, >= 0.
    omega : sequence of float
        Frequency of each mode over omega0, > 0; as many as there are modes. Default one mode, 1.
    phi : sequence of float
        Shape of each mode at the cavity; that of the first is not 0. Default 1.
    gamma : sequence of float
        Participation of each mode in a rigid motion of the base. Default 1.
    lam : sequence of float, or float
        Damping 2 zeta_k omega_k of each mode, 0 <= lam_k < 2 omega_k; one number stands for all. Default computed from
        Table 1 of the paper.
    Omega : float
        Ratio omega/omega0, > 0. Default 1.
    r : float
        Coefficient of restitution, 0 <= r <= 1. Default .65.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range, there are not as many of each as modes, a mode is not
        underdamped, or the first does not move the cavity.

    Notes
    -----
    One mode with omega = phi = gamma = 1 is the vibro-impact nonlinear energy sink. The order of arrays is that of the
    declaration: mu, A, Omega, r, then omega, lam, phi and gamma of all modes. For `from_physical` omega is the angular
    frequency of the base, as of other systems; frequencies of modes are omega_1, omega_2, … over omega0.

    Examples
    --------
    >>> p = Modes(mu=0.02, A=0.03, omega=(1.0, 6.27), phi=(2.0, -2.0), gamma=(0.783, 0.434), lam=(0.012, 0.075))
    >>> print(p.replace(lam_2=0.012, gamma_2=0.5))
    mu = 0.02, A = 0.03, Omega = 1, r = 0.65, omega = 1, 6.27, lam = 0.012, 0.012, phi = 2, -2, gamma = 0.783, 0.5 (...
    >>> p.modes, p.as_dict()["omega_2"], p.replace(phi_2=0.0).phi
    (2, 6.27, (2.0, 0.0))

    The rig of Table 1, whose one mode is the oscillator:

    >>> round(Modes.from_physical(m=0.076, E=0.3e-3, omega=55.39, phi=(1.0,), gamma=(1.0,)).A, 6)
    0.02
    """

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    omega: tuple[float, ...] = (1.0,)
    lam: tuple[float, ...] = (_ONE.parameter("lam_1").default or 0.0,)
    phi: tuple[float, ...] = (1.0,)
    gamma: tuple[float, ...] = (1.0,)

    def __init__(
        self,
        mu: float,
        A: float,
        omega: Sequence[float] = (1.0,),
        phi: Sequence[float] = (1.0,),
        gamma: Sequence[float] = (1.0,),
        lam: Sequence[float] | float = _ONE.parameter("lam_1").default or 0.0,
        Omega: float = 1.0,
        r: float = _ONE.parameter("r").default or 0.0,
    ) -> None:
        frequencies = _listed("omega", omega)
        modes = len(frequencies)
        if not 1 <= modes <= _MOST:
            raise ParameterError(f"omega has {modes} values, allowed are 1 to {_MOST}: one a mode")
        given: dict[str, Any] = {"mu": mu, "A": A, "Omega": Omega, "r": r, "omega": frequencies}
        for name, value in (("lam", lam), ("phi", phi), ("gamma", gamma)):
            several = _listed(name, value)
            if name == "lam" and len(several) == 1:
                several *= modes
            if len(several) != modes:
                raise ParameterError(f"{name} has {len(several)} values for {modes} modes; give one a mode")
            given[name] = several
        system = read_system("modes", modes)
        for name, value in given.items():
            checked = (
                tuple(system.parameter(f"{name}_{k}").check(each) for k, each in enumerate(value, start=1))
                if name in _OF_A_MODE
                else system.parameter(name).check(value)
            )
            object.__setattr__(self, name, checked)
        for k, (lam_k, omega_k) in enumerate(zip(self.lam, self.omega, strict=True), start=1):
            if not lam_k < 2 * omega_k:
                raise ParameterError(
                    f"lam_{k} is {lam_k:g}, allowed is lam_{k} < 2 omega_{k} = {2 * omega_k:g}: each mode must be "
                    "underdamped"
                )
        if self.phi[0] == 0:
            raise ParameterError("phi_1 is 0, allowed is phi_1 != 0: give a mode that moves the cavity as the first")

    @property
    def modes(self) -> int:
        """How many modes there are."""
        return len(self.omega)

    @property
    def system(self) -> System:
        """The declaration with so many modes."""
        return read_system("modes", self.modes)

    @classmethod
    def declared(cls, balls: int = 0) -> System:
        """Return the declaration with so many modes."""
        return read_system("modes", max(balls, 1))

    @property
    def mobility(self) -> float:
        """What a unit impulse at the cavity changes its velocity by, sum phi_k²: an inverse mass, in 1/M."""
        return sum(phi * phi for phi in self.phi)

    @property
    def direct(self) -> float:
        """How much of the motion of the base the cavity has beside its modes, 1 - sum phi_k gamma_k."""
        return 1.0 - sum(phi * gamma for phi, gamma in zip(self.phi, self.gamma, strict=True))

    def __str__(self) -> str:
        shown = (
            ", ".join(f"{each:.6g}" for each in value) if isinstance(value, tuple) else f"{value:.6g}"
            for value in (getattr(self, each.name) for each in fields(self))
        )
        named = (f"{each.name} = {text}" for each, text in zip(fields(self), shown, strict=True))
        return ", ".join(named) + " (dimensionless)"


def _listed(name: str, value: object) -> tuple[Any, ...]:
    if isinstance(value, Real) or getattr(value, "ndim", 1) == 0:
        return (value,)
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise ParameterError(f"{name} is {value!r}; give a number for each mode")
    return tuple(value)
