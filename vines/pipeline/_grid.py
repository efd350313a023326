"""The points of a stage: their values, ids, and chains, all computed when asked; ten bytes a point are kept."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from vines.pipeline._axes import Axis
from vines.pipeline._chains import carried_id
from vines.pipeline._declaration import Stage

if TYPE_CHECKING:
    import numpy as np

    from vines.store import Ids

__all__ = ["Chain", "Grid"]

_BLOCK = 2**16


@dataclass(frozen=True, slots=True)
class Chain:
    """Points each of which starts where the one before it ended.

    Attributes
    ----------
    places : sequence of int
        Places in the grid, in the order of the chain.
    start : str
        Id of the point of the same pool that the first one starts from; empty if it starts the chain.
    """

    places: Sequence[int]
    start: str = ""


@dataclass(frozen=True)
class Grid:
    """All points that a stage declares, in their final order: the first axis varies slowest, each ascending.

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
    def groups(self) -> list[tuple[Axis, ...]]:
        """The axes; those that are zipped run together."""
        axes = {axis.name: axis for axis in self.stage.axes}
        partners = {name: names for names in self.stage.zipped for name in names}
        named = dict.fromkeys(partners.get(name, (name,)) for name in axes)
        return [tuple(axes[name] for name in names) for names in named]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The varied parameters, the slowest first."""
        return tuple(axis.name for group in self.groups for axis in group)

    def __len__(self) -> int:
        total = 1
        for group in self.groups:
            total *= group[0].count
        return total

    def columns(self, places: Sequence[int] | np.ndarray) -> dict[str, np.ndarray]:
        """Return the varied values of the points at some places."""
        import numpy as np

        left = np.asarray(places, dtype=np.int64)
        found: dict[str, np.ndarray] = {}
        for group in reversed(self.groups):
            left, at = np.divmod(left, group[0].count)
            found.update({axis.name: axis.at(at) for axis in group})
        return {name: found[name] for name in self.names}

    @cached_property
    def chains(self) -> list[Chain]:
        """The chains; empty if nothing is carried."""
        carry = self.stage.carry
        if carry is None:
            return []
        number = next(i for i, group in enumerate(self.groups) if carry.axis in [axis.name for axis in group])
        count = self.groups[number][0].count
        stride = 1
        for group in self.groups[number + 1 :]:
            stride *= group[0].count
        along = range(0, count * stride, stride)
        ends = next(axis.ends for axis in self.groups[number] if axis.name == carry.axis)
        rising = ends[0] <= ends[-1]
        order = along if rising == (carry.direction == "up") else along[::-1]
        return [
            Chain(range(order.start + first, order.stop + first, order.step))
            for block in range(0, len(self), count * stride)
            for first in range(block, block + stride)
        ]

    @cached_property
    def ids(self) -> Ids:
        """The id of each point: a hash of its varied values and, if carried, of its predecessor's id."""
        import numpy as np

        from vines.pipeline._identity import free_ids
        from vines.store import Ids

        if self.stage.carry is not None:
            found = [""] * len(self)
            for chain in self.chains:
                for place, identity in zip(chain.places, self._along(chain.places), strict=True):
                    found[place] = identity
            return Ids.of(found)
        if not self.names:
            return free_ids([np.zeros(1)])
        raw = np.empty((len(self), 10), dtype=np.uint8)
        for start in range(0, len(self), _BLOCK):
            columns = self.columns(np.arange(start, min(start + _BLOCK, len(self))))
            raw[start : start + _BLOCK] = free_ids([columns[name] for name in sorted(columns)]).raw
        return Ids(raw)

    def identity(self, values: Mapping[str, float]) -> str:
        """Return what names the point with these varied values: its id if it is carried, else the values.

        Both are found without numpy, which a status should not have to load.
        """
        from vines.store import canonical

        if self.stage.carry is None:
            return canonical(dict(values))
        place = self.place(values)
        chain = next(chain.places for chain in self.chains if place in chain.places)
        return self._along(chain[: chain.index(place) + 1])[-1]

    def place(self, values: Mapping[str, float]) -> int:
        """Return the place of the point with these varied values."""
        place = 0
        for group in self.groups:
            rows = list(zip(*(axis.values() for axis in group), strict=True))
            place = place * group[0].count + rows.index(tuple(values[axis.name] for axis in group))
        return place

    def has(self, values: Mapping[str, float]) -> bool:
        """Whether there is a point with these varied values."""
        if set(values) != set(self.names):
            return False
        try:
            self.place(values)
        except ValueError:
            return False
        return True

    def nearest(self, values: Mapping[str, float]) -> list[dict[str, float]]:
        """Return the points beside such varied values: of each axis the values below and above, or the end."""
        rows: list[list[dict[str, float]]] = []
        for group in self.groups:
            names = [axis.name for axis in group]
            every = sorted(zip(*(axis.values() for axis in group), strict=True))
            place = bisect.bisect_left(every, tuple(values[name] for name in names))
            rows.append([dict(zip(names, row, strict=True)) for row in every[max(0, place - 1) : place + 1]])
        return [dict(itertools.chain(*(row.items() for row in each))) for each in itertools.product(*rows)]

    def fixed(self) -> dict[str, float]:
        """Return all parameters in the order of the kind; those that vary are 0 here."""
        return {name: self.stage.params.get(name, 0.0) for name in self.stage.kind.parameters}

    def _along(self, places: Sequence[int]) -> list[str]:
        """Return the ids of the first points of a chain."""
        names = sorted(self.names)
        before, found = self.origin, []
        for values in self._rows(places, names):
            before = carried_id(before, names, values)
            found.append(before)
        return found

    def _rows(self, places: Sequence[int], names: Sequence[str]) -> list[tuple[float, ...]]:
        """Return the varied values point by point."""
        values = {axis.name: axis.values() for axis in self.stage.axes}
        found: dict[str, list[float]] = {}
        left = list(places)
        for group in reversed(self.groups):
            count = group[0].count
            at = [place % count for place in left]
            left = [place // count for place in left]
            found.update({axis.name: [values[axis.name][i] for i in at] for axis in group})
        return list(zip(*(found[name] for name in names), strict=True))
