"""Codimension two: functions along a curve of bifurcations that pass through zero where it meets another one."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.orbits._conditions import TIE, grazing_margin, tie_margin
from vines.orbits._criticality import branching_curvature
from vines.orbits._curve_equations import CurveEquations
from vines.orbits._problem import Point

__all__ = ["BOUNDS", "END", "RESONANCES", "STICKING_BOUNDS", "Special", "special_functions"]

Multipliers = npt.NDArray[np.complex128]

END = "grazing"
"""The special point at which the orbits of the curve cease to be admissible."""

RESONANCES = {"resonance_1_1": 1.0, "resonance_1_2": -1.0, "resonance_1_3": -0.5, "resonance_1_4": 0.0}
"""Cosine of the angle of the critical pair at the strong resonances."""

STICKING_BOUNDS = ("incomplete_chatter", "release_tangency")
BOUNDS = ("grazing", *STICKING_BOUNDS)
"""Types of curves at which no multiplier is critical."""

_LARGEST = 1e7
"""Modulus of a multiplier beyond which the others are too much rounding to tell what they do."""


class Special(NamedTuple):
    """A kind of codimension-two point.

    Attributes
    ----------
    type : str
    function : callable
        Of a point on the curve; changes its sign there.
    holds : callable
        Of the same, whether a zero is what it seems: a pair of product one is one on the circle, for instance.
    """

    type: str
    function: Callable[[Point], float]
    holds: Callable[[Point], bool]


def _always(point: Point) -> bool:
    return True


def special_functions(problem: CurveEquations) -> tuple[Special, ...]:
    """Return what is looked for on a curve of this kind (docs/orbits.md, "Curves")."""
    kind, flip = problem.kind, "symmetry_breaking" if problem.symmetric else "flip"

    def multipliers(point: Point) -> Multipliers:
        m = point.orbit.multipliers
        if problem.symmetric:
            # Next to a loss of symmetry rounding may hide that an orbit of the family is symmetric.
            half = point.orbit.half_multipliers
            m = np.sqrt(m) if half is None else half
        return m if np.isfinite(m).all() and np.abs(m).max() < _LARGEST else np.full(len(m), complex(np.nan))

    def critical(point: Point) -> tuple[Multipliers, Multipliers]:
        """Return the multipliers that make the bifurcation, and the others."""
        m = multipliers(point)
        if kind in BOUNDS:
            mine: tuple[int, ...] = ()
        elif kind == "neimark_sacker":
            mine = min(combinations(range(len(m)), 2), key=lambda pair: abs(1 - m[pair[0]] * m[pair[1]]))
        else:
            mine = (int(np.argmin(abs(m - (1 if kind == "fold" else -1)))),)
        return m[list(mine)], m[[k for k in range(len(m)) if k not in mine]]

    def one(point: Point) -> float:
        return float(np.prod(1 - critical(point)[1]).real)

    def minus_one(point: Point) -> float:
        return float(np.prod(1 + critical(point)[1]).real)

    def pairs(point: Point) -> float:
        others = critical(point)[1]
        return float(np.prod([1 - a * b for a, b in combinations(others, 2)]).real)

    def on_circle(point: Point) -> bool:
        a, b = min(combinations(critical(point)[1], 2), key=lambda pair: abs(1 - pair[0] * pair[1]))
        return abs(a.imag) > 1e-7 and abs(a - b.conjugate()) < 1e-6

    def cosine(point: Point) -> float:
        return float(critical(point)[0].sum().real) / 2

    def curvature(point: Point) -> float:
        along = point.tangent[-2:]
        direction = np.array([-along[1], along[0]]) / np.linalg.norm(along) * problem.spans
        try:
            return branching_curvature(kind, point.orbit, problem.names, direction)
        except np.linalg.LinAlgError:  # at the border of where the system exists
            return np.nan

    def other_margin(point: Point) -> float:
        orbit = point.orbit
        return min(
            problem.elsewhere(orbit, point.y), float((orbit.side * orbit.w_dot)[orbit.side != 0].min(initial=np.inf))
        )

    def bend(point: Point) -> float:
        return problem.bend(point.y)

    def small_curvature(point: Point) -> bool:
        return abs(curvature(point)) < 1.0

    ties = (Special(TIE, tie_margin, _always),) if any(problem.word.balls) else ()
    fold = Special(f"{kind}_fold" if kind in BOUNDS else f"fold_{flip}", one, _always)
    of_a_bound = (
        *ties,
        fold,
        Special(f"{kind}_{flip}", minus_one, _always),
        Special(f"{kind}_neimark_sacker", pairs, on_circle),
    )
    if kind in STICKING_BOUNDS:
        return of_a_bound
    if kind == "grazing":
        if not problem.touches:
            return ties
        return (
            *of_a_bound,
            Special("double_grazing", other_margin, _always),
            Special("degenerate_grazing", bend, _always),
        )
    end = Special(END, grazing_margin, _always)
    if kind == "fold":
        return (
            *ties,
            Special("resonance_1_1", one, _always),
            Special(f"fold_{flip}", minus_one, _always),
            Special("fold_neimark_sacker", pairs, on_circle),
            end,
        )
    if kind == "neimark_sacker":
        return (
            *ties,
            *(
                Special(name, lambda point, value=value: cosine(point) - value, _always)
                for name, value in RESONANCES.items()
            ),
            Special("fold_neimark_sacker", one, _always),
            Special(f"{flip}_neimark_sacker", minus_one, _always),
            end,
        )
    return (
        *ties,
        fold,
        Special("resonance_1_2", minus_one, _always),
        Special(f"{flip}_neimark_sacker", pairs, on_circle),
        Special(f"degenerate_{kind}", curvature, small_curvature),
        end,
    )
