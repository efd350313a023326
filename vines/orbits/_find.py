"""The orbit of a word at given parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy.typing as npt

from vines.domains import Parameters, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Params, Word
from vines.orbits._all import Orbits, all_orbits
from vines.orbits._general import refine, search
from vines.orbits._orbit import Orbit
from vines.orbits._own_word import whole_word
from vines.orbits._shooting import shoots
from vines.orbits._slid import refine_slid
from vines.orbits._slid_round import slides
from vines.orbits._sticking_capsule import capsule_sticks, rides_capsule
from vines.orbits._sticking_of_balls import by_sections
from vines.orbits._sticking_search import no_sticking_orbit, refine_sticking
from vines.orbits._sticking_search_of_balls import refine_balls
from vines.orbits._symmetric import no_symmetric_orbit

__all__ = ["find_orbit"]

_NONE_ADMISSIBLE = (
    "; none is admissible, so that no run has this word here: vines.settle says what one settles to, and its word"
)
"""What the remark of an orbit goes on with that is no motion of the system."""


@stated(ParameterError, p=Parameters())
def find_orbit(word: str | Word, p: Any, guess: Orbit | npt.ArrayLike | None = None) -> Orbit:
    """Return the periodic orbit of a word.

    Of several the symmetric admissible one is returned, else a stable one, else the one with the smallest largest
    multiplier; its remark counts the others and says how they were searched for (`all_orbits`). If none is
    admissible the best of them comes with ``admissible = False`` and the time and side of the violation, and its remark
    says so: what a run settles to there has another word, perhaps one that sticks (`vines.settle`).

    Parameters
    ----------
    word : str or Word
        Such as ``LR``, ``LLR`` or ``LRLR/2T``; of an orbit that sticks with a star, ``L*R``, as `vines.settle` names
        it. A word without a star is that of orbits that never stick.
    p : Params, or the parameters of another system
    guess : Orbit or (N,) array, optional
        An orbit of the word at nearby parameters, or times of the impacts in the canonical order of the word, for a
        forcing of phase zero at t = 0; for a word with a star time and v1 of the release after the first one, two
        numbers; where flights have no closed form (`systems.CubicBarriers`, `systems.Duffing`, `systems.Hybrid`) an
        orbit, or rows of t, x1, v1, x2, v2 (x3, v3) just before each impact; where a ball slides with friction x1, v1,
        v2 and t just before the first impact, four; without impacts an orbit, or the state at phase 0 of the forcing.
        The solution that Newton's method finds from there is returned.

    Returns
    -------
    Orbit

    Raises
    ------
    OrbitNotFound
        If there is none; the message says how near the search came.
    ParameterError
        If `word` is not a word, or the guess does not fit it.

    Examples
    --------
    >>> from vines.model import Params
    >>> orbit = find_orbit("LR", Params(mu=0.01, A=0.017))
    >>> print(orbit.name, orbit.symmetric, orbit.stable, f"{orbit.max_multiplier:.6f}")
    1:1 True True 0.955539
    >>> print(find_orbit("LLR", Params(mu=0.01, A=0.023)).stable)
    True
    """
    word = whole_word(word, p)
    if guess is not None:
        if slides(p) and not word.sticking:
            return refine_slid(word, p, guess)
        if word.sticking and rides_capsule(p):
            return capsule_sticks(word, p)
        if word.sticking and by_sections(p):
            return refine_balls(word, p, guess)
        return refine_sticking(word, p, guess) if word.sticking else refine(word, p, guess)
    found = all_orbits(word, p)
    if found:
        return choose(found)
    if word.sticking and rides_capsule(p):
        return capsule_sticks(word, p)
    if word.sticking:
        raise no_sticking_orbit(word, p, found.remark)
    if isinstance(p, Params) and word.symmetric and len(word) == 2:
        raise no_symmetric_orbit(p, word)
    if isinstance(p, Params) and (word.n == 0 or word.m == 0):
        raise OrbitNotFound(f"no {word} orbit at any parameters: {found.remark}; give a word with both L and R")
    if shoots(p):
        raise OrbitNotFound(f"no {word} orbit at {p}: {found.remark}; give one at nearby parameters as guess")
    if slides(p):
        raise OrbitNotFound(f"no {word} orbit at {p} ({found.remark}); vines.settle says what one settles to")
    nearest = search(word, p)[1] if found.complete else found.nearest
    how = "there is none that never sticks (all flight times were searched); " if found.complete else ""
    raise OrbitNotFound(
        f"no {word} orbit at {p}: {how}the nearest of all starts that failed left a defect of {nearest:.2g} in v2; "
        "try other parameters, or simulate there and give the impact times of the attractor as guess"
    )


def choose(found: Orbits) -> Orbit:
    """Return the orbit to show of several, with a remark that counts the others."""
    best = min(
        found,
        # Mirror images have the same multipliers up to rounding; of them the one that begins first.
        key=lambda orbit: (
            not orbit.admissible,
            not orbit.symmetric,
            not orbit.stable,
            round(orbit.max_multiplier, 9),
            orbit.t[0],
        ),
    )
    others = [orbit for orbit in found if orbit is not best]
    advice = "" if best.admissible else _NONE_ADMISSIBLE
    if not others:
        return replace(best, remark=f"the only solution found of this word ({found.remark}){advice}")
    counts = ", ".join(
        f"{sum(test(orbit) for orbit in others)} {label}"
        for label, test in (
            ("admissible", lambda orbit: orbit.admissible),
            ("symmetric", lambda orbit: orbit.symmetric),
            ("stable", lambda orbit: orbit.stable),
        )
    )
    plural = "s" if len(others) > 1 else ""
    return replace(
        best, remark=f"{len(others)} other solution{plural} of this word, of which {counts} ({found.remark}){advice}"
    )
