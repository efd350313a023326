"""Stable orbits beside one that has lost its stability: of twice its period, or without its symmetry."""

from __future__ import annotations

from collections.abc import Iterator

from vines.errors import OrbitNotFound, ParameterError
from vines.orbits._find import find_orbit
from vines.orbits._general import same
from vines.orbits._orbit import Orbit
from vines.orbits._seeds import asymmetric_times, doubled_times

__all__ = ["partners"]

_MOST = 64
"""Most impacts of an orbit of twice the period."""


def partners(orbit: Orbit) -> Iterator[Orbit]:
    """Yield admissible stable orbits that Newton's method finds along the direction in which an orbit is unstable.

    Of one with impacts and without sticking whose largest multiplier is real: below -1 orbits of twice the period,
    above 1 and symmetric such without the symmetry.

    Examples
    --------
    >>> from vines.model import Params
    >>> next(partners(find_orbit("LR", Params(mu=0.01, A=0.019)))).symmetric
    False
    """
    largest = complex(orbit.multipliers[0])
    if orbit.word.sticking or orbit.word.unstruck or abs(largest) <= 1 or abs(largest.imag) > 1e-9 * abs(largest):
        return
    if largest.real < 0:
        if 2 * len(orbit.word) > _MOST:
            return
        word = orbit.word.doubled
        guesses = doubled_times(orbit)
    elif orbit.symmetric:
        word, guesses = orbit.word, asymmetric_times(orbit)
    else:
        return
    for guess in guesses:
        try:
            found = find_orbit(word, orbit.params, guess=guess)
        except (OrbitNotFound, ParameterError):
            continue
        if found.stable and found.admissible and not (word == orbit.word and same(orbit, found.t, found.states)):
            yield found
