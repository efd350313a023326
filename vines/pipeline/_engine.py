"""Computing chunks in this process or in others, through the protocol of ``concurrent.futures.Executor``."""

from __future__ import annotations

import contextlib
import math
import uuid
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from pathlib import Path
from types import TracebackType
from typing import Protocol, TypeVar

from vines.errors import StoreError
from vines.pipeline._work import Chunk, Pace, Work
from vines.pipeline._worker import Done, Task, compute_task
from vines.store import Store

__all__ = ["Crew", "Engine"]

_DEATHS = 3
_LOOK_SECONDS = 1.0

_Item = TypeVar("_Item")
_Made = TypeVar("_Made")


class Crew(Protocol):
    """Who computes chunks outside this process."""

    worth: float
    """Seconds of work from which on it is used; below, this process computes alone."""
    apart: bool
    """Whether others have started its processes, so that each has to prove that it sees the store."""

    def size(self) -> int:
        """Return how many chunks it computes at the same time; starts it where only it can know."""
        ...

    def executor(self) -> Executor:
        """Return its executor, started if it was not."""
        ...

    def is_loss(self, error: BaseException) -> bool:
        """Whether an error means that a worker was lost with its chunk; afterwards the crew can go on.

        Raises
        ------
        VinesError
            If the crew cannot go on.
        """
        ...

    def look(self) -> None:
        """See that it is still there; called every second.

        Raises
        ------
        VinesError
            If it is not.
        """
        ...

    def stop(self, *, now: bool) -> None:
        """End it; `now` leaves chunks unfinished."""
        ...


class Engine:
    """Computes what is left of a stage, alone or with a crew.

    Parameters
    ----------
    crew : Crew
        Who helps.
    store : Store
        Where what is computed goes.

    Attributes
    ----------
    token : tuple of (Path, str) or None
        File in the store, and what stands in it: who reads it sees the store. None where that needs no proof.
    """

    def __init__(self, crew: Crew, store: Store) -> None:
        self.crew = crew
        self.token: tuple[Path, str] | None = None
        self._store = store
        self._open = contextlib.ExitStack()

    def compute(self, work: Work, make: Callable[[Chunk], Task], stored: Callable[[Done, int], None]) -> None:
        """Compute everything that is left.

        Parameters
        ----------
        work : Work
            What is left; empty at the end.
        make : callable
            Makes the task of a chunk.
        stored : callable
            Told of each chunk that is stored, and how many processes are at work.

        Raises
        ------
        StoreError
            If worker processes die again and again.
        EngineError
            If the scheduler is lost.
        """
        pace = Pace()
        if work.left and self.crew.worth <= 0:
            self._together(work, make, stored, pace)
        while (chunk := work.take(pace.size)) is not None:
            done = compute_task(make(chunk))
            work.finish(chunk, done.last)
            pace.add(done.points, done.seconds)
            stored(done, 1)
            if min(self.crew.size(), work.width) > 1 and pace.seconds_for(work.left) >= self.crew.worth:
                self._together(work, make, stored, pace)

    def spread(
        self, function: Callable[[_Item], _Made], items: Sequence[_Item], told: Callable[[int, int, int], None]
    ) -> list[_Made]:
        """Return what a function makes of each item, in their order; processes share the items if there are several.

        Parameters
        ----------
        function : callable
            Can be imported by its name; what it makes of an item depends on that alone.
        items : sequence
            Whole seconds of work each, so that a process is worth its start.
        told : callable
            Told how many items are done, of how many, and how many processes are at work.

        Raises
        ------
        StoreError
            If worker processes die again and again.
        EngineError
            If the scheduler is lost.
        """
        made: dict[int, _Made] = {}
        size = min(self.crew.size(), len(items)) if len(items) > 1 else 1
        if size < 2:
            for place, item in enumerate(items):
                made[place] = function(item)
                told(len(made), len(items), 1)
        deaths = 0
        while len(made) < len(items):
            try:
                executor = self.crew.executor()
                flying = {executor.submit(function, items[k]): k for k in range(len(items)) if k not in made}
                while flying:
                    ready, _ = wait(flying, timeout=_LOOK_SECONDS, return_when=FIRST_COMPLETED)
                    if not ready:
                        self.crew.look()
                    for future in ready:
                        made[flying.pop(future)] = future.result()
                        told(len(made), len(items), size)
            except Exception as error:
                deaths = self._count(error, deaths)
        return [made[place] for place in range(len(items))]

    def aside(self, function: Callable[[_Item], _Made], item: _Item) -> Future[_Made] | None:
        """Let another process apply a function to an item; None if this one is alone.

        Parameters
        ----------
        function : callable
            Can be imported by its name.
        item : object
            Whole seconds of work.
        """
        if self.crew.size() < 2:
            return None
        try:
            return self.crew.executor().submit(function, item)
        except Exception as error:
            self._count(error, 0)
            return None

    def outcome(self, future: Future[_Made]) -> _Made | None:
        """Wait for what another process makes; None if that process died.

        Raises
        ------
        EngineError
            If the crew cannot go on.
        """
        try:
            while not wait([future], timeout=_LOOK_SECONDS).done:
                self.crew.look()
            return future.result()
        except Exception as error:
            self._count(error, 0)
            return None

    def __enter__(self) -> Engine:
        if self.crew.apart:
            path = self._open.enter_context(self._store.staging()) / "token"
            self.token = (path, uuid.uuid4().hex)
            path.write_text(self.token[1], "utf-8")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # after an interruption a chunk may have seconds to go; its part is not there yet, so nothing is lost
        self.crew.stop(now=kind is not None)
        self._open.close()

    def _together(
        self, work: Work, make: Callable[[Chunk], Task], stored: Callable[[Done, int], None], pace: Pace
    ) -> None:
        deaths = 0
        while work.left:
            flying: dict[Future[Done], Chunk] = {}
            try:
                self._drain(flying, work, make, stored, pace)
            except Exception as error:
                for chunk in reversed(list(flying.values())):
                    work.give_back(chunk)
                deaths = self._count(error, deaths)

    def _count(self, error: Exception, deaths: int) -> int:
        """Return how often workers were lost by now; raise the error if it is another, or if it were too often."""
        if not self.crew.is_loss(error):
            raise error
        if deaths + 1 >= _DEATHS:
            text = f"worker processes died {deaths + 1} times, perhaps for want of memory"
            raise StoreError(f"{text}; what was computed is kept; run again with fewer --jobs") from None
        return deaths + 1

    def _drain(
        self,
        flying: dict[Future[Done], Chunk],
        work: Work,
        make: Callable[[Chunk], Task],
        stored: Callable[[Done, int], None],
        pace: Pace,
    ) -> None:
        """Keep everybody busy until nothing is left; `flying` holds the chunks that are under way."""
        executor = self.crew.executor()
        while True:
            size = max(1, min(self.crew.size(), work.width + len(flying)))
            while len(flying) < size + 1:
                # near the end smaller chunks, so that all finish together
                share = math.ceil(work.left / (2 * size)) if len(work.free) else work.left
                chunk = work.take(max(1, min(pace.size, share)))
                if chunk is None:
                    break
                flying[executor.submit(compute_task, make(chunk))] = chunk
            if not flying:
                return
            ready, _ = wait(flying, timeout=_LOOK_SECONDS, return_when=FIRST_COMPLETED)
            if not ready:
                self.crew.look()
            for future in ready:
                done = future.result()
                chunk = flying.pop(future)
                work.finish(chunk, done.last)
                pace.add(done.points, done.seconds)
                stored(done, size)
