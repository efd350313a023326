"""The regimes that are known at a point, and the runs with noise that began in each."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._alike import SAME, Motion, apart
from vines.attractors._attractor import Attractor
from vines.attractors._classified import Classified
from vines.attractors._classify import classify_many
from vines.attractors._exit_watch import GOES_ON, LEFT_IT, M_COUNT, M_DONE, M_STATUS, MARKS, places_block, watch_block
from vines.attractors._holding import Holding, mean_interval
from vines.attractors._regime import Regime, begun, named_states
from vines.dynamics import Scatter
from vines.dynamics.kernels import room_of
from vines.dynamics.runs import EVENTS_PER_PERIOD, each_thread, threads_allowed
from vines.model import Params

__all__ = ["EACH", "EXIT", "UNDECIDED", "Work"]

Floats = npt.NDArray[np.float64]

EXIT = np.dtype(
    [("regime", "i8"), ("seed", "i8"), ("T_exit", "f8"), ("to", "i8"), ("censored", "?"), ("excursions", "i8")]
)
"""A run: the regime that it began in, the number of its stream, the forcing periods until it left it or the watch
ended, the regime that it went to (-1 if censored), and how often it came back after the pattern had differed."""

EACH = 1 << 24
"""Streams of a regime; those of its runs come first."""

NOWHERE, NO_WEIGHTS = np.empty((0, 4)), np.zeros((4, 4))

UNDECIDED = -2
"""Instead of a regime: a run that would take too long to settle, and is left to go on."""

CHUNK = 64
"""Forcing periods after which runs are looked at where patterns alone do not tell two regimes apart."""


class Work:
    """The regimes that are known, and the runs that began in each."""

    def __init__(
        self,
        p: Any,
        scatter: Scatter,
        how: dict[str, Any],
        periods: int,
        confirm: int,
        wait: int,
        threads: int | None,
    ) -> None:
        self.p, self.scatter, self.how = p, scatter, how
        self.periods, self.confirm, self.wait = periods, confirm, wait
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

    def first_of_splitting(self, k: int) -> int:
        """Return the first stream of a splitting of a regime."""
        return k * EACH + EACH // 2

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
                gone = (to != k) & (to != UNDECIDED)
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
        *,
        begun: Floats | None = None,
        centres: Floats = NOWHERE,
        weights: Floats = NO_WEIGHTS,
        lower: float = 0.0,
        upper: float = math.inf,
        peaks: Floats | None = None,
    ) -> None:
        """Run on, in blocks on all cores, until patterns have differed, a distance is passed, or the time is over."""
        known = np.concatenate([each.codes for each in self.regimes])
        groups = np.concatenate([np.full(len(each.codes), j) for j, each in enumerate(self.regimes)])
        size = max(1, -(-len(runs) // (4 * self.cores)))

        def work(block: slice) -> None:
            some = runs[block]
            own, mark = states[some], marks[some]
            far = np.zeros(len(some)) if peaks is None else peaks[some]
            table, _room = self.scattered(values[some], streams[some], None if begun is None else begun[some])
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
                centres,
                weights,
                lower,
                upper,
                far,
                mark,
            )
            states[some], marks[some] = own, mark
            if peaks is not None:
                peaks[some] = far

        each_thread(work, [slice(j, j + size) for j in range(0, len(runs), size)], self.cores)

    def scattered(self, values: Floats, streams: npt.NDArray[np.int64], begun: Floats | None) -> tuple[Any, Floats]:
        """Return the table of runs, and room to be kept."""
        return room_of(self.p).scattered(values, self.scatter, streams, begun)

    def places(
        self,
        values: Floats,
        streams: npt.NDArray[np.int64],
        states: Floats,
        done: npt.NDArray[np.int64],
        begun: Floats | None = None,
    ) -> Floats:
        """Return where runs are after so many forcing periods, shape (n, 6): with phase and coloured force."""
        out = np.empty((len(states), 6))
        table, _room = self.scattered(values, streams, begun)
        places_block(table, states.copy(), done.astype(np.float64), EVENTS_PER_PERIOD, out)
        return out

    def where(
        self,
        values: Floats,
        streams: npt.NDArray[np.int64],
        states: Floats,
        done: npt.NDArray[np.int64],
        begun: Floats | None = None,
    ) -> npt.NDArray[np.int64]:
        """Return the regimes to which runs would settle if the noise ended now; a new one gets a number.

        UNDECIDED where a run has not settled within its patience.
        """
        if not len(states):
            return np.empty(0, dtype=np.int64)
        out = self.places(values, streams, states, done, begun)
        many = classified(self.p, values, named_states(self.p, out), self.how)
        ratio, size = many.measures["kinetic_ratio"].tolist(), many.measures["max_abs_x1"].tolist()
        regimes, settled, found = many.regime.tolist(), many.settled.tolist(), []
        for j, word in enumerate(many.words):
            if not settled[j]:
                found.append(UNDECIDED)
                continue
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
        """Return how long a regime holds, from its runs: all of them where none held for as long as they have to."""
        rows = self.runs[k]
        wait = self.wait if (rows["T_exit"] >= self.wait).any() else 0
        counted = rows["T_exit"] >= wait
        left = rows["to"][counted & ~rows["censored"]]
        # Times are those of whole periods, so that all may be 0.
        watched = max(float((rows["T_exit"][counted] - wait).sum()), 1.0)
        interval = mean_interval(len(left), watched)
        to = {int(j): int(n) for j, n in zip(*np.unique(left, return_counts=True), strict=True)}
        return Holding(k, "runs", len(rows), len(left), watched, *interval, to, int((~counted).sum()))


def classified(p: Any, values: Floats, starts: Mapping[str, Floats], how: Mapping[str, Any]) -> Classified:
    """Return what runs without noise settle to, each with its own parameters."""
    names = [each.name for each in p.system.parameters]
    if isinstance(p, Params):
        return classify_many(dict(zip(names, values.T, strict=True)), starts, **how)
    points: Sequence[Any] = [type(p).of(dict(zip(names, row, strict=True))) for row in values.tolist()]
    return classify_many(points, starts, **how, apart=0.0)
