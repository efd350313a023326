"""The points of a stage: their ids, their parameters, and the chains of a carried axis."""

from __future__ import annotations

import hashlib
import itertools
from dataclasses import dataclass
from functools import cached_property

from vines.pipeline._declaration import Stage
from vines.pipeline._jobs import Point
from vines.store import canonical

__all__ = ["Grid"]

_DIGITS = 20


@dataclass(frozen=True)
class Grid:
    """All points that a stage wants, in their final order: the first axis varies slowest, each ascending.

    Parameters
    ----------
    stage : Stage
        A stage of the points shape.
    origin : str
        Identity of the point of another stage that starts each chain; empty if there is none.
    """

    stage: Stage
    origin: str = ""

    @cached_property
    def values(self) -> list[tuple[float, ...]]:
        """The varied values of each point."""
        return list(itertools.product(*(axis.values() for axis in self.stage.axes)))

    @cached_property
    def chains(self) -> list[list[int]]:
        """Places of the points of each chain, in the order of the chain; empty if nothing is carried."""
        carry = self.stage.carry
        if carry is None:
            return []
        place = [axis.name for axis in self.stage.axes].index(carry.axis)
        chains: dict[tuple[float, ...], list[int]] = {}
        for i, values in enumerate(self.values):
            chains.setdefault(values[:place] + values[place + 1 :], []).append(i)
        step = 1 if carry.direction == "up" else -1
        return [chain[::step] for chain in chains.values()]

    @cached_property
    def ids(self) -> list[str]:
        """The id of each point: a hash of its varied values and, if carried, of its predecessor's id."""
        names = [axis.name for axis in self.stage.axes]
        if self.stage.carry is None:
            return [_id(dict(zip(names, values, strict=True))) for values in self.values]
        ids = [""] * len(self.values)
        for chain in self.chains:
            before = self.origin
            for i in chain:
                before = _id({"after": before, "values": dict(zip(names, self.values[i], strict=True))})
                ids[i] = before
        return ids

    def point(self, i: int) -> Point:
        """Return a point with all its parameters, in the order of the kind."""
        varied = dict(zip((axis.name for axis in self.stage.axes), self.values[i], strict=True))
        every = {**self.stage.params, **varied}
        return Point(self.ids[i], {name: every[name] for name in self.stage.kind.parameters})

    def at(self, values: dict[str, float]) -> str:
        """Return the id of the point with these varied values."""
        return self.ids[self.values.index(tuple(values[axis.name] for axis in self.stage.axes))]


def _id(form: object) -> str:
    return hashlib.sha256(canonical(form).encode()).hexdigest()[:_DIGITS]
