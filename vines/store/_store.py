"""The folder ``data/``: where results, pools, pins and the cache lie, and the lock for writing."""

from __future__ import annotations

import contextlib
import json
import platform
from collections.abc import Callable, Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import StoreError
from vines.store._atomic import commit_folder, write_text
from vines.store._results import Result, describe_files, read_result
from vines.store._staging import clear_staging, staging

if TYPE_CHECKING:
    from vines.store._pools import Pool

__all__ = ["Store"]


class Store:
    """Everything that vines keeps, below one folder.

    Nothing is made until something is written. Readers need no lock; one process at a time writes, see
    :meth:`writing`.

    Parameters
    ----------
    data : Path
        The folder ``data/`` of a project; need not exist.
    """

    def __init__(self, data: Path) -> None:
        self.data = Path(data)

    def __repr__(self) -> str:
        return f"Store({str(self.data)!r})"

    @property
    def results(self) -> Path:
        """Folder of results."""
        return self.data / "results"

    @property
    def pools(self) -> Path:
        """Folder of pools of points."""
        return self.data / "points"

    @property
    def pipelines(self) -> Path:
        """Folder of pins."""
        return self.data / "pipelines"

    @property
    def cache(self) -> Path:
        """Folder of what can be made again."""
        return self.data / "cache"

    @property
    def logs(self) -> Path:
        """Folder of the log files of runs."""
        return self.data / "logs"

    @property
    def staging_folder(self) -> Path:
        """Folder of what is being written; on the same file system, so that a rename is atomic."""
        return self.data / "staging"

    def staging(self) -> contextlib.AbstractContextManager[Path]:
        """Give an empty folder to write in; what is left in it at the end is removed."""
        return staging(self.staging_folder)

    @contextlib.contextmanager
    def writing(self, on_wait: Callable[[], None] | None = None) -> Iterator[None]:
        """Be the one that writes; wait while another process is. The lock dies with its process.

        Parameters
        ----------
        on_wait : callable, optional
            Called once if there is somebody to wait for.
        """
        from filelock import FileLock, Timeout

        self.data.mkdir(parents=True, exist_ok=True)
        lock = FileLock(self.data / "store.lock")
        try:
            lock.acquire(timeout=0)
        except Timeout:
            if on_wait is not None:
                on_wait()
            lock.acquire(poll_interval=0.2)
        try:
            clear_staging(self.staging_folder)
            yield
        finally:
            lock.release()

    def has(self, key: str) -> bool:
        """Whether there is a result of that key."""
        return (self.results / key / "manifest.json").is_file()

    def result(self, key: str) -> Result:
        """Return a stored result.

        Raises
        ------
        StoreError
            If there is none of that key, or its manifest is damaged.
        """
        if not self.has(key):
            raise StoreError(f"there is no result {key[:12]} below {self.results}; run its pipeline again")
        return read_result(self.results / key)

    def commit(self, key: str, folder: Path, manifest: Mapping[str, Any], *, replace: bool = False) -> Result:
        """Make a finished folder the result of a key.

        Parameters
        ----------
        key : str
            Key of the result.
        folder : Path
            Staged folder with all files except the manifest.
        manifest : mapping
            The manifest without ``files``, ``written`` and ``host``, which are added here.
        replace : bool
            Whether to put it in the place of a result of the same key that differs from it. Else that one is kept.
        """
        files = describe_files(folder)
        whole = {
            **manifest,
            "key": key,
            "files": files,
            "written": datetime.now(UTC).isoformat(timespec="seconds"),
            "host": platform.node(),
        }
        write_text(folder / "manifest.json", json.dumps(whole, indent=1) + "\n")
        target = self.results / key
        if replace and target.exists() and not (self.has(key) and self._same(key, files)):
            with self.staging() as trash:
                target.rename(trash / "old")
                commit_folder(folder, target)
        else:
            commit_folder(folder, target)
        return self.result(key)

    def _same(self, key: str, files: Mapping[str, Any]) -> bool:
        """Whether the stored result of a key has these files and they are intact."""
        there = self.result(key)
        return there.manifest["files"] == files and not there.damage()

    def pool(self, key: str) -> Pool:
        """Return the pool of a key; it need not exist yet."""
        from vines.store._pools import Pool

        return Pool(self.pools / key)

    def pins(self, pipeline: str) -> dict[str, dict[str, Any]]:
        """Return the pin of each stage of a pipeline; empty if it was never run.

        Raises
        ------
        StoreError
            If the file is damaged.
        """
        path = self._pin_file(pipeline)
        try:
            return json.loads(path.read_text("utf-8"))
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as error:
            raise StoreError(f"{path} cannot be read: {error}; remove it and run the pipeline again") from None

    def pin(self, pipeline: str, stage: str, pin: Mapping[str, Any]) -> None:
        """Set which result a stage has now. A pin holds at least ``result``, the key."""
        pins = {**self.pins(pipeline), stage: dict(pin)}
        write_text(self._pin_file(pipeline), json.dumps(pins, indent=1, sort_keys=True) + "\n")

    def unpin(self, pipeline: str, stages: Iterable[str]) -> None:
        """Forget the results of stages that a pipeline no longer has."""
        gone = set(stages)
        pins = {stage: pin for stage, pin in self.pins(pipeline).items() if stage not in gone}
        write_text(self._pin_file(pipeline), json.dumps(pins, indent=1, sort_keys=True) + "\n")

    def pinned(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Return the pins of all pipelines that were run, by name, in order."""
        suffix = ".pins.json"
        names = sorted(path.name.removesuffix(suffix) for path in self.pipelines.glob(f"[!.]*{suffix}"))
        return {name: self.pins(name) for name in names}

    def _pin_file(self, pipeline: str) -> Path:
        return self.pipelines / f"{pipeline}.pins.json"
