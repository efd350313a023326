"""What passes between the engine and the body of a stage: jobs in, batches out.

Bodies import these types, so this module stays small: it belongs to the code digest of every stage.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import UnknownNameError, nearest

if TYPE_CHECKING:
    import msgspec
    import pyarrow as pa

__all__ = ["Batch", "Input", "Job", "Point", "Range", "WholeJob"]


@dataclass(frozen=True, slots=True)
class Point:
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
class Job:
    """Some points of a stage of the points shape, to be computed in one call.

    The result of a point must not depend on which other points share its job: chunks are cut by the clock.

    Attributes
    ----------
    options : msgspec.Struct
        The options of the kind, as declared, defaults filled in.
    points : tuple of Point
        The points; in the order of the chain when they are carried.
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

    options: msgspec.Struct
    points: tuple[Point, ...]
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


@dataclass(frozen=True, slots=True)
class WholeJob:
    """A stage of the whole shape, to be computed in one call.

    Attributes
    ----------
    options : msgspec.Struct
        The options of the kind, as declared, defaults filled in.
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
    provenance : dict
        As in :class:`Job`.
    """

    options: msgspec.Struct
    params: dict[str, float]
    ranges: dict[str, Range]
    inputs: dict[str, Input]
    files: tuple[Path, ...]
    folder: Path
    provenance: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Batch:
    """What a body returns.

    Attributes
    ----------
    tables : mapping of str to pyarrow.Table, or to a sequence of rows (dicts)
        One for each table of the kind, cast to its schema by the engine. A stage of the points shape gives
        exactly one row of the primary table for each point, and ``point_id`` in every row. A stage of the
        whole shape may leave ``point_id`` out; the rows are then numbered.
    logs : mapping of str to str
        Log file of a point (a name inside ``job.folder``) by point id.
    """

    tables: Mapping[str, Any] = field(default_factory=dict)
    logs: Mapping[str, str] = field(default_factory=dict)
