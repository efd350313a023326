"""Scatter as in a real rig: restitution drawn at each impact, noise of the base, units that are not alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from vines.bounds import check_count, check_hold, check_number, shown
from vines.dynamics._coloured import held_halves
from vines.dynamics._random import normal
from vines.errors import ParameterError, nearest
from vines.model import DAMPING, FREQUENCY, Range, System

__all__ = ["BEGUN", "OrnsteinUhlenbeck", "Scatter"]

Floats = npt.NDArray[np.float64]

_LARGEST = 1e6
"""Largest number of a scatter; all are of order one."""

_UNITS = 1 << 42
"""Number of the first draw for what a unit is: those of a run have smaller ones."""

_TRIES = 1000
"""Draws of a unit before it is said that there is none."""

NUMBERS_OF_SCATTER, BEGUN = 18, 10
"""Numbers of a run that a kernel needs, and which of them is the coloured force at its begin [A], nan if drawn."""


@dataclass(frozen=True, slots=True)
class OrnsteinUhlenbeck:
    """A random force with a memory: the stationary Gaussian process of covariance sigma^2 exp(-|t|/correlation_time).

    Parameters
    ----------
    sigma : float
        Its standard deviation, in units of A.
    correlation_time : float
        Time after which the covariance has fallen to 1/e, in forcing periods.

    Raises
    ------
    ParameterError
        If a number is not finite, `sigma` is negative, or `correlation_time` is not positive.
    """

    sigma: float
    correlation_time: float

    def __post_init__(self) -> None:
        check_number("ou.sigma", self.sigma, least=0.0, most=_LARGEST, error=ParameterError)
        check_number("ou.correlation_time", self.correlation_time, least=1e-6, most=_LARGEST, error=ParameterError)


@dataclass(frozen=True, slots=True)
class Scatter:
    """What varies from impact to impact, in the base and from unit to unit, with the seed of the draws.

    Parameters
    ----------
    sigma_r : float
        Standard deviation of the restitution; each impact has r - r_speed |w'| + sigma_r g, cut to [0, 1], g normal.
    r_speed : float
        Decrease of the restitution with the relative speed before impact.
    noise : float
        Standard deviation of a random force on the oscillator, in units of A, held for a part of a period.
    hold : int
        How often in a forcing period that force is drawn, and the phase changed; a coloured force is exact at every
        second of these times.
    second : float
        Amplitude of the second harmonic of the base, in units of A.
    second_phase : float
        Its phase when that of the first is 0 [rad].
    phase_diffusion : float
        Standard deviation [rad] of what a forcing period adds to the phase of the base: a Brownian motion that changes
        `hold` times in a period.
    ou : OrnsteinUhlenbeck or mapping, optional
        A coloured random force on the oscillator, ``{"sigma": .01, "correlation_time": 2}``.
    spread : mapping
        Manufacturing: the standard deviation of a parameter from unit to unit as a share of its value, such as
        ``{"mu": .02, "r": .01}``. Each run is a unit; draws that a parameter cannot have are drawn again.
    seed : int
        Seed; trajectory k draws from the stream (seed, k), whatever runs beside it.

    Raises
    ------
    ParameterError
        If a number is not finite, a standard deviation negative, or `hold` or `seed` out of range.

    Examples
    --------
    >>> Scatter(sigma_r=0.02, seed=7).seed
    7
    >>> Scatter(ou={"sigma": 0.01, "correlation_time": 2}).ou
    OrnsteinUhlenbeck(sigma=0.01, correlation_time=2)
    """

    sigma_r: float = 0.0
    r_speed: float = 0.0
    noise: float = 0.0
    hold: int = 32
    second: float = 0.0
    second_phase: float = 0.0
    phase_diffusion: float = 0.0
    ou: OrnsteinUhlenbeck | Mapping[str, float] | None = None
    spread: Mapping[str, float] = field(default_factory=dict, hash=False)
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("sigma_r", "r_speed", "noise", "second", "second_phase", "phase_diffusion"):
            least = -_LARGEST if name in ("r_speed", "second_phase") else 0.0
            check_number(name, getattr(self, name), least=least, most=_LARGEST, error=ParameterError)
        check_count("hold", self.hold, most=4096, error=ParameterError)
        check_count("seed", self.seed, least=0, most=2**53 - 1, error=ParameterError)
        object.__setattr__(self, "ou", _coloured(self.ou))
        if not isinstance(self.spread, Mapping):
            raise ParameterError(f"spread is {shown(self.spread)}; give shares by parameter, such as {{'mu': 0.02}}")
        for name, share in self.spread.items():
            check_number(f"spread.{name}", share, least=0.0, most=1.0, error=ParameterError)

    @property
    def coloured(self) -> OrnsteinUhlenbeck | None:
        """The coloured force, if there is one."""
        return self.ou if isinstance(self.ou, OrnsteinUhlenbeck) and self.ou.sigma > 0.0 else None

    @property
    def parts(self) -> tuple[str, ...]:
        """What of it is not left out, by name.

        Examples
        --------
        >>> Scatter(sigma_r=0.1, ou={"sigma": 0.0, "correlation_time": 1.0}, spread={"r": 0.01}).parts
        ('sigma_r', 'spread')
        """
        numbers = ("sigma_r", "r_speed", "noise", "second", "phase_diffusion")
        found = [name for name in numbers if getattr(self, name) != 0.0]
        found += ["ou"] if self.coloured is not None else []
        return (*found, *(["spread"] if any(self.spread.values()) else []))

    def scaled(self, level: float) -> Scatter:
        """Return the same with all that is drawn so many times as large.

        Examples
        --------
        >>> Scatter(sigma_r=0.01, second=0.1, ou={"sigma": 0.1, "correlation_time": 2.0}).scaled(2.0).parts
        ('sigma_r', 'second', 'ou')
        """
        numbers = {name: level * getattr(self, name) for name in ("sigma_r", "noise", "phase_diffusion")}
        ou = None if self.coloured is None else replace(self.coloured, sigma=level * self.coloured.sigma)
        return replace(self, **numbers, ou=ou, spread={name: level * share for name, share in self.spread.items()})

    def numbers(self, table: Floats) -> Floats:
        """Return what the kernel needs of runs with these parameters, shape (n, NUMBERS_OF_SCATTER).

        Raises
        ------
        ParameterError
            If a step of the coloured force would be too long.
        """
        own = [self.sigma_r, self.r_speed, self.noise, self.hold, self.second, self.second_phase, self.seed]
        out = np.zeros((len(table), NUMBERS_OF_SCATTER))
        out[:, : len(own)] = own
        out[:, len(own)] = self.phase_diffusion / math.sqrt(self.hold)
        out[:, BEGUN] = math.nan
        if (ou := self.coloured) is None:
            return out
        known: dict[tuple[float, float], Floats] = {}
        for row, values in zip(out, table, strict=True):
            lam, Omega = float(values[DAMPING]), float(values[FREQUENCY])
            if (lam, Omega) not in known:
                check_hold(self.hold, Omega)
                step = 4.0 * math.pi / (Omega * self.hold)
                time = ou.correlation_time * 2.0 * math.pi / Omega
                known[lam, Omega] = np.array([ou.sigma, step / time, math.nan, *held_halves(lam, step, time)])
            row[len(own) + 1 :] = known[lam, Omega]
        return out

    def units(self, system: System, table: Floats, first: int = 0) -> Floats:
        """Return parameters, shape (n, d), with the spread of the units `first`, `first` + 1, … .

        Raises
        ------
        ParameterError
            If a name is not a parameter of the system, or no unit can be drawn.
        """
        names = [each.name for each in system.parameters]
        out = table.copy()
        for name, share in self.spread.items():
            if name not in names:
                raise ParameterError(f"spread: unknown parameter {name!r}: {nearest(name, names)}")
            k = names.index(name)
            allowed = system.parameters[k].allowed
            for row, number in zip(out, range(first, first + len(out)), strict=True):
                row[k] = self._unit(row[k], share, number, k, name, allowed)
        return out

    def _unit(self, value: float, share: float, number: int, k: int, name: str, allowed: Range) -> float:
        for turn in range(_TRIES):
            drawn = value * (1.0 + share * normal(self.seed, number, _UNITS + _TRIES * k + turn))
            if allowed.holds(drawn):
                return drawn
        raise ParameterError(f"spread.{name} is {share:g}: no allowed {name} was drawn around {value:g}; give less")


def _coloured(ou: OrnsteinUhlenbeck | Mapping[str, float] | None) -> OrnsteinUhlenbeck | None:
    """Return a coloured force from what was given."""
    if ou is None or isinstance(ou, OrnsteinUhlenbeck):
        return ou
    if not isinstance(ou, Mapping) or set(ou) != {"sigma", "correlation_time"}:
        raise ParameterError(f"ou is {shown(ou)}; give {{'sigma': 0.01, 'correlation_time': 2.0}}")
    return OrnsteinUhlenbeck(**ou)
