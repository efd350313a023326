"""The letters of words: contacts one by one, rotations, and names of equal balls."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

__all__ = ["NOTHING", "STICKS", "STOPS", "ball_of", "impacts", "renamed", "roles", "rotated"]

STICKS = "*"
"""Behind the letter of a contact that is a complete chatter, after which the ball sticks."""

STOPS = "s"
"""The letter of a stop in mid-cavity, which friction may bring about."""

NOTHING = "-"
"""The letters of a period without impacts: what a run has instead is its passage through phase 0."""

_CONTACT = re.compile(r"[A-Zs][1-9]?\*?")


def impacts(letters: str) -> list[str]:
    """Return each contact: a letter, with the number of its ball if there is one, and a star if the ball sticks.

    Examples
    --------
    >>> impacts("LLR"), impacts("L1R2"), impacts("L*R")
    (['L', 'L', 'R'], ['L1', 'R2'], ['L*', 'R'])
    """
    if STICKS in letters:
        return _CONTACT.findall(letters)
    width = 1 + letters[-1:].isdecimal()
    return [letters[k : k + width] for k in range(0, len(letters), width)]


def ball_of(contact: str) -> int:
    """Return the number of the ball of a contact, 0 where balls have no numbers."""
    return int(contact[1:].rstrip(STICKS) or 0)


def rotated(letters: str) -> list[str]:
    """Return all rotations, from the letters as they are.

    Examples
    --------
    >>> rotated("L*RR")
    ['L*RR', 'RRL*', 'RL*R']
    """
    starts = [0]
    for each in impacts(letters)[:-1]:
        starts.append(starts[-1] + len(each))
    return [letters[k:] + letters[:k] for k in starts]


def renamed(letters: str, groups: Collection[Collection[int]]) -> tuple[str, dict[int, int]]:
    """Return the least letters, from this first impact, that equal balls can have, and their new numbers.

    In the order in which they hit for the first time balls of a group get the numbers of the group in rising order:
    an earlier letter counts more than all later ones.

    Examples
    --------
    >>> renamed("L3R3L1R2", [(1, 3)])
    ('L1R1L3R2', {3: 1, 1: 3})
    """
    left = [list(group) for group in groups]
    own = {ball: numbers for group, numbers in zip(groups, left, strict=True) for ball in group}
    names: dict[int, int] = {}
    found: list[str] = []
    for each in impacts(letters):
        ball = ball_of(each)
        if ball in own and ball not in names:
            names[ball] = own[ball].pop(0)
        found.append(each[0] + each[1:].replace(str(ball), str(names.get(ball, ball))))
    return "".join(found), names


def roles(first: Iterable[str], second: Iterable[str], groups: Collection[Collection[int]]) -> dict[int, int]:
    """Return which ball of the second impacts has the role of each equal ball of the first that another one has.

    Empty where the two are not the same impacts but for the names of equal balls, or are the same altogether.

    Examples
    --------
    >>> roles(["L1", "R2"], ["L2", "R1"], [(1, 2)]), roles(["L1", "R2"], ["L2", "R1"], [])
    ({1: 2, 2: 1}, {})
    """
    names: dict[int, int] = {}
    for one, other in zip(first, second, strict=True):
        ball, there = ball_of(one), ball_of(other)
        if (one[0], one.endswith(STICKS)) != (other[0], other.endswith(STICKS)) or names.setdefault(
            ball, there
        ) != there:
            return {}
    changed = {ball: there for ball, there in names.items() if ball != there}
    alike = all(any({ball, there} <= set(group) for group in groups) for ball, there in changed.items())
    return changed if alike and len(set(names.values())) == len(names) else {}
