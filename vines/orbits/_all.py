"""All orbits of a word at given parameters."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.domains import Parameters, stated
from vines.dynamics.kernels import constants
from vines.errors import ParameterError
from vines.model import Params, Word
from vines.orbits._assemble import assemble
from vines.orbits._closed_form import family_of, impact_states, refuse_resonance, resonant, speeds
from vines.orbits._complete import can_search, search_flights
from vines.orbits._equations import newton_kernel
from vines.orbits._general import ITERATIONS, proper, same
from vines.orbits._joined import mirror_image
from vines.orbits._orbit import Orbit
from vines.orbits._own_word import whole_word
from vines.orbits._seeds import base_word, doubled_times, harvested_times, random_times, simplex_times
from vines.orbits._shooting import refuse_no_walls, shoots
from vines.orbits._shooting_search import gather_shots, of_the_vi_nes
from vines.orbits._slid import slid_orbits
from vines.orbits._slid_round import slides
from vines.orbits._smooth_search import smooth_orbits
from vines.orbits._sticking_capsule import capsule_orbits, rides_capsule
from vines.orbits._sticking_of_balls import by_sections
from vines.orbits._sticking_search import search_sticking
from vines.orbits._sticking_search_of_balls import search_balls
from vines.orbits._values import marks_of, unit_of

__all__ = ["Orbits", "all_orbits"]

LONGEST = 64
"""Most impacts of a word that is searched for: seconds go with the third power of their number."""

Floats = npt.NDArray[np.float64]

_SIMPLEX = 240
"""Random flight times tried for a long word, whatever its length."""

_NEIGHBOURS = (0.8, 0.9, 0.95, 1.05, 1.1, 1.25)
"""Amplitudes, relative to that asked for, at which orbits are harvested and followed from there."""

_STEPS = 12
"""Newton solutions on the way from there."""


class Orbits(list[Orbit]):
    """Orbits of one word at one set of parameters, with what is known about there being more.

    Attributes
    ----------
    complete : bool
        Whether every orbit of the word is in the list, not whether every motion of the system is. True for words of
        two and three impacts, where all flight times are searched; two orbits nearer than 1e-5 of a forcing period,
        next to a fold, may count as one. A word without a star has no orbits that stick, so that nothing is said
        about those; words with a star are complete for the impact pair only, where a release fixes all that follows.
    remark : str
        How they were searched for.
    nearest : float
        The least defect, in a velocity of the ball, at which Newton's method stopped without success; inf if never.
    """

    def __init__(self, found: Iterable[Orbit] = (), *, complete: bool, remark: str, nearest: float) -> None:
        super().__init__(found)
        self.complete = complete
        self.remark = remark
        self.nearest = nearest


@stated(ParameterError, p=Parameters())
def all_orbits(word: str | Word, p: Any, *, proof: bool = False) -> Orbits:
    """Return the orbits of a word, admissible or not, each once.

    Orbits that differ by a shift of time are one. Mirror images of each other are listed apart where the word is its
    own mirror image, such as the asymmetric pair of ``LR``; else the mirror image is an orbit of `Word.mirror`.

    Parameters
    ----------
    word : str or Word
    p : Params, or the parameters of another system
    proof : bool
        Whether what the search leaves out is bounded, by functions of complex times and the balance of energy, and not
        estimated: then nothing but rounding hides an orbit. It takes ten times as long, with heavy balls hundreds of
        times.

    Returns
    -------
    Orbits
        A list in order of largest multiplier, symmetric orbits first. Words of two impacts and of three are searched
        completely (``.complete``), and symmetric orbits of four and six. For longer words the list holds what
        Newton's method finds from stretches of simulations at p and at neighbouring amplitudes, from
        orbits of half the period, and from random flight times, and may lack some. Orbits that stick have words of
        their own (``L*R``), which are searched from a grid of releases and from simulations (docs/sticking.md).

    Raises
    ------
    ParameterError
        If `word` is not a word, or at Omega = 1 without damping.

    Notes
    -----
    docs/orbits.md, "All orbits of a word".

    Examples
    --------
    >>> from vines.model import Params
    >>> found = all_orbits("LR", Params(mu=0.01, A=0.019))
    >>> found.complete, [(orbit.symmetric, orbit.stable) for orbit in found if orbit.admissible]
    (True, [(True, False), (False, True), (False, True)])
    """
    word = whole_word(word, p)
    if word.unstruck:
        found, how = smooth_orbits(word, p)
        return Orbits(_in_order(found), complete=False, remark=how, nearest=np.inf)
    if word.sticking:
        if rides_capsule(p):
            found, how = capsule_orbits(word, p)
            return Orbits(found, complete=True, remark=how, nearest=np.inf)
        if by_sections(p):
            found, how = search_balls(word, p)
            return Orbits(_in_order(found), complete=False, remark=how, nearest=np.inf)
        found, how = search_sticking(word, p)
        return Orbits(_in_order(found), complete=word.n == 0 or word.m == 0, remark=how, nearest=np.inf)
    if slides(p):
        found, how = slid_orbits(word, p)
        return Orbits(_in_order(found), complete=False, remark=how, nearest=np.inf)
    if not shoots(p):
        refuse_resonance(p)
    if len(word) > LONGEST:
        raise ParameterError(
            f"{len(word)} impacts are too many for a search, allowed are {LONGEST}; give find_orbit the times of a "
            "simulation as guess"
        )
    if not isinstance(p, Params):
        return _searched(word, p)
    if word.n == 0 or word.m == 0:
        remark = "every impact on one wall pushes the ball the same way, and nothing brings it back"
        return Orbits(complete=True, remark=remark, nearest=np.inf)
    gathered = _Gathered(word, p)
    if word.symmetric and len(word) == 2:
        family = family_of(p.mu, p.Omega, p.r, p.lam, word.p)
        for V in speeds(family, p.A):
            gathered.add(*impact_states(family, V, p.A, p.Omega))
    complete = True
    for halves in (False, True):
        if can_search(word, halves):
            starts = search_flights(word, p, gathered.c, halves, proof=proof)
            boxes = [sum([gathered.solve(t) for t in times]) > 0 for times in starts.times]
            complete &= starts.whole and all(boxes)
    if can_search(word, halves=False):
        remark = "all flight times searched" if complete else "all flight times searched, in part not to the last level"
        remark += ", with bounds of what interpolants leave out" if proof else ""
        remark += "; orbits that stick have other words"
    else:
        complete = False
        _gather_long(gathered)
        remark = (
            f"Newton's method from {gathered.tried} starts (simulations, neighbouring amplitudes, orbits of half the "
            "period, random flight times): there may be more"
        )
        if can_search(word, halves=True):
            remark += "; of symmetric orbits none is missing"
    gathered.add_mirror_images()
    return Orbits(_in_order(gathered.orbits), complete=complete, remark=remark, nearest=gathered.nearest)


def _searched(word: Word, p: Any) -> Orbits:
    """Return the orbits of a word of another system that simulations and random flight times lead to."""
    if shoots(p):
        return _shot(word, p)
    gathered = _Gathered(word, p)
    for t in (*harvested_times(word, p), *random_times(word, p, _SIMPLEX)):
        gathered.solve(t)
    gathered.add_mirror_images()
    remark = f"Newton's method from {gathered.tried} starts (simulations, random flight times): there may be more"
    return Orbits(_in_order(gathered.orbits), complete=False, remark=remark, nearest=gathered.nearest)


def _shot(word: Word, p: Any) -> Orbits:
    """Return the orbits of a word that are shot for."""
    refuse_no_walls(p)
    linear = of_the_vi_nes(p)
    found, tried = gather_shots(word, p, [] if resonant(linear) else list(all_orbits(word, linear)))
    gathered = _Gathered(word, p)
    for orbit in found:
        gathered.add(orbit.t, orbit.states)
    gathered.add_mirror_images()
    remark = f"Newton's method from {tried} starts (simulations, orbits of the VI-NES): there may be more"
    return Orbits(_in_order(gathered.orbits), complete=False, remark=remark, nearest=np.inf)


def _in_order(orbits: list[Orbit]) -> list[Orbit]:
    return sorted(orbits, key=lambda o: (not o.symmetric, round(o.max_multiplier, 9), o.t[0]))


class _Gathered:
    """The different orbits found so far, and from how many starts they were sought."""

    def __init__(self, word: Word, p: Any) -> None:
        self.word, self.p, self.c = word, p, constants(p)
        self.orbits: list[Orbit] = []
        self.nearest = np.inf
        self.tried = 0
        self._duration = word.p * p.period
        self._side = marks_of(word)

    def solve(self, t: Floats) -> bool:
        """Add what Newton's method finds from impact times, and say whether it converged."""
        self.tried += 1
        converged, t, defect, states = newton_kernel(self.c, self._duration, self._side, t, ITERATIONS)
        if not converged:
            if np.isfinite(defect):
                self.nearest = min(self.nearest, float(defect) / unit_of(self.p))
        elif proper(self.word, self._duration, t, states):
            self.add(t, states)
        return converged

    def add(self, t: Floats, states: Floats) -> None:
        """Add a solution unless it is there."""
        for known in self.orbits:
            if same(known, t, states):
                return
        self.orbits.append(assemble(self.word, self.p, t, states))

    def add_mirror_images(self) -> None:
        """Add the mirror images of asymmetric orbits if they have the same word."""
        if self.word.mirror != self.word or not getattr(self.p, "mirrored", True):
            return
        for orbit in list(self.orbits):
            if not orbit.symmetric:
                image = mirror_image(orbit)
                self.add(image.t, image.states)


def _gather_long(gathered: _Gathered) -> None:
    """Gather orbits of a word that is too long to be searched completely."""
    word, p = gathered.word, gathered.p
    base = base_word(word)
    if base is not None:
        for orbit in all_orbits(base, p):
            for t in doubled_times(orbit):
                gathered.solve(t)
    for t in harvested_times(word, p):
        gathered.solve(t)
    for scale in _NEIGHBOURS:
        away = _Gathered(word, p.replace(A=scale * p.A))
        for t in harvested_times(word, away.p):
            away.solve(t)
        for orbit in away.orbits:
            t = _followed(orbit, p.A)
            if t is not None:
                gathered.solve(t)
    for t in simplex_times(word, p, gathered.c, _SIMPLEX // 2):
        gathered.solve(t)


def _followed(orbit: Orbit, A: float) -> Floats | None:
    """Return the impact times of an orbit followed to the amplitude A in equal steps, None where it is lost."""
    t = orbit.t.copy()  # that of an orbit is read-only, for which the kernel would be compiled once more
    for value in np.linspace(orbit.params.A, A, _STEPS + 1)[1:-1]:
        c = constants(orbit.params.replace(A=float(value)))
        converged, t, _, _ = newton_kernel(c, orbit.period, orbit.side.astype(np.int64), t, ITERATIONS)
        if not converged:
            return None
    return t
