"""How long runs with noise stay in a regime, where they go then, and in which regime they are in the long run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._alike import Motion
from vines.attractors._attractor import Attractor
from vines.attractors._coexisting import coexisting
from vines.attractors._exit_splitting import split
from vines.attractors._exit_work import EACH, Work
from vines.attractors._holding import Holding, stationary_law
from vines.attractors._settle import settle as settle_run
from vines.attractors._settle import settle_from
from vines.attractors._shares import share_error
from vines.bounds import check_periods, check_splitting, shown
from vines.domains import Name, Named, Number, Of, Parameters, Whole, stated
from vines.dynamics import Scatter
from vines.dynamics.kernels import room_of
from vines.errors import ParameterError, StateError, nearest
from vines.model import word_for
from vines.orbits import all_orbits

__all__ = ["Exits", "exits"]

Floats = npt.NDArray[np.float64]

SYSTEMS = ("vi_nes", "impact_pair")
"""Systems that can have scatter."""

SKELETON = ("r_speed", "second")
"""What would change the attractors themselves."""

FEW = 10
"""Exits from which on the rate of plain runs is taken, whatever a splitting says."""


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
    wait : int
        Forcing periods that a run had to hold before it counted.
    holdings : list of Holding
        Of each regime, by its runs.
    split : list of Holding
        Of periodic regimes, by splitting, where it was asked for and could be done; with a remark and without a mean
        where its repetitions disagree.
    """

    params: Any
    scatter: Scatter
    periods: int
    confirm: int
    attractors: list[Attractor] = field(repr=False)
    starts: int
    found: list[int]
    runs: npt.NDArray[np.void] = field(repr=False)
    wait: int
    holdings: list[Holding]
    split: list[Holding]

    @cached_property
    def law(self) -> tuple[Floats, Floats, Floats]:
        """Share of the time in each regime in the long run, and the ends of its interval; see `stationary_law`.

        Where runs saw fewer than `FEW` exits from a regime, and a splitting tells a mean, its rate is taken.
        """
        rare = {each.regime: each for each in self.split if not each.remark}
        used = [rare.get(each.regime, each) if each.exits < FEW else each for each in self.holdings]
        return stationary_law(used, self.scatter.seed)

    def basin(self, k: int) -> tuple[float, float]:
        """Return the share of the random starts that came to regime k without noise, and its standard error."""
        if not self.starts:
            return math.nan, math.nan
        share = self.found[k] / self.starts
        return share, share_error(share, self.starts)

    def __str__(self) -> str:
        share, low, high = self.law
        lines = [f"exits at {self.params}"]
        for each in (*self.holdings, *self.split):
            k = each.regime
            basin, error = self.basin(k)
            to = ", ".join(f"{n} to {self._name(j)}" for j, n in sorted(each.to.items())) or "none seen"
            mean = f"mean {each.mean:.4g} periods ({each.low:.4g} to {each.high:.4g})"
            if each.remark:
                mean = f"no mean ({each.remark})"
            lines.append(
                f"  {self._name(k)} by {each.runs} {'runs' if each.method == 'runs' else 'splittings'}: "
                f"{mean}, exits {to}; {share[k]:.3f} "
                f"({low[k]:.3f} to {high[k]:.3f}) of the time, {basin:.3f} ± {error:.3f} of the starts"
            )
        return "\n".join(lines)

    def _name(self, k: int) -> str:
        return f"{k} {self.attractors[k].name or self.attractors[k].regime}"


@stated(
    p=Parameters(),
    scatter=Of("Scatter"),
    start=Named(Number(), optional=True),
    runs=Whole(most=EACH // 2),
    periods=Whole(most=10**12),
    confirm=Whole(most=4096),
    wait=Whole(least=0, most=10**9),
    splitting=Whole(least=0, most=100_000),
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
    wait: int = 0,
    splitting: int = 0,
    random: int = 64,
    seed: int = 0,
    settle: float = 400,
    record: float = 64,
    watch: float = 512,
    threads: int | None = None,
) -> Exits:
    """Find how long regimes hold under noise.

    The regimes are the attractors that the start and random starts come to without noise, and those that runs with
    noise go to. From each of them `runs` runs begin. A run has left its regime when its pattern of impacts, period by
    period, has differed for `confirm` periods and it would, if the noise ended there, settle to another regime: the
    time is that of the first of these periods. A run that would come back goes on.

    Parameters
    ----------
    p : Params, or the parameters of the impact pair
        Parameters. The pair can have a scatter of its restitution.
    scatter : Scatter
        The noise; without r_speed and second, which would change the regimes themselves. With a spread each run is a
        unit of its own, and regimes are told apart by their type alone.
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
    wait : int
        Forcing periods that a run has to hold before it counts: near a bifurcation the noise takes as long as a small
        disturbance to fill the neighbourhood of an orbit, and until then exits are not as likely as later.
    splitting : int
        Runs of each level of a splitting, at least 16, for exits from periodic regimes that plain runs are too few for;
        0 for none.
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
    >>> [a.name for a in found.attractors], found.holdings[0].exits
    (['1:1'], 0)
    """
    check_exits(p, scatter, splitting)
    if not wait < periods:
        raise StateError(f"wait is {wait}, allowed is wait < periods, which is {periods}")
    check_periods("(settle + record) (1 + random)", (settle + record) * (1 + random))
    check_periods("runs periods", float(runs) * periods)
    how: dict[str, Any] = {"settle": settle, "record": record, "watch": watch}
    begin = dict(start or {})
    known = [each.name for each in p.system.start]
    for name in begin:
        if name not in known:
            raise StateError(f"unknown coordinate {name!r} of start: {nearest(name, known)}")
    if isinstance(words, str | bytes) or not isinstance(words, Sequence):
        raise ParameterError(f"words is {shown(words)}; give a list of words, such as ['LR']")
    for word in words:
        Name().check("a word of words", word, ParameterError)
        word_for(word, p.system)
    own = settle_run(p, phi=begin.pop("phase", 0.0), **begin, **how)
    listed = coexisting([own], random=random, seed=seed, **how)[0]
    work = Work(p, scatter, how, periods, confirm, wait, threads)
    for attractor, count in listed:
        if attractor.settled:
            work.add(attractor, count)
    for attractor in _on_orbits(p, words, how):
        work.known_as(Motion.of(attractor), lambda attractor=attractor: attractor)
    if not work.regimes:
        raise StateError(f"no start settled within {settle + record:g} periods and its patience: {own.reason}")
    rare: dict[int, Holding | None] = {}
    while len(rare) < len(work.regimes):
        work.all_regimes(runs)
        for k in range(len(rare), len(work.regimes)):
            periodic = work.regimes[k].attractor.regime == "periodic"
            rare[k] = split(work, k, splitting) if splitting and periodic else None
    return Exits(
        p,
        scatter,
        periods,
        confirm,
        [each.attractor for each in work.regimes],
        random,
        work.found,
        np.concatenate([work.runs[k] for k in range(len(work.regimes))]),
        wait,
        [work.holding(k) for k in range(len(work.regimes))],
        [each for each in rare.values() if each is not None],
    )


def check_exits(p: Any, scatter: Scatter, splitting: int = 0) -> None:
    """Refuse a system, or a scatter, of which exits cannot be found."""
    if p.system.name not in SYSTEMS:
        raise ParameterError(f"exits cannot do the system {p.system.name!r}; it can do {', '.join(SYSTEMS)}")
    if wrong := [name for name in scatter.parts if name in SKELETON]:
        raise ParameterError(
            f"scatter has {', '.join(wrong)}, which changes the regimes themselves; exits takes the noise alone"
        )
    check_splitting(splitting, scatter.parts, scatter.hold)
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
