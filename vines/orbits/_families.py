"""All families of a word over a range of one parameter, each followed once from end to end."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from vines.domains import Interval, Name, Number, Numbers, Parameters, Whole, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params, Word
from vines.orbits._all import all_orbits
from vines.orbits._branch import Branch
from vines.orbits._cascade import generations
from vines.orbits._continuation import CLOSED, continue_orbit
from vines.orbits._general import same
from vines.orbits._joined import BRANCHING, is_joint, mirror_image
from vines.orbits._orbit import Orbit

__all__ = ["Families", "follow_families"]

_FINER = (1.0, 0.25, 0.05)
"""Steps tried, relative to the one asked for: next to a grazing a bifurcation may only be located with small ones."""

_MET = 1e-4
"""Relative difference of the parameter at a branching point as located from either family."""


class Families(list[Branch]):
    """Branches of one word and those that come out of them.

    Attributes
    ----------
    loose : list of Orbit
        Orbits that could not be followed, of no branch.
    complete : bool
        Whether every orbit at every seed was searched for to the end (`Orbits.complete`). A family that lives between
        two seeds is not seen either way.
    """

    def __init__(self, found: Iterable[Branch] = (), *, loose: list[Orbit], complete: bool) -> None:
        super().__init__(found)
        self.loose = loose
        self.complete = complete


@stated(
    ParameterError,
    p=Parameters(),
    parameter=Name(),
    within=Interval(),
    seeds=Numbers(least=1),
    depth=Whole(least=0, most=24),
    at=Numbers(),
    step=Number(above=0, most=1),
)
def follow_families(
    word: str | Word,
    p: Params,
    parameter: str,
    within: tuple[float, float],
    *,
    seeds: Sequence[float],
    depth: int = 0,
    at: Sequence[float] = (),
    step: float = 0.02,
) -> Families:
    """Follow every family of admissible orbits of a word through a range, both ways from where it is found.

    Parameters
    ----------
    word : str or Word
    p : Params
        The other parameters.
    parameter : str
        mu, A, Omega, r or lam.
    within : tuple of float, float
        The range.
    seeds : sequence of float
        Values of the parameter at which all orbits are looked for.
    depth : int
        Generations of families that come out of them (`follow_cascade`).
    at : sequence of float
        Further values that are to be among the orbits, beside the seeds.
    step : float
        As for `continue_orbit`.

    Returns
    -------
    Families
        Symmetric families first, each with what comes out of it. Every branch but those switched to has its first orbit
        at the lower value of the parameter of its two ends. Of an asymmetric pair
        with one word one is followed: the other is its mirror image. ``parent`` is linked where a family comes out
        of another of the list. What could not be followed out of a branch is told in its `remark`.

    Examples
    --------
    >>> from vines.model import Params
    >>> for branch in follow_families("LLR", Params(mu=0.01, A=0.02), "A", (0.0205, 0.0225), seeds=[0.021, 0.022]):
    ...     print([(b.type, round(b.value, 5)) for b in branch.bifurcations], branch.ends)
    [('fold', 0.02098), ('neimark_sacker', 0.02124)] ('range', 'range')
    """
    word = Word(word)
    low, high = sorted(within)
    values = sorted({*at, *seeds})
    searched = [all_orbits(word, p.replace(**{parameter: value})) for value in seeds]
    candidates = [orbit for orbits in searched for orbit in orbits if orbit.admissible]
    found: list[Branch] = []
    loose: list[Orbit] = []
    # A symmetric family comes first, so that the asymmetric one that comes out of it is met as its child.
    for orbit in sorted(candidates, key=lambda orbit: not orbit.symmetric):
        if any(_lies_on(orbit, branch) for branch in found):
            continue
        branch = _both_ways(orbit, parameter, (low, high), values, step)
        if branch is None:
            loose.append(orbit)
            continue
        options = {"step": step, "at": values}
        found += generations([branch], depth, (low, high), options)
    return Families(_linked(found), loose=loose, complete=all(orbits.complete for orbits in searched))


def _lies_on(orbit: Orbit, branch: Branch) -> bool:
    if branch.word != orbit.word or branch.symmetric != orbit.symmetric:
        return False
    value = orbit.params.as_dict()[branch.parameter]
    images = [orbit]
    if orbit.params.mirrored and not orbit.symmetric and orbit.word.mirror == orbit.word:
        images.append(mirror_image(orbit))
    near = [other for other in branch.orbits if other.params.as_dict()[branch.parameter] == value]
    return any(same(other, image.t, image.states) for other in near for image in images)


def _both_ways(
    orbit: Orbit, parameter: str, within: tuple[float, float], at: Sequence[float], step: float
) -> Branch | None:
    """Return the branch through an orbit from its lower end to its upper one, None if it is lost."""
    value = orbit.params.as_dict()[parameter]
    for finer in _FINER:
        followed: list[Branch | None] = []
        try:
            for stop in within:
                options = {"within": within, "at": at, "step": finer * step}
                followed.append(continue_orbit(orbit, parameter, stop, **options) if stop != value else None)
                if followed[-1] is not None and followed[-1].ends[1] == CLOSED:
                    return _joined(None, followed[-1])
        except OrbitNotFound:
            continue
        down, up = followed
        return _joined(down, up)
    return None


def _joined(down: Branch | None, up: Branch | None) -> Branch:
    """Return one branch from two that set out from one orbit, or the only one, turned round if it begins higher."""
    one = up or down
    assert one is not None
    if up is not None and down is not None:
        one = replace(
            up,
            orbits=(*reversed(down.orbits), *up.orbits[1:]),
            bifurcations=(*reversed(down.bifurcations), *up.bifurcations),
            events=(*reversed(down.events), *up.events),
            ends=(down.ends[1], up.ends[1]),
        )
    if one.values[0] <= one.values[-1]:
        return one
    return replace(
        one,
        orbits=one.orbits[::-1],
        bifurcations=one.bifurcations[::-1],
        events=one.events[::-1],
        ends=one.ends[::-1],
    )


def _linked(found: list[Branch]) -> list[Branch]:
    """Name the parent of every branch that ends where it comes out of another one.

    The branching point is that of the parent, which is located to rounding, and is not repeated on the child: from
    there the equations degenerate.
    """
    linked = []
    for branch in found:
        child = branch
        if child.parent is None and set(BRANCHING) & set(child.ends):
            for joint in filter(is_joint, branch.bifurcations):
                parents = [
                    other.branch_id
                    for other in found
                    for b in other.bifurcations
                    if b.type == joint.type and not is_joint(b) and math.isclose(b.value, joint.value, rel_tol=_MET)
                ]
                if parents:
                    kept = tuple(b for b in child.bifurcations if b is not joint)
                    child = replace(child, bifurcations=kept, parent=parents[0])
        linked.append(child)
    return linked
