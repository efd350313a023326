"""Parameters of an oscillator with balls in parallel cavities."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import Any

from vines.errors import ParameterError
from vines.model import Parameters, System, most_balls, read_system

__all__ = ["Parallel"]

_MOST = most_balls("parallel")
_ONE = read_system("parallel", 1, digest="af6a3d8b2cb1fdce")
_OF_A_BALL = ("mu", "beta", "r")


def _default(name: str) -> Any:
    return field(default=_ONE.parameter(name).default)


@dataclass(frozen=True, slots=True, init=False)
class Parallel(Parameters):
    """One oscillator with one to eight balls, each in a cavity of its own, level or tilted; validated and immutable.

    Parameters
    ----------
    mu : sequence of float
        Ratio m/M of the mass of each ball to that of the oscillator, >= 0; as many as there are balls.
    beta : sequence of float, or float
        Half the length of each cavity over b, > 0; one number stands for all. Default 1.
    r : sequence of float, or float
        Coefficient of restitution of each ball, 0 <= r <= 1. Default .65.
    A : float
        Forcing amplitude E/b, >= 0.
    Omega : float
        Ratio omega/omega0, > 0. Default 1.
    lam : float
        Damping c/(M omega0), 0 <= lam < 2. Default computed from Table 1 of the paper.
    G : float
        Gravity along the cavities, g sin(tilt)/(b omega0^2), towards the ends L if > 0. Default 0: level.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range, or there are not as many of each as balls.

    Notes
    -----
    With one ball it is the vibro-impact nonlinear energy sink, and with G the tilted one. The order of arrays is that
    of the declaration: A, Omega, lam, G, then mu, beta and r of all balls.

    Examples
    --------
    >>> q = Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.03)
    >>> print(q)
    A = 0.03, Omega = 1, lam = 0.011998, G = 0, mu = 0.01, 0.01, beta = 1, 1.4, r = 0.65, 0.65 (dimensionless)
    >>> q.balls, q.as_dict()["beta_2"], q.replace(mu_2=0.02).mu
    (2, 1.4, (0.01, 0.02))

    The rig of Table 1 with two balls, tilted by one degree:

    >>> Parallel.from_physical(m=(0.03, 0.02), E=0.3e-3, omega=55.39, tilt=1.0).G
    0.0037...
    """

    A: float
    Omega: float = _default("Omega")
    lam: float = _default("lam")
    G: float = _default("G")
    mu: tuple[float, ...]
    beta: tuple[float, ...] = (1.0,)
    r: tuple[float, ...] = (0.65,)

    def __init__(
        self,
        mu: Sequence[float],
        A: float,
        beta: Sequence[float] | float = 1.0,
        r: Sequence[float] | float = 0.65,
        Omega: float = 1.0,
        lam: float = _ONE.parameter("lam").default or 0.0,
        G: float = 0.0,
    ) -> None:
        masses = _listed("mu", mu)
        balls = len(masses)
        if not 1 <= balls <= _MOST:
            raise ParameterError(f"mu has {balls} values, allowed are 1 to {_MOST}: one a ball")
        given: dict[str, Any] = {"A": A, "Omega": Omega, "lam": lam, "G": G, "mu": masses}
        for name, value in (("beta", beta), ("r", r)):
            several = _listed(name, value)
            if len(several) not in (1, balls):
                raise ParameterError(f"{name} has {len(several)} values for {balls} balls; give one, or one a ball")
            given[name] = several * balls if len(several) == 1 else several
        system = read_system("parallel", balls)
        for name, value in given.items():
            checked = (
                tuple(system.parameter(f"{name}_{k}").check(each) for k, each in enumerate(value, start=1))
                if name in _OF_A_BALL
                else system.parameter(name).check(value)
            )
            object.__setattr__(self, name, checked)

    @property
    def balls(self) -> int:
        """How many balls there are."""
        return len(self.mu)

    @property
    def system(self) -> System:
        """The declaration with so many balls."""
        return read_system("parallel", self.balls)

    @classmethod
    def declared(cls, balls: int = 0) -> System:
        """Return the declaration with so many balls."""
        return read_system("parallel", max(balls, 1))

    @property
    def alike(self) -> tuple[tuple[int, ...], ...]:
        """Numbers of the balls that are equal to each other in mass, length and restitution.

        Examples
        --------
        >>> Parallel(mu=(0.01, 0.02, 0.01), A=0.03).alike
        ((1, 3),)
        """
        return _groups(zip(self.mu, self.beta, self.r, strict=True))

    @property
    def together(self) -> tuple[tuple[int, ...], ...]:
        """Numbers of the balls that move as one for ever once they have one state: of one length and restitution.

        Examples
        --------
        >>> Parallel(mu=(0.01, 0.02, 0.01), beta=(1.0, 1.0, 1.2), A=0.03).together
        ((1, 2),)
        """
        return _groups(zip(self.beta, self.r, strict=True))

    def __str__(self) -> str:
        shown = (
            ", ".join(f"{each:.6g}" for each in value) if isinstance(value, tuple) else f"{value:.6g}"
            for value in (getattr(self, each.name) for each in fields(self))
        )
        named = (f"{each.name} = {text}" for each, text in zip(fields(self), shown, strict=True))
        return ", ".join(named) + " (dimensionless)"


def _groups(balls: Iterable[tuple[float, ...]]) -> tuple[tuple[int, ...], ...]:
    """Return the numbers of those that are equal, of each kind of which there are several."""
    groups: dict[tuple[float, ...], list[int]] = {}
    for number, ball in enumerate(balls, start=1):
        groups.setdefault(ball, []).append(number)
    return tuple(tuple(group) for group in groups.values() if len(group) > 1)


def _listed(name: str, value: object) -> tuple[Any, ...]:
    if isinstance(value, Real) or getattr(value, "ndim", 1) == 0:
        return (value,)
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise ParameterError(f"{name} is {value!r}; give a number for each ball")
    return tuple(value)
