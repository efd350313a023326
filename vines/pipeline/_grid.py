"""The points of a stage: their ids, their parameters, and the chains of a carried axis."""

from __future__ import annotations

import hashlib
import itertools
from dataclasses import dataclass
from functools import cached_property

from vines.pipeline._declaration import Stage
from vines.pipeline._jobs import Point

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
        texts = self._texts()
        if self.stage.carry is None:
            return [_id(text) for text in texts]
        ids = [""] * len(texts)
        for chain in self.chains:
            before = self.origin
            for i in chain:
                before = _id(f'{{"after":"{before}","values":{texts[i]}}}')
                ids[i] = before
        return ids

    def _texts(self) -> list[str]:
        """Return the canonical JSON of the varied values of each point; made for millions of them."""
        order = sorted(range(len(self.stage.axes)), key=lambda k: self.stage.axes[k].name)
        form = "{{" + ",".join(f'"{self.stage.axes[k].name}":{{{k}!r}}' for k in order) + "}}"
        return [form.format(*values) for values in self.values]

    def point(self, i: int) -> Point:
        """Return a point with all its parameters, in the order of the kind."""
        every = {**self._blank, **dict(zip(self._names, self.values[i], strict=True))}
        return Point(self.ids[i], every)

    @cached_property
    def _names(self) -> list[str]:
        return [axis.name for axis in self.stage.axes]

    @cached_property
    def _blank(self) -> dict[str, float]:
        """The fixed parameters in the order of the kind, with room for the varied ones."""
        return {name: self.stage.params.get(name, 0.0) for name in self.stage.kind.parameters}

    def at(self, values: dict[str, float]) -> str:
        """Return the id of the point with these varied values."""
        return self.ids[self.values.index(tuple(values[axis.name] for axis in self.stage.axes))]


def _id(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]
