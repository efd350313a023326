"""The folder ``data/``: where results, pools, pins and the cache lie, and the lock for writing."""

from __future__ import annotations

import contextlib
import json
import platform
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.errors import DamageError, StoreError
from vines.store._atomic import commit_folder, write_text
from vines.store._described import describe_files
from vines.store._keys import key_of
from vines.store._object import is_lasting, read_object
from vines.store._results import Result, read_result, seal
from vines.store._staging import clear_staging, staging
from vines.store._wholeness import look, remember

if TYPE_CHECKING:
    from vines.store._pools import Pool

__all__ = ["Store"]

_PINS = ".pins.json"
_KEY = re.compile(r"\w+", re.ASCII)
"""What the name of a folder may be: a pin leads nowhere else."""


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
        """Whether there is a result of that key, whole as far as :meth:`problem` sees."""
        return not self.problem(key)

    def problem(self, key: str, files: Collection[str] | None = None, *, thorough: bool = False) -> str:
        """Return in words why the result of a key cannot be used; empty if it can.

        Looks at the manifest, and that all files are there in their sizes; reads those that were changed since they
        were last found right.

        Parameters
        ----------
        key : str
            Key of the result.
        files : collection of str, optional
            Only these files matter.
        thorough : bool
            Whether to read files too of which nobody has noted that they are right.
        """
        folder = self.results / key
        if not folder.is_dir():
            return "it is not stored"
        try:
            result = read_result(folder)
            return look(result, self._seen(key), files, thorough=thorough)
        except DamageError as error:
            return str(error)
        except OSError as error:
            return f"{error.filename or folder} cannot be read: {error.strerror}"

    def result(self, key: str, *, strict: bool = True) -> Result:
        """Return a stored result.

        Parameters
        ----------
        key : str
            Its key.
        strict : bool
            Whether to refuse a manifest that can be read, but is not what was written.

        Raises
        ------
        StoreError
            If there is none of that key, or its manifest is damaged.
        """
        if not (self.results / key).is_dir():
            raise StoreError(f"there is no result {key[:12]} below {self.results}; run its pipeline again")
        return read_result(self.results / key, strict=strict)

    def _seen(self, key: str) -> Path:
        return self.cache / "whole" / f"{key}.json"

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
            Whether to put it in the place of a result of the same key that differs from it. Else that one is kept,
            unless it is damaged.
        """
        files = describe_files(folder)
        whole = {
            **manifest,
            "key": key,
            "files": files,
            "written": datetime.now(UTC).isoformat(timespec="seconds"),
            "host": platform.node(),
        }
        write_text(folder / "manifest.json", json.dumps(seal(whole), indent=1) + "\n")
        target = self.results / key
        if target.exists() and (not self.has(key) or (replace and not self._same(key, files))):
            with self.staging() as trash:
                target.rename(trash / "old")
                commit_folder(folder, target)
        else:
            commit_folder(folder, target)
        result = self.result(key)
        if result.manifest["files"] == files:
            remember(result, self._seen(key), files)
        return result

    def _same(self, key: str, files: Mapping[str, Any]) -> bool:
        """Whether the stored result of a key has these files and they are intact."""
        there = self.result(key)
        return there.manifest["files"] == files and not there.damage()

    def has_pools(self) -> bool:
        """Whether any point was ever stored."""
        return self.pools.is_dir()

    def pool(self, key: str) -> Pool:
        """Return the pool of a key; it need not exist yet."""
        from vines.store._pools import Pool

        return Pool(self.pools / key)

    def discard_damaged(self, pool: Pool) -> None:
        """Put away the parts of a pool that are known to be damaged, so that their points are computed again."""
        with self.staging() as trash:
            pool.discard_damaged(trash)

    def pins(self, pipeline: str) -> dict[str, dict[str, Any]]:
        """Return the pin of each stage of a pipeline; empty if it was never run.

        Raises
        ------
        DamageError
            If the file is damaged.
        StoreError
            If the system does not let it be read.
        """
        path = self._pin_file(pipeline)
        remedy = f"'vines run {pipeline}' makes it again; if there is no such pipeline any more, remove it"
        try:
            pins = read_object(path)
            checks = {stage: _form_of(stage, pin).pop("check", None) for stage, pin in pins.items()}
            if not pins:
                raise ValueError("it names no stage")
        except (FileNotFoundError, NotADirectoryError):
            return {}
        except OSError as error:
            if not is_lasting(error):
                raise StoreError(f"{path} cannot be read: {error.strerror}") from None
            raise DamageError(f"{path} is damaged: {error.strerror}; {remedy}") from None
        except ValueError as error:
            raise DamageError(f"{path} is damaged: {error}; {remedy}") from None
        for stage, pin in pins.items():
            if checks[stage] not in (None, _check(pipeline, stage, pin)):
                raise DamageError(f"{path} is damaged: it is not what was written; {remedy}")
        return pins

    def pin(self, pipeline: str, stage: str, pin: Mapping[str, Any]) -> None:
        """Set which result a stage has now; a damaged file is made anew. A pin holds at least ``result``, the key."""
        try:
            pins = self.pins(pipeline)
        except DamageError:
            pins = {}
        self._write_pins(pipeline, {**pins, stage: dict(pin)})

    def unpin(self, pipeline: str, stages: Iterable[str]) -> None:
        """Forget the results of stages that a pipeline no longer has."""
        gone = set(stages)
        self._write_pins(pipeline, {stage: pin for stage, pin in self.pins(pipeline).items() if stage not in gone})

    def pinned(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Return the pins of all pipelines that were run, by name, in order.

        Raises
        ------
        StoreError
            If one of the files is damaged, or cannot be read.
        """
        return {name: self.pins(name) for name in self._pinned_names()}

    def readable_pins(self) -> tuple[dict[str, dict[str, dict[str, Any]]], dict[str, str]]:
        """Return the pins of the pipelines whose files can be read, and of the others why they cannot."""
        found: dict[str, dict[str, dict[str, Any]]] = {}
        damaged: dict[str, str] = {}
        for name in self._pinned_names():
            try:
                found[name] = self.pins(name)
            except StoreError as error:
                damaged[name] = str(error)
        return found, damaged

    def _pinned_names(self) -> list[str]:
        return sorted(path.name.removesuffix(_PINS) for path in self.pipelines.glob(f"[!.]*{_PINS}"))

    def _write_pins(self, pipeline: str, pins: Mapping[str, dict[str, Any]]) -> None:
        if not pins:
            self._pin_file(pipeline).unlink(missing_ok=True)
            return
        sealed = {stage: {**pin, "check": _check(pipeline, stage, pin)} for stage, pin in pins.items()}
        write_text(self._pin_file(pipeline), json.dumps(sealed, indent=1, sort_keys=True) + "\n")

    def _pin_file(self, pipeline: str) -> Path:
        return self.pipelines / f"{pipeline}{_PINS}"


def _form_of(stage: str, pin: Any) -> dict[str, Any]:
    """Return a pin that has the form of one.

    Raises
    ------
    ValueError
        If it has not.
    """
    keys = [pin.get("result"), pin.get("pool", "none")] if isinstance(pin, dict) else []
    if not keys or not all(isinstance(key, str) and _KEY.fullmatch(key) for key in keys):
        raise ValueError(f"no key of a result stands under {stage!r}")
    return pin


def _check(pipeline: str, stage: str, pin: Mapping[str, Any]) -> str:
    """Return the digest that tells whether a pin is what was written, and of this stage."""
    return key_of([pipeline, stage, dict(pin)])
