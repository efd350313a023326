"""The contact of ball and wall: a soft Hertzian spring with a loss that gives the restitution asked for.

The law is Hunt and Crossley's, F = K d^(3/2) (1 + chi d'), for an indentation d (Hunt & Crossley 1975). Of two free
masses with the reduced mass M m / (M + m) the equation separates, so that with a = chi v the speed v of approach and
the restitution r obey, whatever K,

    a (1 + r) = ln((1 + a)/(1 - r a)),

which is solved here instead of the small-loss formulas chi = 3 (1 - r)/(2 v) in use, which miss r = .65 by a tenth.
K sets only how long the contact lasts.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

__all__ = ["damping", "damping_table", "duration", "stiffness"]

LEAST, MOST = 0.05, 0.995
"""Restitutions that the law is asked for; draws beyond are put there."""


def damping(r: float) -> float:
    """Return a = chi v, the damping of the contact times the speed of approach, that gives a restitution.

    Parameters
    ----------
    r : float
        Coefficient of restitution, from 0.05 to 0.995.

    Examples
    --------
    >>> a = damping(0.65)
    >>> bool(abs(a * (1 + 0.65) - np.log((1 + a) / (1 - 0.65 * a))) < 1e-12)
    True
    """

    def excess(a: float) -> float:
        return a * (1 + r) - np.log1p(a) + np.log1p(-r * a)

    # The excess vanishes at a = 0 too; with little loss its other root is near this value, else beyond it.
    near = 1.5 * (1 - r * r) / (1 + r**3)
    root: Any = brentq(excess, 0.5 * near, (1 - 1e-15) / r, xtol=1e-15, rtol=np.float64(1e-14))
    return float(root)


@functools.cache
def damping_table(count: int = 1024) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return restitutions, evenly spaced, and the damping of each, for interpolation in the kernel."""
    r = np.linspace(LEAST, MOST, count)
    return r, np.array([damping(each) for each in r])


@functools.cache
def duration(r: float) -> float:
    """Return how long a contact lasts in units of l/v, l^(5/2) = m v^2/K, for a restitution.

    Without loss it is Hertz's 2.9432 (5/4)^(2/5) = 3.218.

    Examples
    --------
    >>> round(duration(0.995), 2)
    3.22
    """
    a = damping(r)

    def motion(_: float, y: npt.NDArray[np.float64]) -> list[float]:
        d = max(y[0], 0.0)
        return [y[1], -(d**1.5) * (1 + a * y[1])]

    def apart(_: float, y: npt.NDArray[np.float64]) -> float:
        return y[0]

    apart.terminal = True  # type: ignore[attr-defined]
    apart.direction = -1  # type: ignore[attr-defined]
    end = solve_ivp(motion, (0.0, 100.0), [0.0, 1.0], events=apart, rtol=1e-10, atol=1e-13, max_step=0.05)
    return float(end.t_events[0][0])


def stiffness(contact_time: float, speed: float, r: float, reduced_mass: float) -> float:
    """Return the stiffness K [N/m^1.5] for which a contact lasts a given time.

    Parameters
    ----------
    contact_time : float
        How long a contact at that speed and restitution shall last [s].
    speed : float
        Speed of approach [m/s].
    r : float
        Restitution.
    reduced_mass : float
        M m / (M + m) [kg].
    """
    length = speed * contact_time / duration(r)
    return reduced_mass * speed**2 / length**2.5
