"""Parameters of the impact pair, and of the inclined harvester that is one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from vines.model import Parameters, System, read_system

__all__ = ["ImpactPair"]

_SYSTEM = read_system("impact_pair", digest="720738fe1374e969")


def _default(name: str) -> Any:
    return field(default=_SYSTEM.parameter(name).default)


@dataclass(frozen=True, slots=True)
class ImpactPair(Parameters):
    """A capsule that moves as it is driven, with a ball whose mass does not act on it; validated and immutable.

    Between impacts ``w'' = -B sin(theta) + G``, where w is the gap over half the length of the capsule and theta the
    phase of the capsule, which is also the time; an impact on w = 1 or w = -1 turns w' into ``-r w'``.

    Parameters
    ----------
    B : float
        Amplitude of the capsule over half its length, >= 0.
    G : float
        Gravity along the capsule, g sin(tilt)/(b omega^2), towards the lower end L if > 0. Default 0: level.
    r : float
        Coefficient of restitution, 0 <= r <= 1. Default .65.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range.

    Examples
    --------
    >>> p = ImpactPair(B=0.6, G=0.05, r=0.5)
    >>> print(p)
    B = 0.6, G = 0.05, r = 0.5 (dimensionless)
    >>> p.as_array(), p.mirrored, p.replace(G=0).mirrored
    (array([0.6 , 0.05, 0.5 ]), False, True)

    A capsule of 20 cm at 2.5 Hz with a stroke of 6 cm each way, tilted by 10 degrees:

    >>> print(ImpactPair.from_physical(half_length=0.1, omega=15.7, amplitude=0.06, tilt=10, r=0.5))
    B = 0.6, G = 0.0690862, r = 0.5 (dimensionless)
    """

    DECLARATION: ClassVar[System] = _SYSTEM

    B: float
    G: float = _default("G")
    r: float = _default("r")
