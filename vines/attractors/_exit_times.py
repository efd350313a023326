"""How long runs with noise stay in a regime, where they go then, and in which regime they are in the long run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._alike import SAME, Motion, apart
from vines.attractors._attractor import Attractor
from vines.attractors._classified import Classified
from vines.attractors._classify import classify_many
from vines.attractors._coexisting import coexisting
from vines.attractors._exit_watch import (
    CAPPED,
    GOES_ON,
    LEFT_IT,
    M_COUNT,
    M_DONE,
    M_STATUS,
    MARKS,
    places_block,
    watch_block,
)
from vines.attractors._holding import Holding, mean_interval, stationary_law
from vines.attractors._regime import Regime, begun, named_states
from vines.attractors._settle import settle as settle_run
from vines.attractors._settle import settle_from
from vines.attractors._shares import share_error
from vines.bounds import check_periods
from vines.domains import Named, Number, Of, Parameters, Whole, stated
from vines.dynamics import Scatter
from vines.dynamics.kernels import room_of
from vines.dynamics.runs import EVENTS_PER_PERIOD, each_thread, threads_allowed
from vines.errors import ParameterError
from vines.model import Params
from vines.orbits import all_orbits

__all__ = ["EXIT", "Exits", "exits"]

Floats = npt.NDArray[np.float64]

EXIT = np.dtype(
    [("regime", "i8"), ("seed", "i8"), ("T_exit", "f8"), ("to", "i8"), ("censored", "?"), ("excursions", "i8")]
)
"""A run: the regime that it began in, the number of its stream, the forcing periods until it left it or the watch
ended, the regime that it went to (-1: none, or not known), and how often it came back after the pattern had differed."""

EACH = 1 << 24
"""Streams of a regime; those of its runs come first."""

SYSTEMS = ("vi_nes", "impact_pair")
"""Systems that can have scatter."""

SKELETON = ("r_speed", "second")
"""What would change the attractors themselves."""

CHUNK = 64
"""Forcing periods after which runs are looked at where patterns alone do not tell two regimes apart."""


@dataclass(frozen=True)
class Exits:
    """How long regimes hold under noise, and where they are left to.

    Attributes
    ----------
    params : Params, or those of another system
        Parameters.
    scatter : Scatter
        The noise.
    periods, confirm : int
        Forcing periods that a run was watched at most, and over which its pattern had to differ.
    attractors : list of Attractor
        The regimes, as they are without noise; no two are alike or mirror images.
    starts : int
        Random starts; `found` tells how many of them came to each regime.
    found : list of int
    runs : structured ndarray, dtype EXIT
        The runs, in the order of their regimes and streams.
    holdings : list of Holding
        Of each regime.
    """

    params: Any
    scatter: Scatter
    periods: int
    confirm: int
    attractors: list[Attractor] = field(repr=False)
    starts: int
    found: list[int]
    runs: npt.NDArray[np.void] = field(repr=False)
    holdings: list[Holding]

    @cached_property
    def law(self) -> tuple[Floats, Floats, Floats]:
        """Share of the time in each regime in the long run, and the ends of its interval; see `stationary_law`."""
        return stationary_law(self.holdings, self.scatter.seed)

    def basin(self, k: int) -> tuple[float, float]:
        """Return the share of the random starts that came to regime k without noise, and its standard error."""
        if not self.starts:
            return math.nan, math.nan
        share = self.found[k] / self.starts
        return share, share_error(share, self.starts)

    def __str__(self) -> str:
        share, low, high = self.law
        lines = [f"exits at {self.params}"]
        for k, (attractor, each) in enumerate(zip(self.attractors, self.holdings, strict=True)):
            name = attractor.name or attractor.regime
            basin, error = self.basin(k)
            to = ", ".join(f"{n} to {self._name(j)}" for j, n in sorted(each.to.items())) or "none seen"
            lines.append(
                f"  {k} {name}: mean {each.mean:.4g} periods ({each.low:.4g} to {each.high:.4g}), exits {to} of "
                f"{each.runs} runs; {share[k]:.3f} ({low[k]:.3f} to {high[k]:.3f}) of the time, "
                f"{basin:.3f} ± {error:.3f} of the starts"
            )
        return "\n".join(lines)

    def _name(self, k: int) -> str:
        return "elsewhere" if k < 0 else f"{k} {self.attractors[k].name or self.attractors[k].regime}"


@stated(
    p=Parameters(),
    scatter=Of("Scatter"),
    start=Named(Number(), optional=True),
    runs=Whole(most=EACH // 2),
    periods=Whole(),
    confirm=Whole(most=4096),
    random=Whole(least=0, most=1_000_000),
    seed=Whole(least=0),
    settle=Number(least=0),
    record=Number(least=2),
    watch=Number(least=16),
    threads=Whole(optional=True),
)
def exits(
    p: Any,
    scatter: Scatter,
    *,
    start: Mapping[str, float] | None = None,
    words: Sequence[str] = (),
    runs: int = 64,
    periods: int = 2000,
    confirm: int = 8,
    random: int = 64,
    seed: int = 0,
    settle: float = 400,
    record: float = 64,
    watch: float = 512,
    threads: int | None = None,
) -> Exits:
    """Find how long regimes hold under noise.

    The regimes are the attractors that the start and random starts come to without noise, and those that runs with noise
    go to. From each of them `runs` runs begin. A run has left its regime when its pattern of impacts, period by period,
    has differed for `confirm` periods and it would, if the noise ended there, settle to another regime: the time is
    that of the first of these periods. A run that would come back goes on.

    Parameters
    ----------
    p : Params, or the parameters of the impact pair
        Parameters. The pair can have a scatter of its restitution.
    scatter : Scatter
        The noise; without r_speed and second, which would change the regimes themselves. With a spread each run is a unit
        of its own, and regimes are told apart by their type alone.
    start : mapping, optional
        The first start by the names of the system, and phase.
    words : sequence of str
        Words whose stable orbits are regimes, too: they may attract few starts.
    runs : int
        Runs that begin in each regime.
    periods : int
        Forcing periods after which a run is censored.
    confirm : int
        Periods in a row over which the pattern has to differ. Of an irregular regime a period differs that shows the
        pattern of another regime, the same one each time.
    random, seed : int
        Random starts, and their seed.
    settle, record, watch : float
        As for `settle`, of the attractors and of the runs that may have left.
    threads : int, optional
        Cores to use; all of this process's if left out. Results do not depend on it.

    Returns
    -------
    Exits

    Raises
    ------
    ParameterError
        If the system or the scatter is not one that this can do.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.dynamics import Scatter
    >>> found = exits(Params(mu=0.01, A=0.015), Scatter(noise=0.01, seed=1), runs=4, periods=100, random=8)
    >>> [a.name for a in found.attractors], found.runs["censored"].all()
    (['1:1'], True)
    """
    check_exits(p, scatter)
    check_periods("(settle + record) (1 + random)", (settle + record) * (1 + random))
    check_periods("runs periods", float(runs) * periods)
    how: dict[str, Any] = {"settle": settle, "record": record, "watch": watch}
    begin = dict(start or {})
    own = settle_run(p, phi=begin.pop("phase", 0.0), **begin, **how)
    listed = coexisting([own], random=random, seed=seed, **how)[0]
    work = _Work(p, scatter, how, periods, confirm, threads)
    for attractor, count in listed:
        work.add(attractor, count)
    for attractor in _on_orbits(p, words, how):
        work.known_as(Motion.of(attractor), lambda attractor=attractor: attractor)
    work.all_regimes(runs)
    return Exits(
        p,
        scatter,
        periods,
        confirm,
        [each.attractor for each in work.regimes],
        random,
        work.found,
        np.concatenate([work.runs[k] for k in range(len(work.regimes))]),
        [work.holding(k) for k in range(len(work.regimes))],
    )


def check_exits(p: Any, scatter: Scatter) -> None:
    """Refuse a system, or a scatter, of which exits cannot be found."""
    if p.system.name not in SYSTEMS:
        raise ParameterError(f"exits cannot do the system {p.system.name!r}; it can do {', '.join(SYSTEMS)}")
    if wrong := [name for name in scatter.parts if name in SKELETON]:
        raise ParameterError(
            f"scatter has {', '.join(wrong)}, which changes the regimes themselves; exits takes the noise alone"
        )
    values = scatter.units(p.system, p.as_array()[None])
    room_of(p).scattered(values, scatter, np.zeros(1, dtype=np.int64))


def _on_orbits(p: Any, words: Sequence[str], how: Mapping[str, Any]) -> Iterator[Attractor]:
    """Yield what runs are that begin on the stable orbits of some words."""
    room = room_of(p)
    for word in words:
        for orbit in all_orbits(word, p):
            if orbit.stable and orbit.admissible:
                phase = float(orbit.phase[0])
                at = room.leave(p, orbit.states[0].tolist(), phase)
                yield settle_from(p, at | {"phase": phase}, **{**how, "settle": 0})


class _Work:
    """The regimes that are known, and the runs that began in each."""

    def __init__(
        self, p: Any, scatter: Scatter, how: dict[str, Any], periods: int, confirm: int, threads: int | None
    ) -> None:
        self.p, self.scatter, self.how = p, scatter, how
        self.periods, self.confirm = periods, confirm
        self.cores = threads_allowed() if threads is None else max(1, threads)
        self.regimes: list[Regime] = []
        self.motions: list[Motion] = []
        self.found: list[int] = []
        self.runs: dict[int, npt.NDArray[np.void]] = {}

    def add(self, attractor: Attractor, count: int = 0) -> int:
        """Add a regime and return its number."""
        self.regimes.append(Regime.of(attractor))
        self.motions.append(Motion.of(attractor))
        self.found.append(count)
        return len(self.regimes) - 1

    def all_regimes(self, runs: int) -> None:
        """Run from every regime, those found on the way included; irregular ones last, when all patterns are known."""
        while open_ones := [k for k in range(len(self.regimes)) if k not in self.runs]:
            k = min(open_ones, key=lambda k: (self.regimes[k].irregular, k))
            self.runs[k] = self.watch(k, k * EACH + np.arange(runs))

    def watch(self, k: int, streams: npt.NDArray[np.int64]) -> npt.NDArray[np.void]:
        """Return the runs that begin in a regime."""
        n, regime = len(streams), self.regimes[k]
        values = self.scatter.units(self.p.system, np.tile(self.p.as_array(), (n, 1)), int(streams[0]))
        out = np.zeros(n, dtype=EXIT)
        out["regime"], out["seed"], out["to"], out["censored"] = k, streams, -1, True
        states, marks = begun(self.p, np.tile(regime.start, (n, 1))), np.zeros((n, MARKS), dtype=np.int64)
        going = np.arange(n)
        until = 0
        while len(going):
            until = min(until + CHUNK, self.periods) if self.ambiguous(k) else self.periods
            self.run_on(k, values, streams, states, marks, going, until)
            left = going[marks[going, M_STATUS] == LEFT_IT]
            looked = going[marks[going, M_STATUS] == GOES_ON] if self.ambiguous(k) else left[:0]
            for some, since in ((left, self.confirm), (looked, CHUNK // 2)):
                to = self.where(values[some], streams[some], states[some], marks[some, M_DONE])
                gone = to != k
                out["to"][some[gone]], out["censored"][some[gone]] = to[gone], False
                out["T_exit"][some[gone]] = np.maximum(marks[some[gone], M_DONE] - since, 0)
                marks[some[gone], M_STATUS] = LEFT_IT
                back = some[~gone]
                out["excursions"][back] += since == self.confirm
                marks[back, M_STATUS], marks[back, M_COUNT] = GOES_ON, 0
            on = out["censored"] & (marks[:, M_STATUS] == GOES_ON) & (marks[:, M_DONE] < self.periods)
            going = np.flatnonzero(on)
        out["T_exit"][out["censored"]] = marks[out["censored"], M_DONE]
        return out

    def ambiguous(self, k: int) -> bool:
        """Say whether another regime has patterns of this one, so that an exit may not show in them."""
        own = self.regimes[k]
        others = [each.codes for j, each in enumerate(self.regimes) if j != k]
        return not own.irregular and any(np.intersect1d(own.codes, each).size for each in others)

    def run_on(
        self,
        k: int,
        values: Floats,
        streams: npt.NDArray[np.int64],
        states: Floats,
        marks: npt.NDArray[np.int64],
        runs: npt.NDArray[np.int64],
        until: int,
    ) -> None:
        """Run on, in blocks on all cores, until patterns have differed or the time is over."""
        known = np.concatenate([each.codes for each in self.regimes])
        groups = np.concatenate([np.full(len(each.codes), j) for j, each in enumerate(self.regimes)])
        size = max(1, -(-len(runs) // (4 * self.cores)))

        def work(block: slice) -> None:
            some = runs[block]
            own, mark = states[some], marks[some]
            table, _room = room_of(self.p).scattered(values[some], self.scatter, streams[some])
            watch_block(
                table,
                own,
                until,
                EVENTS_PER_PERIOD,
                known,
                groups,
                k,
                self.regimes[k].irregular,
                self.confirm,
                NOWHERE,
                NO_WEIGHTS,
                0.0,
                math.inf,
                mark,
            )
            states[some], marks[some] = own, mark

        each_thread(work, [slice(j, j + size) for j in range(0, len(runs), size)], self.cores)

    def where(
        self, values: Floats, streams: npt.NDArray[np.int64], states: Floats, done: npt.NDArray[np.int64]
    ) -> npt.NDArray[np.int64]:
        """Return the regimes to which runs would settle if the noise ended now; a new one gets a number."""
        if not len(states):
            return np.empty(0, dtype=np.int64)
        out = np.empty((len(states), 6))
        table, _room = room_of(self.p).scattered(values, self.scatter, streams)
        places_block(table, states.copy(), done.astype(np.float64), EVENTS_PER_PERIOD, out)
        many = classified(self.p, values, named_states(self.p, out), self.how)
        ratio, size = many.measures["kinetic_ratio"].tolist(), many.measures["max_abs_x1"].tolist()
        regimes, found = many.regime.tolist(), []
        for j, word in enumerate(many.words):
            counts = (word.n, word.m, word.p) if word else (None, None, None)
            found.append(self.known_as(Motion(regimes[j], *counts, ratio[j], size[j]), partial(many.attractor, j)))
        return np.array(found)

    def known_as(self, motion: Motion, attractor: Callable[[], Attractor]) -> int:
        """Return the number of the regime that a motion is; a new one gets the next."""
        near = math.inf if self.scatter.spread else SAME
        for k, known in enumerate(self.motions):
            distance = apart(known, motion)
            if distance < near or distance == 0.0:
                return k
        return self.add(attractor())

    def holding(self, k: int) -> Holding:
        """Return how long a regime holds, from its runs."""
        rows = self.runs[k]
        left = rows["to"][~rows["censored"]]
        watched = float(rows["T_exit"].sum())
        interval = mean_interval(len(left), watched) if watched > 0 else (0.0, 0.0, 0.0)
        to = {int(j): int(n) for j, n in zip(*np.unique(left, return_counts=True), strict=True)}
        return Holding(k, "runs", len(rows), len(left), watched, *interval, to)


NOWHERE, NO_WEIGHTS = np.empty((0, 4)), np.zeros((4, 4))


def classified(p: Any, values: Floats, starts: Mapping[str, Floats], how: Mapping[str, Any]) -> Classified:
    """Return what runs without noise settle to, each with its own parameters."""
    names = [each.name for each in p.system.parameters]
    if isinstance(p, Params):
        return classify_many(dict(zip(names, values.T, strict=True)), starts, **how)
    points: Sequence[Any] = [type(p).of(dict(zip(names, row, strict=True))) for row in values.tolist()]
    return classify_many(points, starts, **how, apart=0.0)
