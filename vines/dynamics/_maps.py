"""The maps P1–P4 of the paper: from just before an impact to just before the next one, with their Jacobians.

P1: L to R, P2: R to L, P3: L to L, P4: R to R (paper, eqs. (15), (16)). Each is defined on the states whose next
contact is on its wall. Times within a flight count from the impact that begins it: the paper's a1, a2 of eq. (17), in
absolute time, grow with exp(lam t/2) and lose digits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.domains import Number, Numbers, Parameters, Whole, stated
from vines.dynamics._contact import CONTACT, next_contact
from vines.dynamics._flight import phasors
from vines.dynamics._impact_law import after_impact
from vines.dynamics._room import constants
from vines.dynamics._saltation import GAP_TOLERANCE, jacobian_kernel
from vines.errors import StateError
from vines.model import VI_NES, Params

__all__ = ["P1", "P2", "P3", "P4", "Mapped", "impact_map"]

_PERIODS = 1000
"""Forcing periods within which the next contact has to come; a ball that has left a wall drifts to one long before."""


class Mapped(NamedTuple):
    """The image of a state under an impact map.

    Attributes
    ----------
    state : (5,) float array
        x1, v1, x2, v2, t just before the next impact, dimensionless.
    jacobian : (4, 4) float array
        Derivatives of (v1, v2, x2, t) there (rows) by the same before the impact that was mapped (columns).
    """

    state: npt.NDArray[np.float64]
    jacobian: npt.NDArray[np.float64]


@stated(
    p=Parameters(any_system=False),
    side=Whole(least=-1, most=1),
    side_next=Whole(least=-1, most=1),
    state=Numbers(Number(least=-1e12, most=1e12), least=5, most=5),
    phi=Number(least=-1e12, most=1e12),
)
def impact_map(
    p: Params, side: int, side_next: int, state: Sequence[float] | npt.NDArray[np.float64], phi: float = 0.0
) -> Mapped:
    """Map the state just before an impact to that just before the next one.

    Parameters
    ----------
    p : Params
    side, side_next : int
        Walls of the two impacts, +1 for L and -1 for R.
    state : sequence of five floats
        x1, v1, x2, v2, t just before the impact, on the wall `side` and moving towards it.
    phi : float
        Phase of the forcing at t = 0 [rad].

    Returns
    -------
    Mapped
        ``.state`` and ``.jacobian``; feed ``.state`` to the next map to compose them.

    Raises
    ------
    StateError
        If the state is not on `side` and approaching it, or the next contact is not on `side_next`.

    Notes
    -----
    Paper, eqs. (12), (15)–(22); its misprints are in docs/errata.md. The Jacobian is derived in docs/dynamics.md.

    Examples
    --------
    >>> from vines.model import VI_NES, Params
    >>> p = Params(mu=0.1, A=0.3, Omega=1.2)
    >>> right = P1(p, (0.3, 0.3, -0.7, -0.8, 0.0), phi=0.4)
    >>> print(right.state)
    [ 0.28979839 -0.21109942  1.28979839  0.85        2.34093928]
    >>> P3(p, (0.3, 0.3, -0.7, -0.8, 0.0), phi=0.4)
    Traceback (most recent call last):
    vines.errors.StateError: the next contact is on R after 2.34093928, not on L: P3 is not defined here; use P1
    """
    for name, value in (("side", side), ("side_next", side_next)):
        if value not in (1, -1):
            raise StateError(f"{name} is {value!r}; give +1 for L or -1 for R")
    values = np.asarray(state, dtype=np.float64)
    if values.shape != (5,) or not np.isfinite(values).all():
        raise StateError(f"the state is {state!r}; give five finite numbers x1, v1, x2, v2, t")
    x1, v1, x2, v2, t = values.tolist()
    if abs(x1 - x2 - side) > GAP_TOLERANCE:
        raise StateError(f"the gap x1 - x2 is {x1 - x2:.9g}, not side = {side}; give a state on the wall")
    if side * (v1 - v2) <= 0:
        raise StateError(
            f"w' = {v1 - v2:.9g} does not approach {VI_NES.letters([side])}; give the state just before an impact"
        )
    c = constants(p)
    phase = (p.Omega * t + phi) % (2 * math.pi)
    after1, after2 = after_impact(c.law, v1, v2)
    flight = phasors(c.free, c.Omega, x1, after1, phase)
    code, tau, found, _, _ = next_contact(c, flight, x2, after2, side, False, 0.0, _PERIODS * p.period)
    if code != CONTACT:
        raise StateError(f"no contact within {_PERIODS} forcing periods after t = {t:.9g}; there is no map from here")
    if found != side_next:
        raise StateError(
            f"the next contact is on {VI_NES.letters([found])} after {tau:.9g}, not on {VI_NES.letters([side_next])}: "
            f"{_NAME[side, side_next]} is not defined here; use {_NAME[side, found]}"
        )
    J, x1n, v1n, v2n = jacobian_kernel(p.mu, p.A, p.Omega, p.r, p.lam, x1, v1, v2, phase, tau)
    return Mapped(np.array([x1n, v1n, x1n - side_next, v2n, t + tau]), J)


_NAME = {(1, -1): "P1", (-1, 1): "P2", (1, 1): "P3", (-1, -1): "P4"}


def P1(p: Params, state: Sequence[float] | npt.NDArray[np.float64], phi: float = 0.0) -> Mapped:
    """Map from just before an impact on L to just before the next one, on R; see `impact_map`."""
    return impact_map(p, 1, -1, state, phi)


def P2(p: Params, state: Sequence[float] | npt.NDArray[np.float64], phi: float = 0.0) -> Mapped:
    """Map from just before an impact on R to just before the next one, on L; see `impact_map`."""
    return impact_map(p, -1, 1, state, phi)


def P3(p: Params, state: Sequence[float] | npt.NDArray[np.float64], phi: float = 0.0) -> Mapped:
    """Map from just before an impact on L to just before the next one, on L again; see `impact_map`."""
    return impact_map(p, 1, 1, state, phi)


def P4(p: Params, state: Sequence[float] | npt.NDArray[np.float64], phi: float = 0.0) -> Mapped:
    """Map from just before an impact on R to just before the next one, on R again; see `impact_map`."""
    return impact_map(p, -1, -1, state, phi)
