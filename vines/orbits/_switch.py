"""From a branching point on to the family that comes out of it; derived in docs/orbits.md, "Branch switching"."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from vines.domains import Of, stated
from vines.dynamics import no_ball
from vines.errors import OrbitNotFound, ParameterError
from vines.model import X1, Word
from vines.orbits._branch import Bifurcation
from vines.orbits._general import origin, refine
from vines.orbits._joined import BRANCHING, family_through, is_joint, left_family, mirror_image, unfolded
from vines.orbits._orbit import Orbit
from vines.orbits._problem import Problem
from vines.orbits._slid import refine_slid
from vines.orbits._slid_round import slides
from vines.orbits._sticking_family import StickingProblem
from vines.orbits._sticking_family_of_balls import BallsProblem
from vines.orbits._sticking_of_balls import by_sections
from vines.orbits._sticking_search import refine_sticking
from vines.orbits._sticking_search_of_balls import refine_balls

__all__ = ["switch_branch"]

_STEPS = (0.02, 0.04, 0.01, 0.08, 0.005, 0.0025)
"""Lengths of the step off the old family along the null vector, in radians of phase; the first that works is taken."""

_SHORTER = (1e-3, 3e-4, 1e-4)
"""Tried too where the orbits stick: their velocities at the release may be small, and their families short."""

_ITERATIONS = 15
_CLOSE = 1e-6
"""Newton step relative to the step off the family, after which the closing equations take over."""

_RESIDUAL = 1e-13
"""Largest residual of an orbit that was reached, in a cavity that is larger than the motion."""

_RUN = 1e-11
"""The same of an orbit that sticks or stops, which is run as a whole and not flight by flight."""


@stated(ParameterError, bifurcation=Of("Bifurcation", how="one of Branch.bifurcations"))
def switch_branch(bifurcation: Bifurcation) -> list[Orbit]:
    """Return orbits next to a branching point, of the family that comes out of it.

    Parameters
    ----------
    bifurcation : Bifurcation
        A symmetry breaking or a period doubling.

    Returns
    -------
    list of Orbit
        At a symmetry breaking an asymmetric orbit and its mirror image, first the one whose impacts lie at the larger
        mean x1; at a period doubling the orbit of twice the period; where a family ends that came out of another one,
        the orbit of that other family.

    Raises
    ------
    OrbitNotFound
        If no family comes out of this bifurcation, or none was reached.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import continue_orbit, find_orbit
    >>> branch = continue_orbit(find_orbit("LR", Params(mu=0.01, A=0.017)), "A", 0.02)
    >>> for orbit in switch_branch(branch.bifurcations[0]):
    ...     print(orbit.name, orbit.symmetric, orbit.stable, f"{orbit.params.A:.3f}")
    1:1 False True 0.018
    1:1 False True 0.018
    """
    if bifurcation.type not in BRANCHING:
        raise OrbitNotFound(
            f"no other family comes out of a {bifurcation.type} of {bifurcation.orbit.name}; "
            f"give a bifurcation of type {' or '.join(BRANCHING)}"
        )
    if is_joint(bifurcation):
        return [left_family(bifurcation)]
    problem = _unfolded(bifurcation)
    steps = (*_STEPS, *_SHORTER) if problem.word.sticking else _STEPS
    for step in steps:
        orbit = _step_off(problem, step)
        if orbit is not None:
            return _pair(orbit) if bifurcation.type == "symmetry_breaking" else [orbit]
    raise OrbitNotFound(
        f"no {problem.word} orbit was reached from {bifurcation} by steps of {min(steps):g} to {max(steps):g} rad; "
        "the branching may be degenerate: change another parameter"
    )


def _unfolded(bifurcation: Bifurcation) -> Problem:
    """Return the family of the old orbits, as one of those that come out of it, from the branching point on."""
    orbit, parameter = bifurcation.orbit, bifurcation.parameter
    if not orbit.word.sticking:
        return family_through(unfolded(bifurcation.type, orbit), parameter, symmetric=False)
    twice = bifurcation.type == "period_doubling"
    word = orbit.word.doubled if twice else orbit.word
    form = BallsProblem if by_sections(orbit.params) else StickingProblem
    return form(orbit, parameter, word=word, symmetric=False)


def _pair(orbit: Orbit) -> list[Orbit]:
    """Return an orbit and its mirror image in the one order that does not depend on which of them was found."""
    pair = [orbit, mirror_image(orbit)]
    return sorted(pair, key=lambda one: float(one.states[:, X1].mean()), reverse=True)


def _step_off(problem: Problem, step: float) -> Orbit | None:
    """Return the orbit at this distance along the null vector from where the problem starts, or None.

    The old family has no component along the null vector that joins it to the new one, so that a prescribed component
    keeps Newton's method from returning to it.
    """
    y = problem.start.copy()
    null = np.append(np.linalg.svd(problem.equations(y)[1][:, :-1])[2][-1], 0.0)
    null *= np.sign(null[np.argmax(np.abs(null))])
    y += step * null
    for _ in range(_ITERATIONS):
        defect, slope = problem.equations(y)
        right = np.append(defect, null @ (y - problem.start) - step)
        if not (np.isfinite(right).all() and np.isfinite(slope).all()):
            return None
        change = np.linalg.solve(np.vstack([slope, null]), right)
        y -= change
        if np.abs(change).max() < _CLOSE * step:
            break
    else:
        return None
    if np.abs(y - problem.start)[:-1].max() > 3 * step:
        return None
    try:
        here = problem.orbit(y)
        orbit = _solver(here)(here.word, here.params, here)
    except OrbitNotFound:
        return None
    by_runs = orbit.word.sticking or slides(orbit.params)
    allowed = (_RUN if by_runs else _RESIDUAL) * (1.0 + _size(orbit.params))
    return orbit if orbit.residual <= allowed and origin(orbit) is None and not orbit.symmetric else None


def _solver(orbit: Orbit) -> Callable[[Word, Any, Orbit], Orbit]:
    if not orbit.word.sticking:
        return refine_slid if slides(orbit.params) else refine
    return refine_balls if by_sections(orbit.params) else refine_sticking


def _size(p: Any) -> float:
    """Return the size of the parts of which residuals are sums: the steady motion of the frame without the balls."""
    return p.B if "x1_no_ball" in p.system.without else no_ball(p)
