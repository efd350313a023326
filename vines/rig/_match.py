"""Branches of the model that coexist at the measured parameters, up to mirror and half-period shift."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.model import Params, Word

if TYPE_CHECKING:
    from vines.orbits import Orbit

__all__ = ["Candidate", "candidates", "same_pattern", "word_of"]

_USUAL = ("LR", "LLR", "LRR")
_SEARCHED = 4
_NEAR = {"mu": 0.15, "A": 0.15, "Omega": 0.01, "r": 0.1, "lam": 0.5}
"""Relative distance at which an orbit of the catalogue says that its word may exist here."""

_STARTS = ((0.0, 0.0, 0.0, 0.1), (0.5, 0.0, 0.2, -0.4), (-0.3, 0.4, -0.6, 0.5), (0.2, -0.5, 0.9, 0.2))


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """An attractor of the model at the measured parameters.

    Attributes
    ----------
    name : str
        n:m/pT, or the regime if it is not periodic.
    word : str
        Canonical word; empty if it is not periodic.
    regime : str
        ``periodic``, ``quasiperiodic``, ``chaotic``, ``no_impact`` or ``unsettled``.
    start : mapping of str to float
        A state on it, with the forcing's phase.
    orbit : Orbit or None
    """

    name: str
    word: str
    regime: str
    start: Mapping[str, float]
    orbit: Orbit | None


def word_of(words: Sequence[str]) -> Word:
    """Return the word of the sides in each of p periods.

    Examples
    --------
    >>> str(word_of(("RL",))), str(word_of(("LR", "LR")))
    ('LR', 'LRLR/2T')
    """
    letters = "".join(words)
    return Word(letters if len(words) == 1 else f"{letters}/{len(words)}T")


def same_pattern(one: Word, other: Word) -> bool:
    """Say whether two words are one up to the mirror (x, t) -> (-x, t + T/2).

    Examples
    --------
    >>> same_pattern(Word("LLR"), Word("LRR")), same_pattern(Word("LR"), Word("LLR"))
    (True, False)
    """
    return str(one) in (str(other), str(other.mirror))


def candidates(
    p: Params, words: Iterable[str | Word] = (), catalogue: Sequence[Mapping[str, Any]] = ()
) -> tuple[Candidate, ...]:
    """Return the stable admissible orbits and the settled attractors at a set of parameters, each once.

    Parameters
    ----------
    p : Params
        Measured.
    words : iterable of Word
        Words to look for, with their mirror images: that of the measured pattern.
    catalogue : sequence of mapping
        Rows of the table ``orbits``; the words of those near `p` are looked for too.

    Notes
    -----
    A branch of the catalogue is represented by its orbit at the measured parameters, not by the nearest stored one:
    .1 % of Omega turns the phase by 5 degrees. Words of more than four impacts are taken from simulations only.
    """
    from vines.attractors import settle
    from vines.orbits import all_orbits

    wanted: dict[str, Word] = {}
    for word in [*words, *_USUAL, *_near(p, catalogue)]:
        one = Word(word)
        wanted[str(one)] = one
        wanted[str(one.mirror)] = one.mirror
    found: list[Candidate] = []
    for word in wanted.values():
        if len(word) > _SEARCHED:
            continue
        for orbit in all_orbits(word, p):
            if orbit.stable and orbit.admissible:
                start = {**orbit.start(), "phase": float(orbit.phase[0])}
                del start["t"]
                found.append(Candidate(orbit.name, str(orbit.word), "periodic", start, orbit))
    for start in _STARTS:
        settled = settle(p, **dict(zip(("x1", "v1", "x2", "v2"), start, strict=True)), settle=300, lyapunov=False)
        name = settled.name if settled.regime == "periodic" else settled.regime
        word = str(settled.word or "") if settled.regime == "periodic" else ""
        if word and any(same_pattern(Word(one.word), Word(word)) for one in found if one.word):
            continue
        if not word and any(one.regime == settled.regime for one in found):
            continue
        state = {key: float(settled.final[key]) for key in ("x1", "v1", "x2", "v2", "phase")}
        found.append(Candidate(str(name), word, settled.regime, state, None))
    return tuple(found)


def _near(p: Params, catalogue: Sequence[Mapping[str, Any]]) -> list[str]:
    words = set()
    for row in catalogue:
        apart = {name: abs(float(row[name]) / getattr(p, name) - 1) for name in _NEAR if getattr(p, name)}
        if all(value <= _NEAR[name] for name, value in apart.items()) and np.isfinite(list(apart.values())).all():
            words.add(str(row["word"]))
    return sorted(words)
