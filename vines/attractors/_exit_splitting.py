"""Exits that plain runs are too few for: runs are split at levels of their distance from the orbit.

The rate of an exit is the rate at which runs come to the first level, times the chances to come from each level to the
next before they are back near the orbit (forward flux sampling: Allen, Frenkel & ten Wolde 2006).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.attractors._exit_watch import FELL, GOES_ON, LEFT_IT, M_COUNT, M_DONE, M_STATUS, MARKS, ROSE
from vines.attractors._exit_work import UNDECIDED, Work
from vines.attractors._holding import LEVEL, Holding
from vines.attractors._regime import begun, centres_of

__all__ = ["split"]

Floats = npt.NDArray[np.float64]

REPEATS = 8
"""Independent repetitions, from whose scatter the interval is taken."""

NEAR, FIRST, NEXT = 0.5, 0.9, 0.7
"""Shares of runs that are nearer: to the orbit than what counts as back, than the first level, than the next level."""

MOST_LEVELS, TRIMS = 60, 4

MOST_SPREAD, FEWEST = 1.5, 4
"""Standard deviation of the logarithms of the repetitions' rates up to which their mean is told, and the fewest runs
that have to come to each level.

A rate is a product over the levels, so its law is about log-normal. Above this spread the mean lies where eight
repetitions seldom are, and two sets of them differ by powers of ten."""

MEMORIES = 4.0
"""Relaxation times after which the noise has filled the neighbourhood of the orbit, from which distances are taken."""


def split(work: Work, k: int, walkers: int) -> Holding | None:
    """Return how long a periodic regime holds from its orbit on, by splitting; None where most runs leave it at once.

    Where the repetitions disagree, or few runs came to a level, it has a remark instead of a mean.

    Parameters
    ----------
    work : Work
        The regimes and the noise.
    k : int
        The regime.
    walkers : int
        Runs of each level.
    """
    from scipy.stats import t as student

    size = work.regimes[k].attractor.max_multiplier
    p = work.regimes[k].attractor.p or 1
    memory = p / -math.log(size) if 0.0 < size < 1.0 else 1.0
    stages = _Stages(work, k, walkers, max(16, math.ceil(MEMORIES * memory)))
    if not stages.prepared():
        return None
    levels = stages.levels()
    rates, fewest, to = [], walkers, Counter[int]()
    for _ in range(REPEATS if levels else 0):
        rate, least, left = stages.rate(levels)
        rates.append(rate)
        fewest = min(fewest, least)
        to.update(left)
    watched, exits = float(stages.watched), sum(to.values())
    if why := doubt(rates, fewest, walkers):
        none = math.nan
        return Holding(k, "splitting", len(rates), exits, watched, none, none, none, dict(to), 0, none, why)
    mean = float(np.mean(rates))
    error = float(np.std(rates, ddof=1)) / math.sqrt(REPEATS) / mean
    wide = math.exp(float(student.ppf(0.5 * (1 + LEVEL), REPEATS - 1)) * error)
    return Holding(k, "splitting", REPEATS, exits, watched, 1 / mean, 1 / mean / wide, wide / mean, dict(to), 0, error)


def doubt(rates: Sequence[float], fewest: int, walkers: int) -> str:
    """Return why no mean is told of repetitions with these rates, of which so few runs came to a level; else nothing.

    Examples
    --------
    >>> doubt([1e-7, 2e-7, 3e-7], 9, 64)
    ''
    >>> doubt([1e-14, 1e-16, 1e-19], 9, 64)
    'the repetitions lie between 1e+14 and 1e+19 periods'
    >>> doubt([1e-9, 0.0, 0.0], 0, 64)
    '2 of 3 repetitions came to no exit'
    """
    if not rates:
        return "no levels were found that lead to an exit"
    lost = sum(rate == 0.0 for rate in rates)
    if lost:
        return f"{lost} of {len(rates)} repetitions came to no exit"
    if float(np.std(np.log(rates), ddof=1)) > MOST_SPREAD:
        return f"the repetitions lie between {1 / max(rates):.0e} and {1 / min(rates):.0e} periods"
    return f"only {fewest} of {walkers} runs came to one of the levels" if fewest < FEWEST else ""


@dataclass
class _Entries:
    """Runs that have come to a level: where they are, and which of them had left the regime before (-1: none)."""

    places: Floats
    gone: npt.NDArray[np.int64]

    @classmethod
    def joined(cls, parts: Sequence[_Entries]) -> _Entries:
        return cls(np.concatenate([each.places for each in parts]), np.concatenate([each.gone for each in parts]))

    def __len__(self) -> int:
        return len(self.gone)


class _Stages:
    """Runs of a regime in the distances from its orbit that noise makes of it."""

    def __init__(self, work: Work, k: int, walkers: int, burn: int) -> None:
        self.work, self.k, self.walkers, self.burn = work, k, walkers, burn
        self.centres = centres_of(work.regimes[k])
        self.weights = np.zeros((4, 4))
        self.drawn = work.first_of_splitting(k)
        self.rng = np.random.default_rng([work.scatter.seed, k])
        self.near = self.first = 0.0
        self.watched = 0

    def streams(self, count: int) -> npt.NDArray[np.int64]:
        """Return streams that nobody had."""
        self.drawn += count
        return np.arange(self.drawn - count, self.drawn)

    def prepared(self) -> bool:
        """Find what the noise makes of the orbit: the unit of distances, what is near, and the first level."""
        run = _Runs(self, np.tile(self.work.regimes[self.k].start, (self.walkers, 1)), None)
        run.on(self.burn, 0.0, math.inf)
        inside = (run.marks[:, M_STATUS] == GOES_ON) & (run.marks[:, M_COUNT] == 0)
        if inside.sum() < max(16, self.walkers // 2):
            return False
        away = run.places()[inside, :4]
        square = ((away[:, None] - self.centres) ** 2).sum(axis=2)
        away -= self.centres[np.argmin(square, axis=1)]
        distance = np.zeros(len(away))
        for _ in range(TRIMS):
            # Those farthest away may be on their way out, and would make the unit too long.
            close = away[distance <= np.quantile(distance, FIRST)]
            values, vectors = np.linalg.eigh(close.T @ close / len(close))
            kept = values > 1e-12 * values[-1]
            self.weights = np.where(kept, 1.0 / np.sqrt(np.where(kept, values, 1.0)), 0.0)[:, None] * vectors.T
            distance = np.sqrt(((away @ self.weights.T) ** 2).sum(axis=1))
        self.near, self.first = np.quantile(distance, [NEAR, FIRST]).tolist()
        return True

    def levels(self) -> list[float]:
        """Return the levels, chosen so that three runs in ten come from each to the next, or to an exit; or none."""
        levels = [self.first]
        entries, _ = self.flux(levels[0])
        while len(entries) and len(levels) < MOST_LEVELS:
            peaks, _ = self.trial(entries, math.inf)
            level = float(np.sort(peaks)[int(NEXT * len(peaks))])
            if not math.isfinite(level):
                return levels
            level = max(level, 1.02 * levels[-1])
            _, entries = self.trial(entries, level)
            levels.append(level)
        return levels if len(entries) else []

    def rate(self, levels: Sequence[float]) -> tuple[float, int, Counter[int]]:
        """Return the rate of exits a forcing period, the fewest runs at a level, and the regimes that runs left to."""
        entries, rate = self.flux(levels[0])
        fewest = len(entries)
        for level in (*levels[1:], math.inf):
            if not len(entries):
                return 0.0, 0, Counter()
            _, entries = self.trial(entries, level)
            fewest = min(fewest, len(entries))
            rate *= len(entries) / self.walkers
        return rate, fewest, Counter(entries.gone.tolist())

    def flux(self, level: float) -> tuple[_Entries, float]:
        """Return the runs that come to the first level from near the orbit, and how many do so a forcing period."""
        run = _Runs(self, np.tile(self.work.regimes[self.k].start, (self.walkers, 1)), None)
        # As long as plain runs: what is far from the orbit for long comes to no level, but belongs to the time.
        found = self._cross(run, np.ones(self.walkers, dtype=bool), self.work.periods, level)
        counted = float(run.marks[:, M_DONE].sum())
        entries = _Entries.joined(found) if found else _Entries(np.empty((0, 6)), np.empty(0, dtype=np.int64))
        return entries, len(entries) / counted if counted else 0.0

    def _cross(self, run: _Runs, up: npt.NDArray[np.bool_], until: int, level: float) -> list[_Entries]:
        """Run on, and return those that come to a level; `up` says which were near the orbit since, and is changed."""
        found = []
        while (going := (run.marks[:, M_STATUS] == GOES_ON) & (run.marks[:, M_DONE] < until)).any():
            run.on(until, 0.0, level, going & up)
            run.on(until, self.near, math.inf, going & ~up)
            rose, fell = (run.marks[:, M_STATUS] == status for status in (ROSE, FELL))
            if rose.any():
                found.append(_Entries(run.places(rose), np.full(int(rose.sum()), -1)))
            up[rose], up[fell] = False, True
            run.marks[rose | fell, M_STATUS] = GOES_ON
            before = run.gone >= 0
            run.leave()
            # An exit counts as coming to every level, wherever it is by the distance.
            new = (run.gone >= 0) & ~before & up
            if new.any():
                found.append(_Entries(run.places(new), run.gone[new]))
        return found

    def trial(self, entries: _Entries, level: float) -> tuple[Floats, _Entries]:
        """Let runs go on from a level, with noise of their own, until they are near the orbit, or at the next level.

        Returns the largest distance of each, infinite where it left the regime, and those that came to the level.
        """
        chosen = self.rng.integers(len(entries), size=self.walkers)
        places, gone = entries.places[chosen], entries.gone[chosen].copy()
        run = _Runs(self, places, places[:, 5])
        run.marks[gone >= 0, M_STATUS] = LEFT_IT
        run.gone = gone
        run.peaks[gone >= 0] = math.inf
        while (going := (run.marks[:, M_STATUS] == GOES_ON) & (run.marks[:, M_DONE] < self.work.periods)).any():
            run.on(self.work.periods, self.near, level, going)
            run.leave()
        came = (run.marks[:, M_STATUS] == ROSE) | (run.gone >= 0)
        there = np.where(run.gone[came, None] >= 0, places[came], run.places(came))
        return run.peaks, _Entries(there, run.gone[came])


class _Runs:
    """Some runs of one stage."""

    def __init__(self, stages: _Stages, places: Floats, colours: Floats | None) -> None:
        n = len(places)
        self.stages, self.work = stages, stages.work
        self.values = np.tile(self.work.p.as_array(), (n, 1))
        self.streams = stages.streams(n)
        self.colours = colours
        self.states = begun(self.work.p, places)
        self.marks = np.zeros((n, MARKS), dtype=np.int64)
        self.peaks = np.zeros(n)
        self.gone = np.full(n, -1)

    def on(self, until: int, lower: float, upper: float, which: npt.NDArray[np.bool_] | None = None) -> None:
        """Run on until a distance is passed, the pattern has differed, or the time is over."""
        some = np.flatnonzero(which) if which is not None else np.arange(len(self.marks))
        before = self.marks[some, M_DONE].sum()
        s = self.stages
        bounded = lower > 0.0 or math.isfinite(upper)
        self.work.run_on(
            s.k, self.values, self.streams, self.states, self.marks, some, until, begun=self.colours,
            centres=s.centres if bounded else s.centres[:0], weights=s.weights, lower=lower, upper=upper,
            peaks=self.peaks,
        )  # fmt: skip
        s.watched += int(self.marks[some, M_DONE].sum() - before)

    def leave(self) -> None:
        """See which of those whose pattern has differed have left; the others go on."""
        some = np.flatnonzero((self.marks[:, M_STATUS] == LEFT_IT) & (self.gone < 0))
        to = self.work.where(
            self.values[some], self.streams[some], self.states[some], self.marks[some, M_DONE], self._begun(some)
        )
        back = (to == self.stages.k) | (to == UNDECIDED)
        self.gone[some[~back]] = to[~back]
        self.peaks[some[~back]] = math.inf
        self.marks[some[back], M_STATUS], self.marks[some[back], M_COUNT] = GOES_ON, 0

    def places(self, which: npt.NDArray[np.bool_] | None = None) -> Floats:
        """Return where runs are, shape (n, 6)."""
        some = np.flatnonzero(which) if which is not None else np.arange(len(self.marks))
        return self.work.places(
            self.values[some], self.streams[some], self.states[some], self.marks[some, M_DONE], self._begun(some)
        )

    def _begun(self, some: npt.NDArray[np.int64]) -> Floats | None:
        return None if self.colours is None else self.colours[some]
