"""The defining equations of bifurcations: functions that pass through zero where one happens.

They are smooth in the parameter, also where multipliers collide, because each is a symmetric function of them
(docs/orbits.md, "Bifurcations"). For a symmetric orbit they are taken of the half map.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.orbits._problem import Point

__all__ = [
    "GRAZING",
    "REMARKS",
    "TIE",
    "Condition",
    "conditions",
    "critical_multiplier",
    "grazing_margin",
    "tie_margin",
]

Multipliers = npt.NDArray[np.complex128]

GRAZING = "grazing"
TIE = "tie"
REMARKS = ("pair_turns_real",)
"""Types that are not bifurcations: nothing changes its stability there."""

_REAL = 1e-7
"""Imaginary part, relative to the modulus, below which a multiplier is taken to be real."""


_LARGEST = 1e9
"""Modulus of a multiplier beyond which double precision leaves less than six digits of those near one."""

_ON_CIRCLE = 1e-6
"""Distance of a multiplier, or the product of a pair, from what it should be, beyond which it was only rounding."""


class Condition(NamedTuple):
    """One defining equation.

    Attributes
    ----------
    type : str
        Type of the bifurcation.
    function : callable
        Of a point; changes its sign at the bifurcation.
    """

    type: str
    function: Callable[[Point], float]


def grazing_margin(point: Point) -> float:
    """Return the least of the clearances of turning points and the speeds at which the walls are met."""
    orbit = point.orbit
    speeds = (orbit.side * orbit.w_dot)[orbit.side != 0]
    return min(orbit.min_clearance, float(np.min(speeds, initial=np.inf)))


def tie_margin(point: Point) -> float:
    """Return the least time from an impact to the next: balls whose impacts change places are no orbit of the word."""
    return float(np.min(point.orbit.flight_times))


def _whole(point: Point) -> Multipliers:
    return point.orbit.multipliers


def _half(point: Point) -> Multipliers:
    # Next to a loss of symmetry rounding may hide that an orbit of the family is symmetric.
    half = point.orbit.half_multipliers
    return np.sqrt(point.orbit.multipliers) if half is None else half


def _resolved(m: Multipliers) -> bool:
    """Say whether the multipliers near one are more than rounding: their error is that of the largest."""
    return bool(np.isfinite(m).all() and np.abs(m).max() < _LARGEST)


def _fold(point: Point) -> float:
    return float(point.tangent[-1])


def _minus_one(m: Multipliers) -> float:
    if not _resolved(m):
        return math.nan
    return float(np.prod(1 + m).real)


def _product_one(m: Multipliers) -> float:
    if not _resolved(m):
        return math.nan
    return float(np.prod([1 - a * b for a, b in combinations(m, 2)]).real)


def _discriminant(m: Multipliers) -> float:
    if not _resolved(m):
        return math.nan
    # Those that sticking makes zero meet each other always.
    return float(np.prod([(a - b) ** 2 for a, b in combinations(m[m != 0], 2)]).real)


def conditions(symmetric: bool, *, several: bool = False) -> tuple[Condition, ...]:
    """Return the defining equations for a family of symmetric or of other orbits, of one ball or of `several`."""
    of = _half if symmetric else _whole
    ties = (Condition(TIE, tie_margin),) if several else ()
    return (
        *ties,
        Condition("fold", _fold),
        Condition("symmetry_breaking" if symmetric else "period_doubling", lambda point: _minus_one(of(point))),
        Condition("neimark_sacker", lambda point: _product_one(of(point))),
        Condition("pair_turns_real", lambda point: _discriminant(of(point))),
        Condition(GRAZING, grazing_margin),
    )


def critical_multiplier(kind: str, point: Point, symmetric: bool) -> tuple[complex, complex] | None:
    """Return the multiplier that makes the bifurcation, of the map it is defined by and over the whole period.

    None, if the zero of the defining equation is no bifurcation: a product of two real multipliers that passes through
    one is no Neimark-Sacker point. Nan for grazing and ties, where the Jacobian jumps.
    """
    m = _half(point) if symmetric else _whole(point)
    if kind in (GRAZING, TIE) or not np.isfinite(m).all():
        found = complex(np.nan, np.nan)
    elif kind == "fold":
        found = m[np.argmin(abs(m - 1))]
    elif kind in ("symmetry_breaking", "period_doubling"):
        found = m[np.argmin(abs(m + 1))]
        if abs(found + 1) > _ON_CIRCLE:
            return None
    elif kind == "neimark_sacker":
        i, j = min(combinations(range(len(m)), 2), key=lambda pair: abs(1 - m[pair[0]] * m[pair[1]]))
        real = abs(m[i].imag) < _REAL * abs(m[i]) or abs(m[i] - m[j].conjugate()) > _REAL * abs(m[i])
        if real or abs(1 - m[i] * m[j]) > _ON_CIRCLE:
            return None
        found = m[i]
    else:
        m = m[m != 0]
        i, j = min(combinations(range(len(m)), 2), key=lambda pair: abs(m[pair[0]] - m[pair[1]]))
        # Two multipliers that differ by rounding are one, whose real part is the mean.
        found = complex((m[i] + m[j]).real / 2)
    return complex(found), complex(found**2 if symmetric else found)
