"""Where the model's branches are stable in the plane of A and Omega, and how they end."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params, Word

if TYPE_CHECKING:
    from vines.orbits import Branch, Orbit

__all__ = ["WORDS", "Column", "Stretch", "branch_map"]

WORDS = ("LR", "LLR")
"""Patterns that are looked for unless others are asked for, with what branches off them; of mirror images one is."""

_SHORT = 3
"""Impacts of a word whose period doublings are followed."""

_SAME = 1e-6
_SEEDS = 9


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """A stable piece of a branch at one Omega.

    Attributes
    ----------
    name, word : str
        n:m/pT and the word.
    symmetric : bool
    low, high : float
        Amplitudes A between which it is stable.
    ends : tuple of str
        What happens at `low` and `high`: a type of bifurcation, ``grazing``, or ``range`` where the map ends.
    orbits : tuple of Orbit
        At the amplitudes of the map within.
    """

    name: str
    word: str
    symmetric: bool
    low: float
    high: float
    ends: tuple[str, str]
    orbits: tuple[Orbit, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """The stable stretches at one Omega."""

    Omega: float
    stretches: tuple[Stretch, ...]


def branch_map(
    p: Params, amplitudes: Sequence[float], omegas: Sequence[float], words: Sequence[str] = WORDS
) -> tuple[Column, ...]:
    """Return the stable stretches of branches, a column for each Omega.

    Parameters
    ----------
    p : Params
        Gives mu, r and lam.
    amplitudes, omegas : sequence of float
        Rising; two amplitudes and more.
    words : sequence of str
        Patterns that are looked for, at nine amplitudes of each column, and followed from there.

    Raises
    ------
    ParameterError
        If there are fewer than two amplitudes, or they do not rise.
    """
    if len(amplitudes) < 2 or any(b <= a for a, b in pairwise(amplitudes)):
        raise ParameterError(f"amplitudes are {list(amplitudes)}, allowed are two and more that rise")
    return tuple(Column(omega, _column(p.replace(Omega=omega), amplitudes, words)) for omega in omegas)


def _column(p: Params, amplitudes: Sequence[float], words: Sequence[str]) -> tuple[Stretch, ...]:
    """Follow what is found at some amplitudes, and what branches off it."""
    from vines.orbits import all_orbits

    places = np.unique(np.linspace(0, len(amplitudes) - 1, _SEEDS).round().astype(int))
    found: list[Stretch] = []
    followed: list[Branch] = []
    for word in dict.fromkeys(str(Word(one)) for one in words):
        for place in places:
            for seed in all_orbits(word, p.replace(A=amplitudes[place])):
                waiting = [seed] if seed.stable and seed.admissible else []
                while waiting:
                    orbit = waiting.pop()
                    if any(_on(orbit, branch) for branch in followed):
                        continue
                    new = _followed(orbit, amplitudes)
                    followed += new
                    found += [stretch for branch in new for stretch in _stretches(branch, amplitudes)]
                    waiting += [other for branch in new for other in _off(branch)]
    return tuple(_merged(found))


def _followed(orbit: Orbit, amplitudes: Sequence[float]) -> list[Branch]:
    """Return the branch of an orbit to both sides, as far as it can be followed."""
    from vines.orbits import continue_orbit

    limits, found = (amplitudes[0], amplitudes[-1]), []
    for stop in limits:
        if abs(stop - orbit.params.A) < _SAME * stop:
            continue
        with contextlib.suppress(OrbitNotFound, ParameterError):
            found.append(continue_orbit(orbit, "A", stop, within=limits, at=list(amplitudes)))
    return found


def _off(branch: Branch) -> list[Orbit]:
    """Return an orbit on each short family that branches off a branch."""
    from vines.orbits import switch_branch

    found = []
    for one in branch.bifurcations:
        if one.type in ("symmetry_breaking", "period_doubling") and len(one.orbit.word) <= _SHORT:
            with contextlib.suppress(OrbitNotFound, ParameterError):
                found.append(switch_branch(one)[0])
    return found


def _on(orbit: Orbit, branch: Branch) -> bool:
    return any(_alike(orbit, other) for other in branch.orbits)


def _alike(one: Orbit, other: Orbit) -> bool:
    """Say whether two orbits are one or mirror images, which have the same sizes at half a period's distance."""
    if abs(one.params.A - other.params.A) > _SAME * one.params.A:
        return False
    if str(one.word) not in (str(other.word), str(other.word.mirror)):
        return False
    mine, theirs = np.sort(np.abs(one.w_dot)), np.sort(np.abs(other.w_dot))
    same = abs(one.measures.max_abs_x1 - other.measures.max_abs_x1) < _SAME
    return len(mine) == len(theirs) and same and bool(np.allclose(mine, theirs, atol=_SAME))


def _stretches(branch: Branch, amplitudes: Sequence[float]) -> list[Stretch]:
    orbits = [one for one in branch.orbits if one.admissible]
    flags = [bool(one.stable) for one in orbits]
    found = []
    k = 0
    while k < len(orbits):
        if not flags[k]:
            k += 1
            continue
        first = k
        while k + 1 < len(orbits) and flags[k + 1] and orbits[k + 1].symmetric == orbits[first].symmetric:
            k += 1
        piece = orbits[first : k + 1]
        sides = [_end(branch, orbits, first, -1, amplitudes), _end(branch, orbits, k, +1, amplitudes)]
        if sides[0][0] > sides[1][0]:
            sides.reverse()
        listed = tuple(
            one for one in piece if any(abs(one.params.A - a) < _SAME * a for a in amplitudes)
        )  # fmt: skip
        head = piece[0]
        found.append(
            Stretch(
                head.name, str(head.word), bool(head.symmetric), sides[0][0], sides[1][0],
                (sides[0][1], sides[1][1]), listed,
            )
        )  # fmt: skip
        k += 1
    return found


def _end(branch: Branch, orbits: list[Orbit], k: int, way: int, amplitudes: Sequence[float]) -> tuple[float, str]:
    """Return where a stretch ends beyond its last orbit, and by what."""
    here = orbits[k].params.A
    limits = (amplitudes[0], amplitudes[-1])
    if any(abs(here - limit) < _SAME * limit for limit in limits):
        return here, "range"
    other = k + way
    there = orbits[other].params.A if 0 <= other < len(orbits) else None
    near = sorted(branch.bifurcations, key=lambda one: abs(one.value - here))
    if there is not None:
        low, high = min(here, there), max(here, there)
        reach = 0.05 * (high - low) + _SAME
        inside = [one for one in near if low - reach <= one.value <= high + reach]
        return (float(inside[0].value), inside[0].type) if inside else (0.5 * (low + high), "stability")
    if k == 0:
        return here, "start"
    if near and abs(near[0].value - here) < 0.02 * here:
        return float(near[0].value), near[0].type
    return here, "end"


def _merged(found: list[Stretch]) -> list[Stretch]:
    """Join the two halves of a stretch that was followed both ways from an orbit within it."""
    kept: list[Stretch] = []
    for one in found:
        for k, other in enumerate(kept):
            if (one.word, one.symmetric) != (other.word, other.symmetric):
                continue
            joint = {one.low, one.high} & {other.low, other.high}
            shared = any(_alike(a, b) for a in one.orbits for b in other.orbits)
            if not shared and not (joint and "start" in (*one.ends, *other.ends)):
                continue
            below = min((one, other), key=lambda each: each.low)
            above = max((one, other), key=lambda each: each.high)
            orbits = {round(orbit.params.A, 12): orbit for orbit in (*one.orbits, *other.orbits)}
            kept[k] = Stretch(
                one.name, one.word, one.symmetric, below.low, above.high, (below.ends[0], above.ends[1]),
                tuple(orbits[a] for a in sorted(orbits)),
            )  # fmt: skip
            break
        else:
            kept.append(one)
    return kept
