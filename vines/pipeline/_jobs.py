"""What passes between the engine and the body of a stage: jobs in, batches out.

Bodies import these types, so this module stays small: it belongs to the code digest of every stage.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Protocol, TypeVar, overload

from vines.errors import UnknownNameError, nearest

if TYPE_CHECKING:
    import msgspec
    import numpy as np
    import pyarrow as pa

    from vines.store import Ids

__all__ = ["Batch", "Input", "Job", "Point", "Points", "Range", "Spread", "WholeJob", "one_by_one"]

_Item = TypeVar("_Item")
_Made = TypeVar("_Made")
_Options = TypeVar("_Options", bound="msgspec.Struct")


class Point(NamedTuple):
    """One point of a grid.

    Attributes
    ----------
    id : str
        The point's id, to be written into the column ``point_id`` of every row that belongs to it.
    params : dict of str to float
        All parameters of the point (dimensionless): the fixed ones of the stage and the varied ones.
    """

    id: str
    params: dict[str, float]


class Points(Sequence[Point]):
    """Points of a job: a sequence of :class:`Point`, made one by one, or columns for bodies that take many at once.

    Parameters
    ----------
    fixed : dict of str to float
        All parameters in the order of the kind; what is given for those that vary doesn't matter.
    varied : dict of str to numpy.ndarray of float64, shape (n,)
        Values of those that vary.
    ids : Ids
        Their ids.
    """

    def __init__(self, fixed: dict[str, float], varied: dict[str, np.ndarray], ids: Ids) -> None:
        self.fixed = fixed
        self.varied = varied
        self.key = ids

    def __len__(self) -> int:
        return len(self.key)

    @property
    def ids(self) -> list[str]:
        """Their ids, one by one."""
        return self.key.hex()

    def column(self, name: str) -> np.ndarray:
        """Return the values of a parameter.

        Raises
        ------
        UnknownNameError
            If there is no such parameter.
        """
        import numpy as np

        if name in self.varied:
            return self.varied[name]
        if name not in self.fixed:
            raise UnknownNameError(f"unknown parameter {name!r}: {nearest(name, self.fixed)}")
        return np.full(len(self), self.fixed[name])

    def __iter__(self) -> Iterator[Point]:
        names = list(self.varied)
        columns = [self.varied[name].tolist() for name in names]
        values = zip(*columns, strict=True) if columns else itertools.repeat(())
        for identity, row in zip(self.ids, values, strict=bool(columns)):
            yield Point(identity, {**self.fixed, **dict(zip(names, row, strict=True))})

    @overload
    def __getitem__(self, at: int) -> Point: ...

    @overload
    def __getitem__(self, at: slice) -> Points: ...

    def __getitem__(self, at: int | slice) -> Point | Points:
        if isinstance(at, slice):
            return Points(self.fixed, {name: values[at] for name, values in self.varied.items()}, self.key.take(at))
        place = range(len(self))[at]
        return next(iter(self[place : place + 1]))


@dataclass(frozen=True, slots=True)
class Range:
    """An interval that a stage of the whole shape covers, such as the range of a branch.

    Attributes
    ----------
    start, stop : float
        The ends as declared, ``from`` and ``to``; ``start`` may be the larger one.
    """

    start: float
    stop: float


@dataclass(frozen=True, slots=True)
class Job(Generic[_Options]):
    """Some points of a stage of the points shape, to be computed in one call.

    The result of a point must not depend on which other points share its job: chunks are cut by the clock.

    Attributes
    ----------
    options : msgspec.Struct
        The options of the kind, as declared, defaults filled in; their type stands in brackets where a body takes the
        job.
    points : Points
        The points, in the order of the chain when they are carried: one by one, or as columns.
    carry : str or None
        The carried axis. The end state of each point is then the start of the next.
    start : dict or None
        The predecessor's row in the primary table, if `carry` and there is a predecessor. ``None`` means:
        start as the options say.
    folder : Path
        An empty folder for log files.
    provenance : dict
        What log files say about their origin: kind, key, options, params, code digest, versions; no clock,
        no host.
    """

    options: _Options
    points: Points
    carry: str | None
    start: dict[str, Any] | None
    folder: Path
    provenance: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Input:
    """The stored result of a needed stage.

    Attributes
    ----------
    name, kind, key : str
        Name of the stage, its kind, and the key of its result.
    params : dict of str to float
        The fixed parameters of that stage.
    axes : tuple of str
        The varied parameters of that stage, as declared.
    carried, direction : str
        The axis along which states were carried, and "up" or "down"; empty if none were.
    tables : tuple of str
        Tables that the result has, the primary one first.
    logs : dict of str to Path
        Log file of each point that has one.
    folder : Path
        Where the result lies.
    """

    name: str
    kind: str
    key: str
    params: dict[str, float]
    axes: tuple[str, ...]
    tables: tuple[str, ...]
    logs: dict[str, Path]
    folder: Path
    carried: str = ""
    direction: str = ""

    def table(self, name: str | None = None) -> pa.Table:
        """Return a table of the result, the primary one if no name is given.

        Raises
        ------
        UnknownNameError
            If the result has no such table.
        """
        wanted = name if name is not None else (self.tables[0] if self.tables else "")
        if wanted not in self.tables:
            raise UnknownNameError(f"stage {self.name!r} has no table {wanted!r}: {nearest(wanted, self.tables)}")
        import pyarrow.parquet as pq

        return pq.read_table(self.folder / f"{wanted}.parquet")


class Spread(Protocol):
    """Apply a function to items that do not depend on each other, in as many processes as the run may use."""

    def __call__(self, function: Callable[[_Item], _Made], items: Sequence[_Item]) -> list[_Made]:
        """Return what the function, which can be imported by its name, makes of each item, in their order."""
        ...


def one_by_one(function: Callable[[_Item], _Made], items: Sequence[_Item]) -> list[_Made]:
    """Return what a function makes of each item, one after the other in this process.

    Examples
    --------
    >>> one_by_one(len, ["LR", "LLR"])
    [2, 3]
    """
    return [function(item) for item in items]


@dataclass(frozen=True, slots=True)
class WholeJob(Generic[_Options]):
    """A stage of the whole shape, to be computed in one call.

    Attributes
    ----------
    options : msgspec.Struct
        The options of the kind, as declared, defaults filled in; their type stands in brackets where a body takes the
        job.
    params : dict of str to float
        The fixed parameters (dimensionless).
    ranges : dict of str to Range
        The varied parameters.
    inputs : dict of str to Input
        The results of the stages that this one needs, in the order declared.
    files : tuple of Path
        The files that the kind named as ingredients (see ``Kind.files``).
    folder : Path
        An empty folder; every file that the body leaves there becomes part of the result.
    root : Path
        Root of the project, below which options name files.
    cache : Path
        Where the body may keep what can be made again.
    provenance : dict
        As in :class:`Job`.
    spread : Spread
        For parts of the work that do not depend on each other; how many processes share them changes no result.
    """

    options: _Options
    params: dict[str, float]
    ranges: dict[str, Range]
    inputs: dict[str, Input]
    files: tuple[Path, ...]
    folder: Path
    root: Path
    cache: Path
    provenance: dict[str, Any]
    spread: Spread = one_by_one


@dataclass(frozen=True, slots=True)
class Batch:
    """What a body returns.

    Attributes
    ----------
    tables : mapping of str to pyarrow.Table, to a mapping of columns, or to a sequence of rows (dicts)
        One for each table of the kind, cast to its schema by the engine. A stage of the points shape gives
        exactly one row of the primary table for each point, and ``point_id`` in every row. A stage of the
        whole shape may leave ``point_id`` out; the rows are then numbered.
    logs : mapping of str to str
        Log file of a point (a name inside ``job.folder``) by point id.
    """

    tables: Mapping[str, Any] = field(default_factory=dict)
    logs: Mapping[str, str] = field(default_factory=dict)
