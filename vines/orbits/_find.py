"""The orbit of a word at given parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from vines.errors import OrbitNotFound
from vines.model import Params, Word
from vines.orbits._orbit import Orbit
from vines.orbits._symmetric import no_symmetric_orbit, symmetric_orbits

__all__ = ["find_orbit"]


def find_orbit(word: str | Word, p: Params) -> Orbit:
    """Return the periodic orbit of a word.

    Of several the symmetric admissible one is returned, else a stable one, else the one with the smallest largest
    multiplier; its remark counts the others. If none is admissible the best of them comes with
    ``admissible = False`` and the time and side of the violation.

    Parameters
    ----------
    word : str or Word
        Such as ``LR`` or ``LR/3T``.
    p : Params

    Returns
    -------
    Orbit

    Raises
    ------
    OrbitNotFound
        If there is none; the message says how near the search came.
    ParameterError
        If `word` is not a word.

    Examples
    --------
    >>> from vines.model import Params
    >>> orbit = find_orbit("LR", Params(mu=0.01, A=0.017))
    >>> print(orbit.name, orbit.symmetric, orbit.stable, f"{orbit.max_multiplier:.4f}")
    1:1 True True ...
    """
    word = Word(word)
    if not (word.symmetric and len(word) == 2):
        raise OrbitNotFound(
            f"no search for {word} yet without the symmetry of 1:1/pT, p odd; try LR, or simulate and settle"
        )
    found = symmetric_orbits(p, word.p)
    if not found:
        raise no_symmetric_orbit(p, word)
    return choose(found)


def choose(found: Sequence[Orbit]) -> Orbit:
    """Return the orbit to show of several, with a remark that counts the others."""
    best = min(
        found,
        key=lambda orbit: (not orbit.admissible, not orbit.symmetric, not orbit.stable, orbit.max_multiplier),
    )
    others = [orbit for orbit in found if orbit is not best]
    if not others:
        return best
    counts = ", ".join(
        f"{sum(test(orbit) for orbit in others)} {label}"
        for label, test in (
            ("admissible", lambda orbit: orbit.admissible),
            ("symmetric", lambda orbit: orbit.symmetric),
            ("stable", lambda orbit: orbit.stable),
        )
    )
    plural = "s" if len(others) > 1 else ""
    return replace(best, remark=f"{len(others)} other solution{plural} of this word, of which {counts}")
