"""How starts at one parameter point are brought to their attractors, and those known so far."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._attractor import Attractor
from vines.attractors._averages import WINDOW, Group, averages, match, observe, sort_into, steady
from vines.attractors._carried import carried, names_of, sort_alike
from vines.attractors._classified import Classified
from vines.attractors._classify import classify_many
from vines.attractors._sections import NEAR, ON, Section, sections_of
from vines.attractors._settle import settle_from

__all__ = ["Lifetime", "Search"]

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]


ROUND = 32
"""Forcing periods between two looks at the states."""

CHUNK = 65_536
"""Most starts that are classified in one call: what is known of each is 700 bytes."""

SAMPLE = 64
"""Starts that are followed to their attractor, however long it takes, to learn which there are."""

LONG = 20_000
"""Forcing periods that the sample may take."""

WATCHED = 256
"""Runs that never repeat that are watched for the whole patience; averages are taken over its second half."""

STAYING = 4096
"""Runs that never repeat of which it is watched whether they stay."""

SHOWN = 512
"""Forcing periods recorded of the run that stands for an attractor that never repeats."""

BESIDE = 1e-9
"""Change of the ball's velocity that gives a chaotic run a future of its own."""

LOOK = 16
"""Windows of averages of a second look, where one window did not agree with any attractor."""


@dataclass(frozen=True)
class Lifetime:
    """Mean forcing periods until a run leaves an attractor, and their standard error; nan where none was seen to."""

    periods: float
    error: float


class Search:
    """The attractors found so far at a parameter point, and how starts are brought to them.

    Parameters
    ----------
    p : Params, or the parameters of another system
    phase : float
        Forcing phase at which states are compared.
    settle, patience, watch : float
        As for `basins`.
    """

    def __init__(self, p: Any, phase: float, settle: float, patience: float, watch: float) -> None:
        self.p, self.phase, self.watch = p, phase, watch
        self.patience = math.ceil(patience / ROUND) * ROUND
        self.settle = min(math.ceil(settle / ROUND) * ROUND, self.patience)
        self.windows = max(self.patience // WINDOW, LOOK)
        self.attractors: list[Attractor] = []
        self.sections: list[Section] = []
        self.groups: list[Group] = []
        self.members: dict[int, list[Floats]] = {}
        """States of runs on each attractor that never repeats."""

    def run(self, states: Floats) -> tuple[Numbers, npt.NDArray[np.bool_], Floats]:
        """Bring states, shape (n, d), to their attractors.

        Returns
        -------
        label, mirrored, periods : ndarray, shape (n,)
            Number of the attractor, -1 where it is not clear; whether its mirror image was reached; forcing periods
            after which that was so.
        """
        runs = _Runs(states.copy())
        still = np.arange(len(states))
        still = self._capture(runs, still, min(4 * ROUND, self.settle))
        self._learn(runs, still)
        goal = self.settle
        while len(still):
            still = self._capture(runs, still, goal)
            still = self._decide(runs, still)
            if goal >= self.patience:
                break
            self._learn(runs, still)
            goal = min(2 * goal, self.patience)
        return runs.label, runs.mirrored, runs.periods

    def _capture(self, runs: _Runs, still: Numbers, goal: float) -> Numbers:
        """Let runs go on until `goal`; return those that come to no known orbit on the way."""
        fell = np.full((len(still), len(self.sections)), np.inf)
        last = fell.copy()
        while len(still) and runs.elapsed < goal:
            runs.go_on(self.p, self.phase, still)
            away = self._distances(runs.states[still], coming=True)
            # Nearer all the time, and at last half as far: only inside the basin is that so.
            fell = np.where((away < NEAR) & (away <= last), fell, away)
            last = away
            near = (away < NEAR) & ((away <= 0.5 * fell) | (away < ON))
            caught = near.any(axis=1)
            if caught.any():
                best = np.argmin(np.where(near, away, np.inf)[caught], axis=1)
                self._label(runs, still[caught], best)
                still, fell, last = still[~caught], fell[~caught], last[~caught]
        return still

    def _distances(self, states: Floats, *, coming: bool = False) -> Floats:
        if not self.sections:
            return np.empty((len(states), 0))
        ordered = sort_alike(self.p, states)
        return np.stack([s.distance(ordered, coming=coming) for s in self.sections], axis=1)

    def _label(self, runs: _Runs, which: Numbers, sections: Numbers) -> None:
        owners = np.array([s.owner for s in self.sections], dtype=np.int64)
        mirrored = np.array([s.mirrored for s in self.sections])
        runs.reach(which, owners[sections], mirrored[sections])

    def _classify(self, states: Floats, patience: float) -> Classified:
        starts = dict(zip(names_of(self.p), states.T, strict=True)) | {"phase": self.phase}
        options = {"settle": 0, "record": WINDOW, "patience": patience, "watch": self.watch}
        return classify_many(self.p, starts, **options, errors=False, apart=0.0)

    def _learn(self, runs: _Runs, still: Numbers) -> None:
        """Follow a sample of the open runs to the end, to know the attractors before all others are asked."""
        sample = still[np.linspace(0, len(still) - 1, min(SAMPLE, len(still))).astype(np.int64)]
        if len(sample):
            found = self._classify(runs.states[sample], LONG)
            self._on_orbits(found)

    def _on_orbits(self, found: Classified) -> tuple[Numbers, Numbers]:
        """Return which runs are on a periodic orbit, or rest, and the section of each; new orbits become known."""
        regular = np.flatnonzero(found.settled & ((found.p > 0) | (found.regime == "no_impact")))
        section = np.full(len(regular), -1)
        final = found.final[regular, :-1]
        resting = found.regime[regular] == "no_impact"
        if resting.any():
            section[resting] = self._rest(found, int(regular[resting][0]))
        while True:
            left = np.flatnonzero((section < 0) & ~resting)
            if not len(left):
                break
            away = self._distances(final[left])
            if away.shape[1]:
                near = away.min(axis=1) < ON
                section[left[near]] = away[near].argmin(axis=1)
                left = left[~near]
            if not len(left):
                break
            known = len(self.sections)
            attractor = found.attractor(int(regular[left[0]]))
            self.sections += sections_of(self.p, attractor, len(self.attractors))
            self.attractors.append(attractor)
            # The run itself is on the orbit that was learnt from it, whatever rounding says.
            section[left[0]] = known
        return regular, section

    def _rest(self, found: Classified, run: int) -> int:
        """Return the section of the motion without impact; it has no points, for the ball rests anywhere."""
        for k, section in enumerate(self.sections):
            if self.attractors[section.owner].regime == "no_impact":
                return k
        self.attractors.append(found.attractor(run))
        d = len(names_of(self.p))
        nothing = np.empty((0, d)), np.empty((0, d, d), complex)
        self.sections.append(Section(len(self.attractors) - 1, False, *nothing, 1.0))
        return len(self.sections) - 1

    def _decide(self, runs: _Runs, still: Numbers) -> Numbers:
        """Classify runs where they are; return those that have not settled."""
        if not len(still):
            return still
        open_ones, strange, values = [], [], []
        for k in range(0, len(still), CHUNK):
            part = still[k : k + CHUNK]
            found = self._classify(runs.states[part], 0.0)
            runs.states[part] = found.final[:, :-1]
            runs.periods[part] = runs.elapsed + WINDOW
            on, section = self._on_orbits(found)
            self._label(runs, part[on], section)
            wild = np.flatnonzero(found.settled & np.isin(found.regime, ("chaotic", "quasiperiodic")))
            if len(wild) and not self.groups:
                self._watch(runs.states[_spread(part[wild], WATCHED)])
            values.append(averages(found.measures[wild]))
            strange.append(part[wild])
            open_ones.append(part[~found.settled])
        runs.elapsed += WINDOW
        left = self._by_averages(runs, np.concatenate(strange), np.concatenate(values))
        return np.sort(np.concatenate([*open_ones, *left]))

    def _by_averages(self, runs: _Runs, which: Numbers, values: Floats) -> list[Numbers]:
        """Label runs by their averages over a window, or longer where that does not do; return those left over."""
        passing, which = self._assign(runs, which, values, 1)
        left = [passing]
        if len(which):
            seen, runs.states[which] = observe(self.p, runs.states[which], self.phase, LOOK)
            # Where one window did not do, what came before may not have died out: only the second half counts.
            values = seen[:, LOOK // 2 :].mean(axis=1)
            again = which
            passing, which = self._assign(runs, which, values, LOOK // 2)
            left.append(passing)
            if len(which):
                self._watch(runs.states[_spread(which, WATCHED)])
                passing, which = self._assign(runs, which, values[np.isin(again, which)], LOOK // 2)
                left.append(passing)
        return [*left, which]

    def _assign(self, runs: _Runs, which: Numbers, values: Floats, length: int) -> tuple[Numbers, Numbers]:
        """Label runs by their averages; return those on a transient, and those that agree with nothing known."""
        if not self.groups:
            return which[:0], which
        group, sign = match(values, length, self.groups)
        owner = np.where(group >= 0, np.array([g.owner for g in self.groups])[group], -1)
        stays = owner >= 0
        runs.reach(which[stays], owner[stays], sign[stays] < 0)
        for k in np.unique(owner[stays]).tolist():
            self._keep(k, runs.states[which[owner == k]])
        return which[(group >= 0) & ~stays], which[group < 0]

    def _watch(self, states: Floats) -> None:
        """Take long averages from runs that never repeat, and learn which attractors they are on."""
        values, end = observe(self.p, states, self.phase, self.windows)
        found = self._classify(end, 0.0)
        self._on_orbits(found)
        values = values[:, self.windows // 2 :]
        wild = found.settled & np.isin(found.regime, ("chaotic", "quasiperiodic"))
        stay = np.flatnonzero(wild & ~self._captured(end) & steady(values))
        known = len(self.groups)
        sort_into(self.groups, found.regime[stay].tolist(), end[stay], values[stay], mirrored=self.p.mirrored)
        for k in range(known, len(self.groups)):
            if self._lasts(k):
                self.groups[k].owner = len(self.attractors)
                self.attractors.append(self._shown(self.groups[k]))

    def _lasts(self, k: int) -> bool:
        """Say whether more than half of the runs on a group, or beside it, are still on it a patience later."""
        group = self.groups[k]
        count = min(max(SAMPLE, len(group.states)), WATCHED)
        states = np.array(group.states)[np.arange(count) % len(group.states)]
        states[:, -1] += np.linspace(-BESIDE, BESIDE, count)
        values, end = observe(self.p, states, self.phase, self.windows)
        late = max(self.windows // 4, 1)
        which, _ = match(values[:, -late:].mean(axis=1), late, self.groups)
        return bool(np.mean((which == k) & ~self._captured(end)) > 0.5)

    def _captured(self, states: Floats) -> npt.NDArray[np.bool_]:
        return np.asarray((self._distances(states) < NEAR).any(axis=1))

    def _shown(self, group: Group) -> Attractor:
        """Return one run of a group as an attractor."""
        shown = None
        for state in group.states:
            at = dict(zip(names_of(self.p), state.tolist(), strict=True)) | {"phase": self.phase}
            shown = settle_from(self.p, at, settle=0, record=SHOWN, patience=0, watch=self.watch)
            if shown.regime == group.regime:
                break
        assert shown is not None
        return replace(shown, regime=group.regime)

    def _keep(self, owner: int, states: Floats) -> None:
        kept = self.members.setdefault(owner, [])
        room = STAYING - sum(map(len, kept))
        if room > 0:
            kept.append(states[_spread(np.arange(len(states)), room)])

    def lifetimes(self) -> list[Lifetime]:
        """Return for each attractor how long runs stay on it, watched over the patience; nan where none left it.

        Those that leave in the first half may have been on their way already, and are not counted.
        """
        found = [Lifetime(math.nan, math.nan)] * len(self.attractors)
        for owner, kept in self.members.items():
            runs = _Runs(np.concatenate(kept))
            still = self._capture(runs, np.arange(len(runs.states)), self.patience / 2)
            before, time = len(still), 0.0
            begun = runs.elapsed
            rest = self._capture(runs, still, self.patience)
            left = before - len(rest)
            if left:
                gone = runs.periods[np.setdiff1d(still, rest)] - begun
                time = float(gone.sum()) + len(rest) * (runs.elapsed - begun)
                found[owner] = Lifetime(time / left, time / left / math.sqrt(left))
        return found


class _Runs:
    """Where runs are, and what became of them."""

    def __init__(self, states: Floats) -> None:
        n = len(states)
        self.states = states
        self.label = np.full(n, -1)
        self.mirrored = np.zeros(n, dtype=bool)
        self.periods = np.zeros(n)
        self.elapsed = 0.0

    def go_on(self, p: Any, phase: float, which: Numbers) -> None:
        """Let some of them go on for a round; after whole periods the phase is the same."""
        self.states[which], _ = carried(p, self.states[which], phase, ROUND)
        self.elapsed += ROUND
        self.periods[which] = self.elapsed

    def reach(self, which: Numbers, owner: Numbers, mirrored: npt.NDArray[np.bool_]) -> None:
        """Note to which attractor runs came, and whether to its mirror image."""
        self.label[which], self.mirrored[which] = owner, mirrored


def _spread(which: Numbers, most: int) -> Numbers:
    """Return at most so many of them, evenly spread."""
    if len(which) <= most:
        return which
    return which[np.linspace(0, len(which) - 1, most).astype(np.int64)]
