"""Studies that are opened by their folder: several in one process, each asked by its own methods."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import FileMissingError
from vines.stages.api._asking import checks, query, table
from vines.stages.api._home import Home
from vines.stages.api._running import run, status
from vines.store import Store

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.pipeline import Declaration, RunSummary, StagePlan

__all__ = ["Study", "study"]


class Study(Home):
    """A folder with pipelines, and its results, with the methods that are needed most.

    What has no method here takes it as ``study=``, such as ``vines.stages.verify(study=mine)``.

    Examples
    --------
    >>> import tempfile
    >>> mine = study(tempfile.mkdtemp())
    >>> mine.query("select count(*) as n from points").to_pylist()
    [{'n': 0}]
    """

    __slots__ = ()

    def run(self, name: str | Declaration, **options: Any) -> RunSummary:
        """Compute what a pipeline lacks; see :func:`vines.run`."""
        return run(name, study=self, **options)

    def status(
        self, name: str | Declaration, stages: Iterable[str] | None = None, overrides: Mapping[str, Any] | None = None
    ) -> list[StagePlan]:
        """Return where each stage of a pipeline stands."""
        return status(name, stages=stages, overrides=overrides, study=self)

    def table(self, name: str) -> pa.Table:
        """Return all rows of a table or of a stage; see :func:`vines.table`."""
        return table(name, study=self)

    def query(self, sql: str) -> pa.Table:
        """Ask the catalogue in SQL; see :func:`vines.query`."""
        return query(sql, study=self)

    def checks(self, name: str | None = None) -> list[dict[str, Any]]:
        """Return what the checks of published values gave."""
        return checks(name, study=self)


def study(root: str | os.PathLike[str], data: str | os.PathLike[str] | None = None) -> Study:
    """Open the study in a folder.

    Parameters
    ----------
    root : path-like
        The folder; ``pipelines/`` in it, if there is one, declares pipelines.
    data : path-like, optional
        Where results lie; ``data/`` in the folder if left out.

    Raises
    ------
    FileMissingError
        If there is no such folder.
    """
    place = Path(root).expanduser()
    if not place.is_dir():
        raise FileMissingError(f"{place}: there is no such folder; 'vines init {place}' makes a study")
    place = place.resolve()
    results = place / "data" if data is None else Path(data).expanduser().resolve()
    return Study(place, results, Store(results).cache)
