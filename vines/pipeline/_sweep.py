"""Stages of the points shape: compute the points that the pool does not have, round by round if they are refined."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.pipeline._demand import Demand, demand
from vines.pipeline._engine import Engine
from vines.pipeline._events import Event, Report
from vines.pipeline._grid import Grid
from vines.pipeline._jobs import Points
from vines.pipeline._links import with_links
from vines.pipeline._plan import Prepared
from vines.pipeline._work import Chunk, Work
from vines.pipeline._worker import Done, Task
from vines.store import Ids, Store

if TYPE_CHECKING:
    from vines.pipeline._refined import Refined
    from vines.pipeline._shard import Shard
    from vines.store import Pool

__all__ = ["Sweep"]


@dataclass
class Sweep:
    """One stage while its points are computed.

    Parameters
    ----------
    prepared : Prepared
        The stage.
    store : Store
        Where its pool is.
    engine : Engine
        Computes chunks.
    report : callable
        Told of each chunk that is stored.
    force, retry_failed : bool
        Compute all points again, or those that failed.
    shard : Shard or None
        Compute this share only.

    Attributes
    ----------
    grid : Grid or Refined
        All points that are wanted as far as that is known.
    new : int
        How many points were computed.
    left : int
        How many points of the grid are not there in the end; only other shards leave any.
    remark : str
        Why the refinement ended before its tolerance; empty if it did not.
    """

    prepared: Prepared
    store: Store
    engine: Engine
    report: Report
    force: bool = False
    retry_failed: bool = False
    shard: Shard | None = None
    new: int = 0
    left: int = 0
    remark: str = ""
    _done: int = 0
    _failed: int = 0
    _numbers: Any = field(default=None)

    def __post_init__(self) -> None:
        self.grid: Grid | Refined = self.prepared.grid
        self.pool: Pool = self.store.pool(self.prepared.pool_key)
        self._numbers = iter(range(self.pool.next_number(), 10**8))
        self._provenance = self.prepared.ingredients.provenance(self.prepared.pool_key)

    def compute(self) -> int:
        """Compute what is missing, with a refinement until no round adds a point; return how many points failed."""
        rule = self.prepared.stage.refine
        self.pool.describe(self.prepared.ingredients.form)
        self.pool.parts()
        if self.pool.damaged:
            self.store.discard_damaged(self.pool)
        settled: Ids | None = None
        while True:
            self._round(settled)
            if self.left or rule is None:
                return self._failed
            from vines.pipeline._refined import refine

            settled = self.grid.ids
            grid, self.remark = refine(self.grid, self.pool)
            if grid is self.grid:
                return self._failed
            self.grid = grid

    def look(self) -> None:
        """Find out what is missing, as :meth:`compute` does, but compute nothing."""
        from vines.pipeline._refined import refine

        while True:
            located = self.pool.locate(self.grid.ids)
            self.left = int((located.part < 0).sum())
            if self.left or self.prepared.stage.refine is None:
                return
            grid, self.remark = refine(self.grid, self.pool)
            if grid is self.grid:
                return
            self.grid = grid

    def has_start(self) -> bool:
        """Whether the point of another stage that its chains start from is there, if there is such a point."""
        if not self.prepared.origin:
            return True
        key, _, identity = self.prepared.origin.partition("/")
        found = self.store.pool(key).locate(Ids.of([point_id(identity)]))
        return bool(found.part[0] >= 0)

    def _round(self, settled: Ids | None) -> None:
        """Compute the points of the grid that are missing, those of earlier rounds apart."""
        ids = self.grid.ids
        located = self.pool.locate(ids)
        open_ends = located.part < 0
        if self.retry_failed:
            open_ends |= located.failed
        if self.force:
            open_ends[:] = True
        if settled is not None:
            open_ends &= settled.locate(ids) < 0
        mine = self._mine()
        self._failed = int((located.failed & ~open_ends).sum())
        self._done = len(ids) - int(open_ends.sum())
        work = self._work(open_ends & mine, open_ends, located.failed)
        self.new += work.left
        self.engine.compute(work, self._task, self._stored)
        self.left = int((open_ends & ~mine).sum())
        if self.left:  # another shard may have computed some of it meanwhile
            self.left = int((self.pool.locate(ids).part < 0).sum())

    def _mine(self) -> np.ndarray:
        total = len(self.grid)
        if self.shard is None:
            return np.ones(total, dtype=bool)
        if self.prepared.stage.carry is None:
            return self.shard.mine(total)
        mine = np.zeros(total, dtype=bool)
        chains = self.grid.chains
        for chain, own in zip(chains, self.shard.mine(len(chains)), strict=True):
            mine[chain.places] = own
        return mine

    @cached_property
    def _demand(self) -> Demand:
        """What is demanded of whoever computes; the same for all tasks."""
        return demand(self.prepared.ingredients, self.store, self.engine.token)

    def _task(self, chunk: Chunk) -> Task:
        stage = self.prepared.stage
        grid = self.grid
        return Task(
            number=next(self._numbers),
            body=stage.kind.body,
            tables=stage.kind.tables,
            options=stage.options,
            provenance=self._provenance,
            points=Points(
                grid.fixed(), with_links(stage, grid.columns(chunk.places)), grid.ids.take(np.asarray(chunk.places))
            ),
            carry=stage.carry.axis if stage.carry is not None else None,
            start=chunk.start,
            broken="a point before it in the carried chain failed" if chunk.broken else "",
            data=self.store.data,
            pool=self.pool.folder,
            demand=self._demand,
        )

    def _stored(self, done: Done, processes: int) -> None:
        self._done += done.points
        self._failed += len(done.failed)
        self.report(
            Event(
                "progress",
                self.prepared.stage.name,
                len(self.grid),
                self._done,
                self._failed,
                processes,
                done.why,
                done.logs,
            )
        )

    def _work(self, wanted: np.ndarray, absent: np.ndarray, failed: np.ndarray) -> Work:
        if self.prepared.stage.carry is None:
            everything = wanted.all()
            return Work(free=range(len(wanted)) if everything else np.flatnonzero(wanted).astype(np.int32))  # type: ignore
        work = Work()
        for chain in self.grid.chains:
            self._add_chain(work, chain.places, chain.start, wanted, failed & ~absent)
        return work

    def _add_chain(self, work: Work, places: Any, first: str, wanted: np.ndarray, failed: np.ndarray) -> None:
        """Add the stretches of a chain that are wanted, each with the row that it starts from."""
        primary = self.prepared.stage.kind.tables[0]
        before, stretch, start = -1, [], -1
        for place in [*places, -1]:
            if place >= 0 and wanted[place]:
                start = start if stretch else before
                stretch.append(place)
            elif stretch:
                if start >= 0:
                    row = partial(self.pool.row, primary, self.grid.ids.take([start]).text())
                    work.add_chain(stretch, row, broken=bool(failed[start]))
                elif first:
                    broken = bool(self.pool.locate(Ids.of([first])).failed[0])
                    work.add_chain(stretch, partial(self.pool.row, primary, first), broken=broken)
                else:
                    work.add_chain(stretch, self._origin_row, broken=False)
                stretch = []
            before = place

    def _origin_row(self) -> dict[str, Any] | None:
        """Return the row of the point of another stage that starts the chains."""
        if not self.prepared.origin:
            return None
        key, _, identity = self.prepared.origin.partition("/")
        return self.store.pool(key).row(self.prepared.stage.kind.tables[0], point_id(identity))


def point_id(identity: str) -> str:
    """Return the id of a point that is named by its id or by its values, see :meth:`Grid.identity`."""
    if not identity.startswith("{"):
        return identity
    import json

    from vines.pipeline._identity import free_ids

    values = json.loads(identity)
    return free_ids([np.array([values[name]]) for name in sorted(values)] or [np.zeros(1)]).text()
