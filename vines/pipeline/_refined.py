"""Adaptive refinement: a grid with points added where what was computed changes from one point to the next.

It goes in rounds. A round looks at the points of the grid so far, line by line along one axis, and adds the point
halfway between two neighbours that differ, unless they are already as near as the tolerance. What is added depends on
computed values alone, not on when or where they were computed: a refinement that was interrupted repeats its rounds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.pipeline._chains import carried_id
from vines.pipeline._grid import Chain, Grid
from vines.pipeline._identity import free_ids

if TYPE_CHECKING:
    from vines.pipeline._declaration import Refine
    from vines.store import Ids, Pool

__all__ = ["Refined", "refine"]


@dataclass(frozen=True, slots=True)
class _Added:
    """An added point: its place along each group of axes, its values, its id, and whose end state it starts from."""

    position: tuple[int | Fraction, ...]
    values: tuple[float, ...]
    id: str
    start: str


@dataclass(frozen=True)
class Refined:
    """A grid with added points. A carried point that is added starts from the end state of the neighbour before it.

    Parameters
    ----------
    base : Grid
        The grid as declared.
    added : tuple of _Added
        The points added so far.
    """

    base: Grid
    added: tuple[_Added, ...]

    def __len__(self) -> int:
        return len(self.base) + len(self.added)

    @property
    def stage(self) -> Any:
        """The stage."""
        return self.base.stage

    @property
    def names(self) -> tuple[str, ...]:
        """The varied parameters, the slowest first."""
        return self.base.names

    def fixed(self) -> dict[str, float]:
        """Return all parameters in the order of the kind; those that vary are 0 here."""
        return self.base.fixed()

    @cached_property
    def positions(self) -> list[tuple[int | Fraction, ...]]:
        """Place of each point along each group of axes, in the final order."""
        every = [*_positions(self.base), *(point.position for point in self.added)]
        return [every[i] for i in self._order]

    @cached_property
    def _order(self) -> list[int]:
        every = [*_positions(self.base), *(point.position for point in self.added)]
        return sorted(range(len(every)), key=every.__getitem__)

    @cached_property
    def _columns(self) -> dict[str, np.ndarray]:
        base = self.base.columns(range(len(self.base)))
        more = np.array([point.values for point in self.added]).reshape(-1, len(self.names))
        return {name: np.concatenate([base[name], more[:, k]])[self._order] for k, name in enumerate(self.names)}

    def columns(self, places: Sequence[int] | np.ndarray) -> dict[str, np.ndarray]:
        """Return the varied values of the points at some places."""
        at = np.asarray(places, dtype=np.int64)
        return {name: values[at] for name, values in self._columns.items()}

    @cached_property
    def ids(self) -> Ids:
        """The id of each point."""
        from vines.store import Ids

        return Ids.joined([self.base.ids, Ids.of(point.id for point in self.added)]).take(self._order)

    @cached_property
    def chains(self) -> list[Chain]:
        """The chains of the grid as declared, and each added point by itself."""
        place = np.argsort(self._order).tolist()
        declared = [Chain([place[i] for i in chain.places], chain.start) for chain in self.base.chains]
        count = len(self.base)
        return declared + [Chain([place[count + i]], point.start) for i, point in enumerate(self.added)]


def refine(grid: Grid | Refined, pool: Pool) -> tuple[Grid | Refined, str]:
    """Return the grid with one more round of points, or the grid itself if nothing is left to add.

    Parameters
    ----------
    grid : Grid or Refined
        All its points are in the pool.
    pool : Pool
        The pool of the stage.

    Returns
    -------
    grid : Grid or Refined
        The grid of the next round.
    remark : str
        Why the refinement ends before its tolerance is reached; empty if it does not.
    """
    rule = grid.stage.refine
    if rule is None:
        return grid, ""
    base = grid if isinstance(grid, Grid) else grid.base
    before = () if isinstance(grid, Grid) else grid.added
    axis_at = next(i for i, group in enumerate(base.groups) if group[0].name == rule.along)
    positions = _positions(base) if isinstance(grid, Grid) else grid.positions
    values = _values(grid, pool, rule)
    lines: dict[tuple[Any, ...], list[int]] = {}
    for place, position in enumerate(positions):
        lines.setdefault(position[:axis_at] + position[axis_at + 1 :], []).append(place)
    pairs = [(a, b) for line in lines.values() for a, b in pairwise(line) if _differ(values, a, b, rule)]
    added = _halfway(grid, base, positions, axis_at, pairs, rule)
    if not added:
        return grid, ""
    if len(before) + len(added) > rule.most:
        return grid, f"refine stopped at {len(before)} added points: the next round would pass most = {rule.most}"
    return Refined(base, (*before, *added)), ""


def _positions(base: Grid) -> list[tuple[int | Fraction, ...]]:
    left = np.arange(len(base))
    found: list[list[int]] = []
    for group in reversed(base.groups):
        left, at = np.divmod(left, group[0].count)
        found.append(at.tolist())
    return list(zip(*reversed(found), strict=True))


def _values(grid: Grid | Refined, pool: Pool, rule: Refine) -> Mapping[str, list[Any]]:
    """Return the watched columns and whether the point failed, in the order of the grid."""
    import pyarrow as pa

    located = pool.locate(grid.ids)
    primary = grid.stage.kind.tables[0]
    found: dict[str, list[Any]] = {name: [None] * len(grid) for name in rule.on}
    for number in np.unique(located.part).tolist():
        places = np.flatnonzero(located.part == number)
        table: Any = located.parts[number].table(primary).take(pa.array(located.row[places]))
        for name in rule.on:
            for place, value in zip(places.tolist(), table.column(name).to_pylist(), strict=True):
                found[name][place] = value
    return {**found, "": located.failed.tolist()}


def _differ(values: Mapping[str, list[Any]], a: int, b: int, rule: Refine) -> bool:
    """Whether two neighbours differ so much that there should be a point between them."""
    if values[""][a] or values[""][b]:
        return False
    for name in rule.on:
        one, other = values[name][a], values[name][b]
        if isinstance(one, float) and isinstance(other, float):
            if abs(one - other) > rule.jump_of(name) * max(abs(one), abs(other)):
                return True
        elif one != other:
            return True
    return False


def _halfway(
    grid: Grid | Refined,
    base: Grid,
    positions: Sequence[tuple[int | Fraction, ...]],
    axis_at: int,
    pairs: Sequence[tuple[int, int]],
    rule: Refine,
) -> list[_Added]:
    columns = {name: values.tolist() for name, values in grid.columns(range(len(grid))).items()}
    axis = base.groups[axis_at][0]
    carry = grid.stage.carry
    found: list[tuple[tuple[int | Fraction, ...], tuple[float, ...], int]] = []
    for a, b in pairs:
        low, high = columns[rule.along][a], columns[rule.along][b]
        middle = Fraction(positions[a][axis_at] + positions[b][axis_at]) / 2
        value = axis.value(middle)
        if high - low <= rule.tolerance or value in (low, high):
            continue
        position = (*positions[a][:axis_at], middle, *positions[a][axis_at + 1 :])
        row = tuple(value if name == rule.along else columns[name][a] for name in grid.names)
        found.append((position, row, a if carry is None or carry.direction == "up" else b))
    order = sorted(range(len(grid.names)), key=grid.names.__getitem__)
    if carry is None:
        words = [np.array([row[k] for _, row, _ in found]) for k in order]
        ids = free_ids(words).hex() if found else []
        return [_Added(position, row, each, "") for (position, row, _), each in zip(found, ids, strict=True)]
    names = [grid.names[k] for k in order]
    made = []
    for position, row, place in found:
        start = grid.ids.take([place]).text()
        made.append(_Added(position, row, carried_id(start, names, [row[k] for k in order]), start))
    return made
