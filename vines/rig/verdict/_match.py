"""Branches of the model that coexist at the measured parameters, up to mirror and half-period shift."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.errors import OrbitNotFound, ParameterError
from vines.model import START_NAMES, Params, Word

if TYPE_CHECKING:
    from vines.orbits import Orbit

__all__ = ["Candidate", "candidates", "same_pattern", "word_of"]

_USUAL = ("LR", "LLR", "LRLR/2T")
_SEARCHED = 4
"""Longest word, in impacts, that all orbits are searched for: up to there the search is all but complete."""

_NEAR = {"mu": 0.15, "A": 0.15, "Omega": 0.01, "r": 0.1, "lam": 0.5}
"""Relative distance at which an orbit of the catalogue says that its branch may exist here."""

_STARTS = ((0.0, 0.0, 0.0, 0.1), (0.5, 0.0, 0.2, -0.4), (-0.3, 0.4, -0.6, 0.5), (0.2, -0.5, 0.9, 0.2))
_SAME = 1e-6
_STRIDES = 8


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A periodic orbit or other attractor of the model at the measured parameters.

    Attributes
    ----------
    name : str
        n:m/pT, or the regime if it is not periodic.
    word : str
        Canonical word; empty if it is not periodic.
    regime : str
        ``periodic``, ``quasiperiodic``, ``chaotic``, ``no_impact`` or ``unsettled``.
    start : mapping of str to float
        A state on it, just after an impact, with the forcing's phase.
    orbit : Orbit or None
        None if it was found by simulation.
    stable : bool
        False for an orbit that the model leaves: it stands for what lies near it.
    source : str
        How it was found: ``search``, ``catalogue`` (followed from a stored orbit), ``simulation``, ``nearby`` (it is
        stable within the uncertainty of the parameters, not at them).
    branch_id : str
        Of the catalogue's branch that it was followed from; else empty.
    """

    name: str
    word: str
    regime: str
    start: Mapping[str, float]
    orbit: Orbit | None
    stable: bool = True
    source: str = "search"
    branch_id: str = ""


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
    """Say whether two words are one up to the mirror (x, t) -> (-x, t + T/2) and to where the ball sticks.

    What is measured are contacts; whether the ball stays on the wall after one does not show in its word.

    Examples
    --------
    >>> same_pattern(Word("LLR"), Word("LRR")), same_pattern(Word("LR"), Word("LLR"))
    (True, False)
    >>> same_pattern(Word("LR*"), Word("LR"))
    True
    """
    one, other = (Word(str(word).replace("*", "")) if word.sticking else word for word in (one, other))
    return str(one) in (str(other), str(other.mirror))


def candidates(
    p: Params,
    word: Word,
    catalogue: Iterable[Mapping[str, Any]] = (),
    spread: Mapping[str, float] | None = None,
) -> tuple[Candidate, ...]:
    """Return the orbits and other attractors that coexist at a set of parameters, each once, and their mirror images.

    Parameters
    ----------
    p : Params
        Measured.
    word : Word
        The measured pattern. Of its own orbits the unstable ones are among the candidates too.
    catalogue : iterable of mapping
        Rows of the table ``orbits``; every branch near `p` is followed to `p`.
    spread : mapping of str to float, optional
        Standard uncertainties: where the measured word has no stable orbit at `p`, it is looked for two of them away.

    Notes
    -----
    A branch of the catalogue is represented by its orbit at the measured parameters, not by the nearest stored one:
    .1 % of Omega turns the phase by 5 degrees. Words of up to four impacts are searched for; longer ones are followed
    from the catalogue and met by simulations.
    """
    rows = _near(p, catalogue)
    wanted = {str(one): one for one in _with_mirrors([word, *map(Word, _USUAL), *(Word(row["word"]) for row in rows)])}
    found: list[Candidate] = []
    for one in wanted.values():
        if len(one) <= _SEARCHED:
            _add(found, _searched(one, p, unstable=same_pattern(one, word)))
    for row in rows:
        if len(Word(row["word"])) > _SEARCHED:
            _add(found, _followed(row, p))
    _add(found, _simulated(p, found))
    shown = [one for one in found if one.word and same_pattern(Word(one.word), word)]
    if len(word) <= _SEARCHED and not any(one.stable for one in shown):
        for moved in _moved(p, spread or {}):
            nearby = [one for image in {word, word.mirror} for one in _searched(image, moved, source="nearby")]
            if nearby:
                _add(found, nearby)
                break
    return tuple(found)


def _with_mirrors(words: Iterable[Word]) -> Iterator[Word]:
    for word in words:
        yield word
        yield word.mirror


def _add(found: list[Candidate], more: Iterable[Candidate]) -> None:
    """Add candidates that are not there yet."""
    for one in more:
        if not any(_same(one, other) for other in found):
            found.append(one)


def _same(one: Candidate, other: Candidate) -> bool:
    """Say whether two candidates are one orbit.

    Not `vines.attractors.apart`: mirror images are two candidates, told apart by the states at their first impacts, and
    so are the orbits of one word.
    """
    if one.word != other.word or one.regime != other.regime:
        return False
    if not one.word:
        return True
    return all(abs(np.sin(0.5 * (one.start[key] - other.start[key]))) < _SAME for key in ("phase", "x1", "v1", "v2"))


def _searched(word: Word, p: Params, *, unstable: bool = False, source: str = "search") -> Iterator[Candidate]:
    from vines.orbits import all_orbits

    for orbit in all_orbits(word, p):
        if orbit.admissible and (orbit.stable or unstable):
            yield _of_orbit(orbit, source)


def _of_orbit(orbit: Orbit, source: str, branch_id: str = "") -> Candidate:
    start = {**orbit.start(), "phase": float(orbit.phase[0])}
    del start["t"]
    return Candidate(orbit.name, str(orbit.word), "periodic", start, orbit, orbit.stable, source, branch_id)


def _followed(row: Mapping[str, Any], p: Params) -> Iterator[Candidate]:
    """Follow a stored orbit along the straight line from its parameters to `p`."""
    from vines.orbits import find_orbit, mirror_image

    begin = {name: float(row[name]) for name in _NEAR}
    guess: Any = np.asarray(row["t"], dtype=np.float64)
    try:
        for share in np.linspace(0.0, 1.0, _STRIDES + 1):
            at = Params(**{name: begin[name] + share * (getattr(p, name) - begin[name]) for name in _NEAR})
            guess = find_orbit(row["word"], at, guess=guess)
    except (OrbitNotFound, ParameterError):
        return
    if guess.admissible and guess.stable:
        branch_id = str(row.get("branch_id") or "")
        yield _of_orbit(guess, "catalogue", branch_id)
        if not guess.symmetric:
            yield _of_orbit(mirror_image(guess), "catalogue", branch_id)


def _simulated(p: Params, found: Sequence[Candidate]) -> Iterator[Candidate]:
    """Return what simulations from a few starts settle to, if it is none of the orbits found, and its mirror image."""
    from vines.attractors import settle_from

    for begin in _STARTS:
        settled = settle_from(p, dict(zip(START_NAMES, (*begin, 0.0), strict=True)), settle=300, lyapunov=False)
        periodic = settled.regime == "periodic"
        word = str(settled.word or "") if periodic else ""
        if word and any(same_pattern(Word(one.word), Word(word)) and one.stable for one in found if one.word):
            continue
        name = str(settled.name) if periodic else settled.regime
        state = {key: float(settled.final[key]) for key in START_NAMES}
        yield Candidate(name, word, settled.regime, state, None, source="simulation")
        if periodic and not settled.symmetric:
            image = {key: -value for key, value in state.items() if key != "phase"}
            image["phase"] = float((state["phase"] + np.pi) % (2 * np.pi))
            other = Word(word).mirror
            yield Candidate(_mirrored(name), str(other), settled.regime, image, None, source="simulation")


def _mirrored(name: str) -> str:
    """Return n:m/pT of the mirror image.

    Examples
    --------
    >>> _mirrored("2:1"), _mirrored("3:2/2T")
    ('1:2', '2:3/2T')
    """
    counts, *rest = name.split("/")
    n, m = counts.split(":")
    return "/".join([f"{m}:{n}", *rest])


def _near(p: Params, catalogue: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the nearest row of each branch of the catalogue that comes near `p`."""
    nearest: dict[tuple[str, str], tuple[float, Mapping[str, Any]]] = {}
    for row in catalogue:
        apart = [abs(float(row[name]) / getattr(p, name) - 1) / _NEAR[name] for name in _NEAR if getattr(p, name)]
        if not np.all(np.asarray(apart) <= 1):
            continue
        key, far = (str(row["word"]), str(row.get("branch_id") or "")), float(np.hypot.reduce(apart))
        if key not in nearest or far < nearest[key][0]:
            nearest[key] = (far, row)
    return [row for _, row in nearest.values()]


def _moved(p: Params, spread: Mapping[str, float]) -> Iterator[Params]:
    """Return parameters two standard uncertainties away in one of those that matter."""
    for name in ("A", "Omega", "r"):
        for sign in (-2, 2):
            if u := spread.get(name, 0.0):
                value = getattr(p, name) + sign * u
                yield p.replace(**{name: min(value, 1.0) if name == "r" else max(value, 1e-9)})
