"""Whether two runs came to one attractor: the one rule for sweeps, basins, figures and checks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from vines.attractors._attractor import Attractor

__all__ = ["SAME", "Motion", "apart"]

SAME = 1e-6
"""Distance below which two periodic attractors are one, where nothing is said."""

ERRORS = 4.0
"""Two irregular motions are two attractors if K2/K1 and rms x1 both differ by more than so many standard errors."""

_IRREGULAR = ("chaotic", "unsettled")


class Motion(NamedTuple):
    """What tells attractors at one parameter point apart; a standard error of None or nan is not known.

    Attributes
    ----------
    regime : str
        As of an `Attractor`.
    n, m, p : int or None
        If periodic, contacts on L and on R in p forcing periods.
    kinetic_ratio, max_abs_x1, rms_x1 : float or None
        K2/K1, largest and rms x1; None where a system has no such displacement.
    kinetic_ratio_error, rms_x1_error : float or None
        Their standard errors.
    """

    regime: str
    n: int | None
    m: int | None
    p: int | None
    kinetic_ratio: float
    max_abs_x1: float | None
    rms_x1: float | None = None
    kinetic_ratio_error: float | None = None
    rms_x1_error: float | None = None

    @classmethod
    def of(cls, attractor: Attractor) -> Motion:
        """Return that of an attractor, without standard errors."""
        measures = attractor.measures
        return cls(attractor.regime, attractor.n, attractor.m, attractor.p, measures.kinetic_ratio, measures.max_abs_x1)

    @classmethod
    def of_row(cls, row: Mapping[str, Any]) -> Motion:
        """Return that of a row of ``points`` or ``attractors``."""
        values: dict[str, Any] = {name: row.get(name) for name in cls._fields}
        return cls(**values)


def apart(one: Motion, other: Motion) -> float:
    """Return how far two motions are from being one attractor, or mirror images of each other.

    Parameters
    ----------
    one, other : Motion
        At the same parameters.

    Returns
    -------
    float
        Infinite if they are of different kinds: regimes (chaotic and unsettled ones count as one), periods or types,
        n:m and m:n being mirror images. Of periodic ones the larger difference of max|x1| and K2/K1, each over one and
        the size of the first. Of others 0, but infinite if the means of K2/K1 and rms x1 both differ clearly; where a
        standard error is not known too little is known to tell them apart.

    Examples
    --------
    >>> apart(Motion("periodic", 2, 1, 1, 0.05, 0.6), Motion("periodic", 1, 2, 1, 0.05, 0.6))
    0.0
    >>> apart(Motion("periodic", 1, 1, 1, 0.05, 0.6), Motion("periodic", 2, 2, 2, 0.05, 0.6))
    inf
    """
    kinds = [("irregular" if each.regime in _IRREGULAR else each.regime) for each in (one, other)]
    if kinds[0] != kinds[1]:
        return math.inf
    if kinds[0] == "periodic":
        if (one.p, {one.n, one.m}) != (other.p, {other.n, other.m}):
            return math.inf
        return max(
            abs(a - b) / (1.0 + abs(a))
            for a, b in ((one.max_abs_x1, other.max_abs_x1), (one.kinetic_ratio, other.kinetic_ratio))
            if a is not None and b is not None
        )
    means = ((one.kinetic_ratio, one.kinetic_ratio_error), (one.rms_x1, one.rms_x1_error))
    others = ((other.kinetic_ratio, other.kinetic_ratio_error), (other.rms_x1, other.rms_x1_error))
    return math.inf if all(_differ(*a, *b) for a, b in zip(means, others, strict=True)) else 0.0


def _differ(a: float | None, a_error: float | None, b: float | None, b_error: float | None) -> bool:
    if a is None or b is None or a_error is None or b_error is None:
        return False
    return abs(a - b) > ERRORS * math.hypot(a_error, b_error) + SAME
