"""An orbit carried to other parameters, and one of a set that it is there."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from vines.domains import Of, Parameters, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Word
from vines.orbits._find import find_orbit
from vines.orbits._general import same
from vines.orbits._joined import mirror_image
from vines.orbits._orbit import Orbit

__all__ = ["carry_orbit", "of_two_mirror_images", "one_of"]

_FAR = 0.25
"""Largest change of a phase [rad] or of a state in a step: beyond it the step is halved, lest another orbit be met."""

_SMALLEST = 1.0 / 32.0


@stated(ParameterError, orbit=Of("Orbit", how="as vines.find_orbit returns it"), p=Parameters())
def carry_orbit(orbit: Orbit, p: Any) -> Orbit:
    """Return what an orbit becomes at other parameters, on a straight line to there.

    Newton's method in steps, each of which may change phases by .25 rad and states by .25; what is met on the way is
    not looked for (`continue_orbit` does).

    Parameters
    ----------
    orbit : Orbit
    p : Params, or those of the orbit's system

    Returns
    -------
    Orbit
        Of the same word, admissible or not, stable or not.

    Raises
    ------
    OrbitNotFound
        If the family ends on the way, or steps of 1/32 of it do not follow it.
    ParameterError
        If the parameters are those of another system.

    Examples
    --------
    >>> from vines.model import Params
    >>> orbit = carry_orbit(find_orbit("LR", Params(mu=0.01, A=0.017)), Params(mu=0.01, A=0.02, Omega=1.01))
    >>> orbit.word, orbit.params.Omega, orbit.stable
    (Word('LR'), 1.01, True)
    """
    if type(p) is not type(orbit.params):
        raise ParameterError(f"p is of {p.system.name!r}, the orbit of {orbit.params.system.name!r}; give one system")
    begin, end = orbit.params.as_dict(), p.as_dict()
    here, share, step = orbit, 0.0, 1.0
    while share < 1.0:
        to = min(share + step, 1.0)
        between = (
            p if to == 1.0 else p.replace(**{k: _between(begin[k], end[k], to) for k in end if end[k] != begin[k]})
        )
        there = _refined(here, between)
        if there is not None and _change(here, there) < _FAR:
            here, share, step = there, to, 2.0 * step
            continue
        step /= 2.0
        if step < _SMALLEST:
            raise OrbitNotFound(f"the {orbit.word} orbit is lost on the way from {orbit.params} to {p}; follow it")
    return here


def _between(begin: Any, end: Any, share: float) -> Any:
    """Return a number, or one for every ball, so far on the way from one to another."""
    mixed = (1.0 - share) * np.asarray(begin, dtype=np.float64) + share * np.asarray(end, dtype=np.float64)
    return tuple(mixed.tolist()) if mixed.ndim else float(mixed)


def _refined(orbit: Orbit, p: Any) -> Orbit | None:
    try:
        return find_orbit(orbit.word, p, guess=orbit)
    except (OrbitNotFound, ParameterError):
        return None


def _change(before: Orbit, after: Orbit) -> float:
    """Return the largest change of a phase or a state, whichever repetition of the word is the first of each."""
    N, least = len(before.t), np.inf
    old = 2.0 * np.pi * before.t / before.params.period
    for k in after.word.rotations():
        new = 2.0 * np.pi * np.append(after.t[k:], after.t[:k] + after.period) / after.params.period
        late = new - old
        late -= 2.0 * np.pi * np.round(late[0] / (2.0 * np.pi))
        states = after.states[np.arange(k, k + N) % N] - before.states
        least = min(least, float(max(np.abs(late).max(), np.abs(states).max())))
    return least


def of_two_mirror_images(orbit: Orbit) -> Orbit:
    """Return an orbit or its mirror image: that whose word has more L, and of these the first.

    Examples
    --------
    >>> from vines.model import Params
    >>> of_two_mirror_images(find_orbit("LRR", Params(mu=0.01, A=0.023))).word
    Word('LLR')
    """
    if orbit.word == _first(orbit.word):
        return orbit
    return mirror_image(orbit)


def _first(word: Word) -> Word:
    return min(word, word.mirror, key=lambda one: (-one.n, one.letters))


def one_of(orbits: Iterable[Orbit], orbit: Orbit) -> Orbit | None:
    """Return which of some orbits at the same parameters an orbit is, or its mirror image; None if none of them."""
    alike = [each for each in orbits if each.word == orbit.word]
    for each in alike:
        if same(each, orbit.t, orbit.states):
            return each
    if alike and not orbit.symmetric and orbit.word.mirror == orbit.word and orbit.params.mirrored:
        try:
            image = mirror_image(orbit)
        except OrbitNotFound:
            return None
        return next((each for each in alike if same(each, image.t, image.states)), None)
    return None
