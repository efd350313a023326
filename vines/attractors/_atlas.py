"""A catalogue of the stable orbits over a rectangle of two parameters.

Not the stage kind ``atlas``, which lists all orbits, unstable ones too, of words up to a length, line by line.

Orbits are sought at some nodes of a grid by their equations, and from simulations at random places; each is carried
from node to node for as long as it is stable, and what comes out of it where it loses its stability goes the same way
(docs/orbits.md, "An atlas of stable orbits").
"""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._classify import classify_many
from vines.attractors._orbit_of import orbit_through
from vines.bounds import shown
from vines.domains import Numbers, Of, Parameters, Whole, listed, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.model import PARAMETER_NAMES, START_NAMES, VI_NES, Params, Word, word_for
from vines.orbits import Orbit, all_orbits, carry_orbit, of_two_mirror_images, one_of, partners, words_up_to

__all__ = ["Atlas", "Entry", "atlas"]

Place = tuple[float, float]

EQUATION, RUN = "equation", "run"
"""How an orbit, or the one that it was carried from, was found first."""

_HALVINGS = 8
"""Of the way between two nodes, to find where on it an orbit loses its stability."""

_BEYOND = (0.01, 0.03, 0.1, 0.3)
"""How far beyond that place, as a share of what is left of the way, what comes out of the orbit is looked for."""

_MOST_RUNS = 10_000_000
"""Most simulations: they take hours."""

_NEAR = 2.0
"""Farthest place, in steps of the grid, to which an orbit is carried to be compared."""

_COMPARED = 8
"""Most orbits of its word that an orbit is carried to."""


@dataclass(frozen=True, slots=True)
class Entry:
    """An orbit of an atlas.

    Attributes
    ----------
    place : tuple of float, float
        Where it lies in the grid, in steps from the first values of the axes: whole numbers at a node.
    orbit : Orbit
        Stable and admissible; of two mirror images one.
    source : str
        ``equation`` if it, or the one from which it was carried, was found by a search of its word; ``run`` if only a
        simulation told of it.
    """

    place: Place
    orbit: Orbit
    source: str


@dataclass(frozen=True)
class _Index:
    """Entries by the cell of the grid in which they lie."""

    axes: dict[str, list[float]]
    cells: dict[tuple[int, int], list[Entry]] = field(default_factory=dict)

    def place(self, p: Any) -> Place:
        """Return where parameters lie in the grid."""
        first, second = (
            float(np.interp(p.as_dict()[name], values, np.arange(len(values)))) for name, values in self.axes.items()
        )
        return first, second

    def add(self, entry: Entry) -> None:
        self.cells.setdefault((int(entry.place[0]), int(entry.place[1])), []).append(entry)

    def at(self, place: Place) -> list[Entry]:
        """Return the entries just there."""
        return [entry for entry in self.cells.get((int(place[0]), int(place[1])), []) if entry.place == place]

    def find(self, orbit: Orbit) -> Entry | None:
        """Return an entry nearby that an orbit becomes when it is carried there, None if there is none."""
        orbit = of_two_mirror_images(orbit)
        for entry in itertools.islice(self._around(orbit), _COMPARED):
            try:
                there = carry_orbit(orbit, entry.orbit.params) if entry.orbit.params != orbit.params else orbit
            except OrbitNotFound:
                continue
            if one_of([entry.orbit], there) is not None:
                return entry
        return None

    def _around(self, orbit: Orbit) -> Iterator[Entry]:
        """Yield the entries of the word of an orbit, those nearest to it first."""
        i, j = self.place(orbit.params)
        cells = itertools.product(range(int(i) - 2, int(i) + 3), range(int(j) - 2, int(j) + 3))
        known = [
            (math.hypot(entry.place[0] - i, entry.place[1] - j), n, entry)
            for n, cell in enumerate(cells)
            for entry in self.cells.get(cell, [])
            if entry.orbit.word == orbit.word
        ]
        yield from (entry for away, _, entry in sorted(known, key=lambda each: each[:2]) if away < _NEAR)


@dataclass(frozen=True)
class Atlas:
    """The stable orbits found over a grid of two parameters.

    Attributes
    ----------
    params : Params
        The other parameters, those at the first node.
    axes : dict of str to list of float
        The two parameters and their values.
    entries : list of Entry
        At the nodes all that was found there; between them those that a run told of, and the first ones of families
        that come out of another one between two nodes.
    searched : dict of Word to bool
        The words that were searched by their equations, and whether that was exhaustive at every node where they were:
        of orbits that never stick for a word without a star, and never for one with a star.
    nodes : list of tuple of int, int
        The nodes at which they were searched.
    runs : int
        Simulations.
    lost : int
        Periodic attractors of them of which Newton's method found no orbit.
    """

    params: Params
    axes: dict[str, list[float]]
    entries: list[Entry]
    searched: dict[Word, bool]
    nodes: list[tuple[int, int]]
    runs: int
    lost: int
    _index: _Index = field(repr=False)

    @property
    def words(self) -> list[Word]:
        """The words of the orbits, the most frequent ones first."""
        names = [entry.orbit.word for entry in self.entries]
        return sorted(set(names), key=lambda word: (-names.count(word), str(word)))

    def at(self, i: int, j: int) -> list[Orbit]:
        """Return the stable orbits at a node, counted from 0 along either axis."""
        return [entry.orbit for entry in self._index.at((i, j))]

    @stated(ParameterError, orbit=Of("Orbit", how="as vines.find_orbit returns it"))
    def entry_of(self, orbit: Orbit) -> Entry | None:
        """Return an entry of the family that an orbit anywhere in the rectangle belongs to, None if it is missing.

        The orbit is carried to the entries of its word around it, the nearest first, and compared there.

        Parameters
        ----------
        orbit : Orbit
            With the other parameters of the atlas.

        Raises
        ------
        ParameterError
            If it lies outside the rectangle, or has other parameters than the atlas beside the two.
        """
        self._check_inside(orbit.params)
        return self._index.find(orbit)

    def _check_inside(self, p: Any) -> None:
        """Raise `ParameterError` unless the atlas is about these parameters."""
        if not isinstance(p, Params):
            raise ParameterError(f"orbit is of {type(p).__name__}; an atlas is of vines.Params alone")
        for name, value in p.as_dict().items():
            if name in self.axes:
                low, high = self.axes[name][0], self.axes[name][-1]
                if not low <= value <= high:
                    raise ParameterError(
                        f"{name} of the orbit is {value:g}, the atlas goes from {low:g} to {high:g}; give one in there"
                    )
            elif value != getattr(self.params, name):
                raise ParameterError(
                    f"{name} of the orbit is {value!r}, that of the atlas is {getattr(self.params, name)!r}; "
                    "carry_orbit takes it there"
                )


class _Growing:
    """An atlas on its way: what is known, and the entries whose neighbours were not looked at yet."""

    def __init__(self, p: Params, axes: dict[str, list[float]]) -> None:
        self.p, self.axes = p, axes
        self.index = _Index(axes)
        self.queue: deque[Entry] = deque()

    def params(self, place: Place) -> Params:
        """Return the parameters at a place of the grid."""
        values = (np.interp(k, np.arange(len(v)), v) for k, v in zip(place, self.axes.values(), strict=True))
        return self.p.replace(**{name: float(value) for name, value in zip(self.axes, values, strict=True)})

    def nodes(self) -> list[tuple[int, int]]:
        """Return all nodes."""
        first, second = (range(len(values)) for values in self.axes.values())
        return list(itertools.product(first, second))

    def add(self, place: Place, orbit: Orbit, source: str) -> Entry | None:
        """Add an orbit, unless it is there already or not stable and admissible, and return it."""
        if not (orbit.stable and orbit.admissible):
            return None
        try:
            orbit = of_two_mirror_images(orbit)
        except OrbitNotFound:
            return None
        if one_of([entry.orbit for entry in self.index.at(place)], orbit) is not None:
            return None
        entry = Entry(place, orbit, source)
        self.index.add(entry)
        self.queue.append(entry)
        return entry

    def add_between(self, orbit: Orbit, source: str) -> None:
        """Add an orbit at a place between nodes, unless it is of a family that is known around it."""
        if self.index.find(orbit) is None:
            self.add(self.index.place(orbit.params), orbit, source)

    def spread(self) -> None:
        """Carry orbits to the nodes beside them until nothing new comes."""
        while self.queue:
            entry = self.queue.popleft()
            for node in self._beside(entry.place):
                self._go(entry, node)

    def _beside(self, place: Place) -> Iterator[tuple[int, int]]:
        """Yield the nodes next to a place: four around a node, and between nodes those of its edge or cell."""
        i, j = place
        if i == int(i) and j == int(j):
            near = [(int(i) + 1, int(j)), (int(i) - 1, int(j)), (int(i), int(j) + 1), (int(i), int(j) - 1)]
        else:
            near = sorted(itertools.product({math.floor(i), math.ceil(i)}, {math.floor(j), math.ceil(j)}))
        for node in near:
            if all(0 <= k < len(values) for k, values in zip(node, self.axes.values(), strict=True)):
                yield node

    def _go(self, entry: Entry, node: tuple[int, int]) -> None:
        """Carry an orbit to a node; where it loses its stability on the way go on with what comes out of it."""
        try:
            there = carry_orbit(entry.orbit, self.params(node))
        except OrbitNotFound:
            return
        if there.stable:
            self.add(node, there, entry.source)
            return
        if not _splits(there):
            return
        for partner in partners(there):
            self.add(node, partner, entry.source)
        low, high = 0.0, 1.0
        last = entry.orbit
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            try:
                between = carry_orbit(last, self.params(_towards(entry.place, node, middle)))
            except OrbitNotFound:
                return
            if between.stable:
                low, last = middle, between
            else:
                high = middle
        for share in _BEYOND:
            place = _towards(entry.place, node, high + share * (1.0 - high))
            try:
                beyond = carry_orbit(last, self.params(place))
            except OrbitNotFound:
                return
            for partner in partners(beyond):
                if self.index.find(partner) is None and self.add(place, partner, entry.source) is not None:
                    return


def _towards(place: Place, node: tuple[int, int], share: float) -> Place:
    return place[0] + share * (node[0] - place[0]), place[1] + share * (node[1] - place[1])


def _splits(orbit: Orbit) -> bool:
    """Say whether an unstable orbit may have lost its stability to one of twice its period, or without its symmetry."""
    return orbit.admissible and not orbit.word.sticking and abs(orbit.multipliers[0].imag) == 0.0


@stated(
    ParameterError,
    p=Parameters(any_system=False),
    every=Whole(least=1),
    runs=Whole(least=0, most=_MOST_RUNS),
    seed=Whole(least=0),
)
def atlas(
    p: Params,
    axes: Mapping[str, npt.ArrayLike],
    *,
    words: Sequence[str | Word] | None = None,
    every: int = 4,
    runs: int = 0,
    seed: int = 0,
) -> Atlas:
    """Return the stable orbits over a rectangle of two parameters.

    The stage kind ``atlas`` of a pipeline is another thing: it lists all orbits, unstable ones too, of words up to a
    length, and follows them along lines of the forcing amplitude, without simulations.

    Parameters
    ----------
    p : Params
        The other parameters.
    axes : dict of str to sequence of float
        The two parameters and their increasing values, such as ``{"A": [...], "Omega": [...]}``.
    words : sequence of str or Word, optional
        Words that are searched by their equations (`vines.all_orbits`), starred ones included; by default all of two
        and three impacts over one to three forcing periods, whose search is exhaustive, and ``L*R*``.
    every : int
        Every how many nodes, along either axis, they are searched.
    runs : int
        Simulations at random places from random starts, whose attractors are added.
    seed : int
        Of these places and starts.

    Returns
    -------
    Atlas
        At each node the different stable admissible orbits, of two mirror images one. What neither a search of `words`
        nor a run has met, nor comes out of what they have met, is missing: runs are no proof, and of what was searched
        a family is not seen that lives between the nodes of the search alone.

    Raises
    ------
    ParameterError
        If a parameter or word is not allowed, or the axes are not two parameters with increasing values.

    Notes
    -----
    docs/orbits.md, "An atlas of stable orbits".

    Examples
    --------
    >>> found = atlas(Params(mu=0.01, A=0.02), {"A": [0.017, 0.019], "Omega": [1.0, 1.002]}, words=["LR"])
    >>> [(entry.place, entry.orbit.symmetric) for entry in found.entries if entry.place[1] == 0]
    [((0, 0), True), ((1, 0), False)]
    """
    grid = _checked(p, axes)
    wanted = _wanted(words)
    growing = _Growing(p, grid)
    chosen = [node for node in growing.nodes() if all(k % every == every // 2 for k in node)] or [(0, 0)]
    searched = dict.fromkeys(wanted, True)
    for word, node in itertools.product(wanted, chosen):
        orbits = all_orbits(word, growing.params(node))
        searched[word] &= orbits.complete
        for orbit in orbits:
            growing.add(node, orbit, EQUATION)
    growing.spread()
    lost = _run(growing, runs, seed) if runs else 0
    entries = [entry for known in growing.index.cells.values() for entry in known]
    entries.sort(key=lambda entry: entry.place)
    return Atlas(growing.params((0, 0)), grid, entries, searched, chosen, runs, lost, growing.index)


def _run(growing: _Growing, runs: int, seed: int) -> int:
    """Add what runs settle to; return how many of these orbits were not found."""
    rng = np.random.default_rng(seed)
    x1, v1 = rng.uniform(-1, 1, (2, runs))
    begin = (x1, v1, x1 - rng.uniform(-1, 1, runs), rng.uniform(-2, 2, runs))
    starts = dict(zip(START_NAMES, (*begin, rng.uniform(0, 2 * np.pi, runs)), strict=True))
    sizes = [len(values) - 1 for values in growing.axes.values()]
    places = zip(*(rng.uniform(0, size, runs).tolist() for size in sizes), strict=True)
    points = [growing.params(place) for place in places]
    table = np.array([[getattr(p, name) for name in PARAMETER_NAMES] for p in points])
    many = classify_many(dict(zip(PARAMETER_NAMES, table.T, strict=True)), starts, errors=False)
    lost = 0
    for k, p in enumerate(points):
        if many.words[k] is None or many.regime[k] != "periodic":
            continue
        try:
            orbit = orbit_through(many.words[k], p, dict(zip(START_NAMES, many.final[k].tolist(), strict=True)))
        except OrbitNotFound:
            lost += 1
            continue
        growing.add_between(orbit, RUN)
        # At once, so that the next runs on the same family are known.
        growing.spread()
    return lost


def _wanted(words: Sequence[str | Word] | None) -> list[Word]:
    """Return the words to be searched, or raise `ParameterError`."""
    if words is None:
        return [*words_up_to(3, period=3), Word("L*R*")]
    given = listed(words)
    if given is None:
        raise ParameterError(f"words is {shown(words)}; give a list of words, such as ['LR', 'L*R*']")
    return [word_for(word, VI_NES) for word in given]


def _checked(p: Params, axes: Mapping[str, npt.ArrayLike]) -> dict[str, list[float]]:
    """Return the axes as lists, or raise `ParameterError`."""
    if not isinstance(axes, Mapping) or len(axes) != 2:
        raise ParameterError(
            f"axes is {shown(axes)}; give two parameters and their values, as {{'A': [0.01, 0.02], 'Omega': [1.0]}}"
        )
    grid: dict[str, list[float]] = {}
    for name, values in axes.items():
        p.system.parameter(name)
        Numbers(least=1).check(name, values, ParameterError)
        numbers = np.asarray(values, dtype=np.float64)
        if not np.all(np.diff(numbers) > 0):
            raise ParameterError(f"the values of {name} do not increase; give a list of numbers that do")
        for value in numbers.tolist():
            p.replace(**{name: value})
        grid[name] = numbers.tolist()
    return grid
