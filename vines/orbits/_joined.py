"""Where families join: mirror images, and the orbit at a branching point as one of either family."""

from __future__ import annotations

import math

import numpy as np

from vines.domains import Of, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params, Word
from vines.orbits._assemble import assemble
from vines.orbits._branch import Bifurcation
from vines.orbits._chain_family import ChainProblem
from vines.orbits._family import GeneralProblem
from vines.orbits._general import origin, refine
from vines.orbits._orbit import Orbit
from vines.orbits._problem import ZeroSet
from vines.orbits._shooting import shoots
from vines.orbits._slid import SlidProblem, first_impact, refine_slid, slid_again, slid_image
from vines.orbits._slid_round import slides
from vines.orbits._smooth_orbit import smooth_doubled, smooth_image
from vines.orbits._sticking_capsule import capsule_sticks, rides_capsule
from vines.orbits._sticking_of_balls import by_sections, mirrored_balls
from vines.orbits._sticking_orbit import mirrored_sticking
from vines.orbits._values import frequency_of

__all__ = ["BRANCHING", "family_through", "is_joint", "left_family", "mirror_image", "unfolded"]

BRANCHING = ("symmetry_breaking", "period_doubling")
"""Types at which another family comes out."""


@stated(ParameterError, orbit=Of("Orbit", how="as vines.find_orbit returns it"))
def mirror_image(orbit: Orbit) -> Orbit:
    """Return the mirror image (x1, x2, t) -> (-x1, -x2, t + T/2) of an orbit, with L and R swapped.

    Raises
    ------
    ParameterError
        If a tilt breaks the symmetry: the image is no motion then.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import find_orbit
    >>> print(mirror_image(find_orbit("LLR", Params(mu=0.01, A=0.023))).word)
    LRR
    """
    if not orbit.params.mirrored:
        broken = " or ".join(f"{name} = 0" for name in orbit.params.system.mirror.broken_by)
        raise ParameterError(f"orbit is at {orbit.params}; its mirror image is no motion unless {broken}")
    if orbit.word.sticking and rides_capsule(orbit.params):
        return capsule_sticks(orbit.word.mirror, orbit.params)
    if orbit.word.sticking:
        return (mirrored_balls if by_sections(orbit.params) else mirrored_sticking)(orbit)
    if slides(orbit.params):
        return slid_image(orbit)
    if orbit.word.unstruck:
        return smooth_image(orbit)
    word, t, states = orbit.word.mirror, orbit.t + orbit.params.period / 2, -orbit.states
    if any(word.balls):
        word, names = word.relabelled(getattr(orbit.params, "alike", ()))
        balls = [names.get(ball, ball) for ball in orbit.word.balls]
        marks = [(-side, ball) for side, ball in zip(orbit.word.sides, balls, strict=True)]
        wanted = list(zip(word.sides, word.balls, strict=True))
        k = next(k for k in range(len(marks)) if marks[k:] + marks[:k] == wanted)
        t, states = np.concatenate([t[k:], t[:k] + orbit.period]), np.roll(states, -k, axis=0)
    return assemble(word, orbit.params, t, states, orbit.remark)


def family_through(orbit: Orbit, parameter: str, *, symmetric: bool) -> GeneralProblem | ChainProblem | SlidProblem:
    """Return the family of an orbit in a parameter, by the closing equations that hold for any word."""
    if slides(orbit.params):
        return SlidProblem(orbit, parameter, symmetric)
    form = GeneralProblem if isinstance(orbit.params, Params) else ChainProblem
    return form(orbit, parameter, symmetric=symmetric)


def is_joint(bifurcation: Bifurcation) -> bool:
    """Say whether it was met from the family that comes out of another one, at its end."""
    orbit = bifurcation.orbit
    if bifurcation.type not in BRANCHING or origin(orbit) != bifurcation.type:
        return False
    return bifurcation.type == "period_doubling" or not math.isclose(bifurcation.half_multiplier.real, -1, abs_tol=1e-6)


def unfolded(kind: str, orbit: Orbit) -> Orbit:
    """Return the orbit at a branching point as one of the family that comes out of it.

    That is the orbit itself where the symmetry breaks, and the orbit gone through twice where the period doubles.
    """
    if kind == "symmetry_breaking":
        return orbit
    if orbit.word.unstruck:
        return smooth_doubled(orbit)
    word = orbit.word.doubled
    if slides(orbit.params):
        return slid_again(word, orbit.params, first_impact(orbit))
    return assemble(
        word, orbit.params, np.concatenate([orbit.t, orbit.t + orbit.period]), np.tile(orbit.states, (2, 1))
    )


def left_family(joint: Bifurcation) -> Orbit:
    """Return the orbit of the family that is left at a joint, at the parameters of the joint.

    Raises
    ------
    OrbitNotFound
        If it is lost.
    """
    orbit = joint.orbit
    if orbit.word.sticking:
        raise OrbitNotFound(f"what {joint} comes out of sticks; find it by its own word and follow it to there")
    n = len(orbit.word) // 2
    if shoots(orbit.params):
        return _left_by_shots(joint)
    if slides(orbit.params) and joint.type == "period_doubling":
        word = Word(f"{orbit.word.letters[: len(orbit.word.letters) // 2]}/{orbit.word.p // 2}T")
        x1, v1, _, v2 = (orbit.states[0] + orbit.states[n]) / 2
        t = (orbit.t[0] + orbit.t[n] - orbit.period / 2) / 2
        return refine_slid(word, orbit.params, [x1, v1, v2, t])
    if joint.type == "period_doubling":
        word = Word(f"{orbit.word.letters[: len(orbit.word.letters) // 2]}/{orbit.word.p // 2}T")
        return refine(word, orbit.params, (orbit.t[:n] + orbit.t[n:] - orbit.period / 2) / 2)
    problem = family_through(orbit, joint.parameter, symmetric=True)
    start = problem.start
    if not slides(orbit.params):
        phases = (orbit.t[:n] + orbit.t[n:] - orbit.period / 2) / 2 * frequency_of(orbit.params)
        start = np.append(phases, joint.value)
    y = ZeroSet(problem, 1.0).at_value(start, joint.value)
    if y is None:
        raise OrbitNotFound(f"the symmetric orbit at {joint} was lost; follow the symmetric family to it")
    return problem.orbit(y)


def _left_by_shots(joint: Bifurcation) -> Orbit:
    """Return the same of an orbit whose states at the impacts are all unknown."""
    orbit, halves = joint.orbit, joint.type == "symmetry_breaking"
    if orbit.word.unstruck and not halves:
        return refine(Word(f"-/{orbit.word.p // 2}T"), orbit.params, orbit.states[0])
    word = orbit.word if halves else Word(f"{orbit.word.letters[: len(orbit.word) // 2]}/{orbit.word.p // 2}T")
    if not halves:
        n = len(word)
        mean = (orbit.t[:n] + orbit.t[n:] - orbit.period / 2) / 2, (orbit.states[:n] + orbit.states[n:]) / 2
        return refine(word, orbit.params, assemble(word, orbit.params, *mean))
    problem = family_through(orbit, joint.parameter, symmetric=True)
    y = ZeroSet(problem, 1.0).at_value(problem.start, joint.value)
    if y is None:
        raise OrbitNotFound(f"the symmetric orbit at {joint} was lost; follow the symmetric family to it")
    return problem.orbit(y)
