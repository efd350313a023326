"""The orbit that a periodic run has settled to."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from vines.attractors._attractor import Attractor
from vines.domains import Of, stated
from vines.dynamics import simulate
from vines.dynamics.kernels import rows as col
from vines.errors import OrbitNotFound, ParameterError
from vines.model import STATE_NAMES, VI_NES, Params, Word
from vines.orbits import Orbit, find_orbit

__all__ = ["orbit_of", "orbit_through"]

_TRIED = 8
"""Repetitions of the word, or releases, from which Newton's method sets out."""


@stated(ParameterError, attractor=Of("Attractor", how="as vines.settle returns it"))
def orbit_of(attractor: Attractor) -> Orbit:
    """Return the periodic orbit that an attractor is, with the multipliers and measures of `vines.find_orbit`.

    It is found from the attractor itself, so that it is the one of its word that the run settled to.

    Parameters
    ----------
    attractor : Attractor
        A periodic one of the VI-NES, or a settled motion without impacts of the type 0:0.

    Raises
    ------
    OrbitNotFound
        If it is not periodic, or Newton's method finds no orbit of its word from there.
    ParameterError
        If it is of another system.

    Examples
    --------
    >>> from vines.attractors import settle
    >>> from vines.model import Params
    >>> orbit = orbit_of(settle(Params(mu=0.01, A=0.023)))
    >>> orbit.word.name, orbit.stable, orbit.admissible
    ('2:1', True, True)
    """
    if attractor.params.system.smooth and attractor.regime == "no_impact" and attractor.name is not None:
        return _unstruck(Word(attractor.name), attractor.params, attractor.final)
    if not isinstance(attractor.params, Params):
        raise ParameterError(
            f"attractor is of {type(attractor.params).__name__}, this is there for vines.Params alone; "
            "vines.find_orbit takes its word"
        )
    if attractor.word is None:
        raise OrbitNotFound(f"the attractor is {attractor.regime}, only a periodic one is an orbit; settle elsewhere")
    return orbit_through(Word(str(attractor.word)), attractor.params, attractor.final)


def _unstruck(word: Word, p: Any, final: Mapping[str, float]) -> Orbit:
    """Return the orbit without impacts that a run is on, from where it comes through phase 0 next."""
    at: dict[str, Any] = {each.name: final[each.name] for each in p.system.state}
    ahead = (2 * math.pi - final["phase"] % (2 * math.pi)) / (2 * math.pi)
    end = simulate(p, **at, phi=final["phase"], periods=ahead).final
    return find_orbit(word, p, guess=[end[name] for name in at])


def orbit_through(word: Word, p: Any, final: Mapping[str, float]) -> Orbit:
    """Return the orbit of a word that a run is on: its coordinates and the forcing phase [rad] at some instant.

    Raises
    ------
    OrbitNotFound
        If Newton's method finds none from there.
    """
    for guess in _guesses(word, p, final):
        try:
            return find_orbit(word, p, guess=guess)
        except (OrbitNotFound, ParameterError):
            continue
    raise OrbitNotFound(f"no {word} orbit at {p} from the run that settled to it; let it settle for longer")


def _guesses(word: Word, p: Any, final: Mapping[str, float]) -> Iterator[list[float]]:
    """Yield times of the contacts of the word, or time and velocity of a release, along the run."""
    at: dict[str, Any] = {name: final[name] for name in STATE_NAMES}
    run = simulate(p, **at, phi=final["phase"], periods=2 * word.p + 1, max_impacts_per_period=2000)
    early = final["phase"] / p.Omega
    if word.sticking:
        events = run.events[run.events["kind"] == col.RELEASE]
        yield from ([event["phase"] / p.Omega, event["v1"]] for event in events[-_TRIED:])
        return
    hits, N = run.impacts, len(word)
    letters = VI_NES.letters(hits["side"])
    places = [k for k in range(len(hits) - N + 1) if letters[k : k + N] == word.letters]
    yield from ((np.asarray(hits["t"][k : k + N]) + early).tolist() for k in places[:_TRIED])
