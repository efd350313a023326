"""Many logs in Rerun's own catalogue: one row a log, its parameters and attractor as columns."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from vines.errors import ViewerError
from vines.viewer._cache import cached_rrd
from vines.viewer._program import catalogue, native_url, served

__all__ = ["browse", "catalogue_of"]


@contextlib.contextmanager
def catalogue_of(
    logs: Sequence[str | os.PathLike[str]], cache: Path, stages: Mapping[Path, str] = MappingProxyType({})
) -> Iterator[str]:
    """Run Rerun's catalogue server on 127.0.0.1 over logs and give its address; it ends with the context.

    Parameters
    ----------
    logs : sequence of path-like
        At least one; each becomes a row of the dataset ``runs``.
    cache : Path
        Where the recordings of the logs are kept.
    stages : mapping of Path to str
        Of logs, by their real paths, the ``<pipeline>.<stage>`` that they are of.

    Raises
    ------
    LogError
        If a log is damaged or incomplete.
    ViewerError
        If there is no log, or the server cannot start.
    """
    if not logs:
        raise ViewerError("there are no logs to browse; `vines run quickstart` makes some")
    paths = dict.fromkeys(Path(log).resolve() for log in logs)
    recordings = [cached_rrd([path], cache, stages=[stages.get(path, "")]) for path in paths]
    # The server shows a folder: one that holds these recordings and no others. It passes symbolic links over.
    with tempfile.TemporaryDirectory(dir=cache, prefix="browse-") as name:
        folder = Path(name) / "runs"
        folder.mkdir()
        for recording in recordings:
            try:
                os.link(recording, folder / recording.name)
            except OSError:
                shutil.copyfile(recording, folder / recording.name)
        with catalogue(folder) as address:
            yield _table(address, folder.name)


def _table(address: str, dataset: str) -> str:
    """Return the address at which the table itself opens.

    The client that knows it is an extra of rerun-sdk; without it the viewer opens one click above the table.
    """
    try:
        from rerun.catalog import CatalogClient

        entry = CatalogClient(address).get_dataset(name=dataset).id
    except ImportError:
        return address
    return f"{address}/entry/{entry}"


def browse(
    logs: Sequence[str | os.PathLike[str]],
    cache: Path,
    *,
    stages: Mapping[Path, str] = MappingProxyType({}),
    web: bool = False,
    tell: Callable[[str], object] = print,
) -> None:
    """Show many logs in the viewer as a table whose rows open as runs, until it is closed (or Ctrl-C).

    Parameters
    ----------
    logs : sequence of path-like
        The logs.
    cache : Path
        Where the recordings of the logs are kept.
    stages : mapping of Path to str
        As for :func:`catalogue_of`.
    web : bool
        Serve the web viewer instead of opening a window.
    tell : callable
        Called with the addresses.

    Raises
    ------
    LogError
        If a log is damaged or incomplete.
    ViewerError
        If there is no log, no display, or a program cannot start.
    """
    with catalogue_of(logs, cache, stages) as address:
        tell(f"catalogue of {len(logs)} logs; any Rerun viewer on this machine opens {address}")
        if web:
            with served(address) as (url, wait):
                tell(f"open {url} in a browser; Ctrl-C ends it")
                wait()
        else:
            native_url(address)
