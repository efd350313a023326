"""A family and all that come out of it one after another, as by a cascade of period doublings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from vines.domains import Name, Number, Numbers, Of, Pair, Whole, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.orbits._branch import Bifurcation, Branch
from vines.orbits._continuation import continue_orbit
from vines.orbits._joined import BRANCHING, is_joint
from vines.orbits._orbit import Orbit
from vines.orbits._switch import switch_branch

__all__ = ["follow_cascade", "generations"]

_SAME = 1e-9
"""Relative difference of parameter values at which a family that ends does so at a branching point found before."""


@stated(
    ParameterError,
    orbit=Of("Orbit", how="as vines.find_orbit returns it"),
    parameter=Name(),
    stop=Number(),
    depth=Whole(least=0, most=24),
    within=Pair(optional=True),
    at=Numbers(),
    step=Number(),
    max_points=Whole(most=1_000_000),
)
def follow_cascade(
    orbit: Orbit,
    parameter: str,
    stop: float,
    *,
    depth: int = 4,
    within: tuple[float, float] | None = None,
    at: Sequence[float] = (),
    step: float = 0.02,
    beyond_grazing: bool = False,
    max_points: int = 5000,
) -> list[Branch]:
    """Follow an orbit in one parameter, then every family that comes out of it, and so on.

    Parameters
    ----------
    orbit, parameter, stop, within, at, step, beyond_grazing, max_points
        As for `continue_orbit`; the largest step is halved with each generation, since cascades are.
    depth : int
        Generations after the first branch. The work grows as the cube of the number of impacts, which doubles.

    Returns
    -------
    list of Branch
        The first branch, then each generation in turn. `Branch.parent` is the `branch_id` of the one that it comes out
        of; it begins next to that branching point, whose type is ``ends[0]``. Of an asymmetric pair one is
        followed: the other is its mirror image. A family that comes out at one branching point and ends at
        another is there once. Where what comes out could not be reached or followed, `Branch.remark` of the
        branch that it comes out of says so, and the others are there all the same.

    Raises
    ------
    ParameterError
        As for `continue_orbit`, or if `depth` is negative.
    OrbitNotFound
        If the first branch is lost.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import find_orbit
    >>> for branch in follow_cascade(find_orbit("LR", Params(mu=0.01, A=0.017)), "A", 0.024, depth=2):
    ...     print(branch.word, [(b.type, round(b.value, 4)) for b in branch.bifurcations])
    LR [('symmetry_breaking', 0.018)]
    LR [('period_doubling', 0.0205), ('grazing', 0.0233)]
    LRLR/2T [('period_doubling', 0.0213), ('grazing', 0.0217)]
    """
    start = getattr(orbit.params, parameter, stop)
    low, high = sorted((start, stop) if within is None else within)
    options = {"at": at, "step": step, "beyond_grazing": beyond_grazing, "max_points": max_points}
    first = continue_orbit(orbit, parameter, stop, within=within, **options)
    return generations([first], depth, (low, high), options)


def generations(first: list[Branch], depth: int, within: tuple[float, float], options: dict[str, Any]) -> list[Branch]:
    """Return branches and what comes out of them.

    Parameters
    ----------
    first : list of Branch
    depth : int
        Generations after them.
    within : tuple of float, float
        Range of the parameter.
    options : dict
        Of `continue_orbit`, for the first ones; ``step`` is halved with each generation.

    Returns
    -------
    list of Branch
        The first ones and then each generation in turn. What could not be reached or followed is told in
        `Branch.remark` of the branch that it comes out of.
    """
    generation, found = first, []
    for k in range(depth + 1):
        if k == depth:
            found += generation
            break
        finer = {**options, "step": options["step"] / 2 ** (k + 1)}
        children: list[Branch] = []
        for branch in generation:
            reached: list[float] = []
            lost: list[str] = []
            for bifurcation in branch.bifurcations:
                if bifurcation.type not in BRANCHING or is_joint(bifurcation) or _among(bifurcation.value, reached):
                    continue
                try:
                    child = _child(bifurcation, branch.branch_id, within, finer)
                except OrbitNotFound as error:
                    lost.append(f"out of the {bifurcation.type} at {bifurcation.value:.9g}: {error}")
                    continue
                if child is not None:
                    children.append(child)
                    reached += [b.value for b in child.bifurcations if is_joint(b)]
            found.append(replace(branch, remark="; ".join(lost)) if lost else branch)
        generation = children
    return found


def _child(
    bifurcation: Bifurcation, parent: str, within: tuple[float, float], options: dict[str, Any]
) -> Branch | None:
    """Return the branch that comes out of a branching point; None if that lies beyond the range."""
    orbit = switch_branch(bifurcation)[0]
    start = getattr(orbit.params, bifurcation.parameter)
    stop = within[1] if start > bifurcation.value else within[0]
    if not within[0] < start < within[1]:
        return None
    branch = continue_orbit(orbit, bifurcation.parameter, stop, within=within, **options)
    return replace(branch, parent=parent, ends=(bifurcation.type, branch.ends[1]))


def _among(value: float, values: list[float]) -> bool:
    return any(math.isclose(value, other, rel_tol=_SAME) for other in values)
