"""What is left to compute of a stage, cut into chunks by the clock, for carried points along their chains."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Chunk", "Pace", "Work"]

TARGET_SECONDS = 2.0
"""How long a chunk should take: an interruption costs no more, and storing a part costs some hundredths of it."""
MOST_POINTS = 2**15
"""More points than that are not computed in one call, however quick they are: their rows have to fit into memory."""
_GROWTH = 8


@dataclass(frozen=True, slots=True)
class Chunk:
    """Places of points in the grid, computed in one call.

    `chain` is the chain that they belong to, -1 for free points; `start` the predecessor's row; `broken` whether the
    predecessor failed.
    """

    places: Sequence[int]
    chain: int = -1
    start: dict[str, Any] | None = None
    broken: bool = False


@dataclass
class _Chain:
    """What is left of a chain. `start` is the row before the first of it, found when it is needed."""

    places: deque[int]
    start: Callable[[], dict[str, Any] | None]
    broken: bool = False


@dataclass
class Work:
    """The points that are still to be computed.

    Attributes
    ----------
    free : sequence of int
        Places of points that depend on no other, a range or an array.
    chains : dict of int to _Chain
        Carried chains that no chunk is being computed of.
    """

    free: Sequence[int] = ()
    chains: dict[int, _Chain] = field(default_factory=dict)
    _taken: int = 0
    _returned: list[Sequence[int]] = field(default_factory=list)
    _away: dict[int, _Chain] = field(default_factory=dict)

    def add_chain(self, places: list[int], start: Callable[[], dict[str, Any] | None], *, broken: bool) -> None:
        """Add consecutive points of a chain.

        Parameters
        ----------
        places : list of int
            Places in the grid, in the order of the chain.
        start : callable
            Returns the row of the predecessor, ``None`` if there is none.
        broken : bool
            Whether the predecessor failed.
        """
        self.chains[len(self.chains)] = _Chain(deque(places), start, broken)

    @property
    def left(self) -> int:
        """How many points nobody has taken yet."""
        chains = [*self.chains.values(), *self._away.values()]
        return self._free + sum(len(chain.places) for chain in chains)

    @property
    def _free(self) -> int:
        return len(self.free) - self._taken + sum(map(len, self._returned))

    @property
    def width(self) -> int:
        """How many chunks could be computed at the same time."""
        return self._free + len(self.chains) + len(self._away)

    def take(self, size: int) -> Chunk | None:
        """Return the next chunk of at most so many points; ``None`` if nothing can be taken now."""
        if self._returned:
            places = self._returned.pop()
            if len(places) > size:
                self._returned.append(places[size:])
            return Chunk(places[:size])
        if self._taken < len(self.free):
            start, self._taken = self._taken, min(self._taken + size, len(self.free))
            return Chunk(self.free[start : self._taken])
        if not self.chains:
            return None
        number, chain = next(iter(self.chains.items()))
        del self.chains[number]
        self._away[number] = chain
        start_row = None if chain.broken else chain.start()
        taken = tuple(chain.places.popleft() for _ in range(min(size, len(chain.places))))
        return Chunk(taken, number, start_row, chain.broken)

    def give_back(self, chunk: Chunk) -> None:
        """Take back a chunk that was lost with its process."""
        if chunk.chain < 0:
            self._returned.append(chunk.places)
            return
        chain = self._away.pop(chunk.chain)
        chain.places.extendleft(reversed(chunk.places))
        self.chains[chunk.chain] = _Chain(chain.places, lambda: chunk.start, chunk.broken)

    def finish(self, chunk: Chunk, last: dict[str, Any] | None) -> None:
        """Say that a chunk is stored; its chain goes on from its last row, or is broken if that failed."""
        if chunk.chain < 0:
            return
        chain = self._away.pop(chunk.chain)
        if chain.places:
            self.chains[chunk.chain] = _Chain(chain.places, lambda: last, last is None)


@dataclass
class Pace:
    """How large the next chunk should be, from how long those before it took."""

    size: int = 1
    seconds_a_point: float = 0.0
    chunks: int = 0

    def add(self, points: int, seconds: float) -> None:
        """Take note of a chunk. The first one also loads and compiles, so the second replaces what it said."""
        rate = seconds / points
        self.seconds_a_point = rate if self.chunks < 2 else 0.5 * (self.seconds_a_point + rate)
        self.chunks += 1
        right = TARGET_SECONDS / max(self.seconds_a_point, 1e-9)
        self.size = max(1, min(int(right), _GROWTH * max(self.size, points), MOST_POINTS))

    def seconds_for(self, points: int) -> float:
        """Return how long so many points would take one process; 0 while that is not known."""
        return points * self.seconds_a_point if self.chunks > 1 else 0.0
