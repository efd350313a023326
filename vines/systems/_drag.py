"""Parameters of a VI-NES whose ball is dragged by a coil, a harvester."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from vines.model import Parameters, System, read_system

__all__ = ["Drag"]

_SYSTEM = read_system("drag", digest="a58721f26571c4e2")


def _default(name: str) -> Any:
    return field(default=_SYSTEM.parameter(name).default)


@dataclass(frozen=True, slots=True)
class Drag(Parameters):
    """One oscillator with one ball that a coil drags along as it flies; validated and immutable.

    ``x2'' = delta w'`` between impacts, and the oscillator feels ``- mu delta w'``; the power mu delta <w'²> goes to
    the coil and what is connected to it. With delta = 0 it is the vibro-impact nonlinear energy sink.

    Parameters
    ----------
    mu : float
        Mass ratio m/M, 0 <= mu <= 4.
    A : float
        Forcing amplitude E/b, >= 0.
    Omega : float
        Ratio omega/omega0, > 0. Default 1.
    r : float
        Coefficient of restitution, 0 <= r <= 1. Default .65.
    lam : float
        Damping c/(M omega0), 0 <= lam <= .5. Default computed from Table 1 of the paper.
    delta : float
        Drag c_e/(m omega0), 0 <= delta <= 100. Default 0.

    Raises
    ------
    ParameterError
        If a value is not a finite number in its range.

    Examples
    --------
    >>> p = Drag(mu=0.02, A=0.03, delta=0.1)
    >>> print(p)
    mu = 0.02, A = 0.03, Omega = 1, r = 0.65, lam = 0.011998, delta = 0.1 (dimensionless)

    The rig of Table 1 with a ball of 76 g in a coil of 20 N/A that feeds 100 ohm, c_e = 20²/100 N s/m:

    >>> Drag.from_physical(m=0.076, E=0.3e-3, omega=55.39, c_e=0.4).delta
    0.0950...
    """

    DECLARATION: ClassVar[System] = _SYSTEM

    mu: float
    A: float
    Omega: float = _default("Omega")
    r: float = _default("r")
    lam: float = _default("lam")
    delta: float = _default("delta")
