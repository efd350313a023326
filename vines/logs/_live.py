"""Write a log while its run goes on, so that a killed process loses a second of it at most."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from vines.errors import FileMissingError, LogError, SchemaError
from vines.logs._balls import rows_of_ball
from vines.logs._channels import BALLS, BASE, CHANNELS, OF_BALLS, Rows, as_rows
from vines.logs._chunk import packed
from vines.logs._file import LogFile
from vines.logs._pack import CHUNK_BYTES, cut
from vines.logs._rig import sensor_channels
from vines.logs._write import begin

__all__ = ["LiveWriter"]

_EVERY = 0.4
"""Seconds after which what has been added is written, in whole chunks."""


class LiveWriter:
    """A log that grows while its run goes on.

    Rows are written to ``<path>.part`` and synced to disk every 0.4 s, or when a chunk is full, by a thread of its own;
    on leaving the context the log is finished and takes its name. If the process is killed, or the machine stops, what
    was added up to a second before is in ``<path>.part``, which ``vines recover`` makes into a log.

    Parameters
    ----------
    path : path-like
        Where the finished log goes; an existing file is replaced then.
    name : str
        What the run is called.
    provenance, parameters, declaration
        As in :func:`vines.logs.write_run`.
    sensors : mapping of str to mapping of str to str, optional
        What each sensor of a rig measures (see :class:`vines.logs.Sensor`). The log is then one of a rig, with
        ``base`` and the sensors; else it is one of the simulator, with ``states``, ``impacts`` and ``sticks``.
    balls : int, optional
        Of a run with several balls, how many; rows are then as :func:`vines.logs.write_run` takes them.
    system : str, optional
        The system of the run; the VI-NES if left out.

    Raises
    ------
    FileMissingError
        If the folder does not exist.
    SchemaError
        If a log has no channels for so many balls, or a rig is said to have some.
    LogError
        If ``<path>.part`` exists: another writer is at it, or left it behind.

    Examples
    --------
    >>> import tempfile
    >>> from vines import logs
    >>> from vines.schema import numpy_dtype
    >>> rows = np.zeros(2, numpy_dtype("vines.v1.Impact"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with LiveWriter(f"{folder}/run.mcap", name="live", provenance={}, parameters={}) as live:
    ...         live.add("impacts", rows)
    ...     logs.read(f"{folder}/run.mcap").impacts.num_rows
    2
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        name: str,
        provenance: Mapping[str, object],
        parameters: Mapping[str, float],
        declaration: str | None = None,
        sensors: Mapping[str, Mapping[str, str]] | None = None,
        balls: int = 0,
        system: str | None = None,
    ):
        self._path = Path(path)
        self._partial = self._path.with_name(f"{self._path.name}.part")
        if not self._path.parent.is_dir():
            raise FileMissingError(f"the folder {self._path.parent} of the log {self._path.name} does not exist")
        if not 0 <= balls <= len(BALLS) or (balls and sensors is not None):
            raise SchemaError(
                f"balls is {balls!r}; give 1 to {len(BALLS)} for a run with several balls, none for a rig"
            )
        self._balls = BALLS[:balls]
        if balls:
            self._channels = {channel.key: channel for channel in (*OF_BALLS, *self._balls)}
        elif sensors is None:
            self._channels = {channel.key: channel for channel in CHANNELS}
        else:
            self._channels = {BASE.key: BASE, **sensor_channels(sensors)}
        self._waiting: dict[str, list[Rows]] = {key: [] for key in self._channels}
        self._counts = dict.fromkeys(self._channels, 0)
        self._latest = dict.fromkeys(self._channels, 0)
        self._size = 0
        self._failed: BaseException | None = None
        self._lock = threading.Lock()
        self._due = threading.Event()
        self._over = threading.Event()
        try:
            self._stream = self._partial.open("xb")
        except FileExistsError:
            raise LogError(
                f"{self._partial} exists: another process writes it, or was killed; "
                f"`vines recover {self._partial}` saves it, then remove it"
            ) from None
        self._log = LogFile(self._stream)
        kind = "run" if sensors is None else "rig"
        about = {"name": name, "kind": kind} | ({} if system is None else {"system": system})
        begin(self._log, about, provenance, parameters, declaration)
        for channel in self._channels.values():
            self._log.channel(channel)
        self._log.digests()
        self._stream.flush()
        os.fsync(self._stream.fileno())
        self._thread = threading.Thread(target=self._write_on, name=f"writer of {self._path.name}", daemon=True)
        self._thread.start()

    def add(self, key: str, rows: np.ndarray) -> None:
        """Add rows to a channel; they are on disk within a second.

        Parameters
        ----------
        key : str
            ``"states"``, ``"impacts"`` or ``"sticks"``; in the log of a rig ``"base"`` or the name of a sensor. States
            of several balls hold all bodies.
        rows : numpy.ndarray, shape (n,), structured
            The fields of its message, not before the rows that were added earlier.

        Raises
        ------
        SchemaError
            If there is no such channel, the rows do not fit it, or they are earlier than the last ones.
        OSError
            If the file could not be written.
        """
        known = [name for name in self._channels if self._channels[name] not in self._balls]
        if key not in known:
            raise SchemaError(f"this log has no channel {key!r}; it has {', '.join(known)}")
        # A copy: what the caller does to the array afterwards must not change what is written.
        own = np.array(rows, ndmin=1)
        added = {key: as_rows(own, self._channels[key], self._counts[key])}
        if key == OF_BALLS[0].key:
            added |= {each.key: as_rows(rows_of_ball(own, each), each, self._counts[each.key]) for each in self._balls}
        if len(own):
            self._take(added)

    def _take(self, added: dict[str, Rows]) -> None:
        """Keep rows of one instant after another in channels that are all as far until they are written."""
        with self._lock:
            if self._failed is not None:
                raise self._failed
            if self._stream.closed:
                raise LogError(f"{self._path} is finished; rows can be added only inside its context")
            for key, each in added.items():
                if int(each.times[0]) < self._latest[key]:
                    raise SchemaError(
                        f"rows of {key!r} begin at {each.times[0] / 1e9:g}, "
                        f"before the last one at {self._latest[key] / 1e9:g}; add them in the order of time"
                    )
            for key, each in added.items():
                self._waiting[key].append(each)
                self._counts[key] += len(each)
                self._latest[key] = int(each.times[-1])
                self._size += len(each) * each.width
            full = self._size >= CHUNK_BYTES
        if full:
            self._due.set()

    def _write_on(self) -> None:
        while not self._over.is_set():
            self._due.wait(_EVERY)
            self._due.clear()
            try:
                # Outside the lock: who adds rows does not wait for the disk.
                if self._flush():
                    os.fsync(self._stream.fileno())
            except BaseException as failure:
                # Told by the next `add`, in the thread of the caller.
                self._failed = failure
                return

    def _flush(self) -> bool:
        """Hand what is waiting to the system, in chunks of the usual size; return whether there was anything."""
        with self._lock:
            taken = [_joined(parts) for parts in self._waiting.values() if parts]
            self._waiting = {key: [] for key in self._channels}
            self._size = 0
            if not taken:
                return False
            # In the lock: a chunk is whole in the file before the next one begins.
            for parts in cut(taken):
                self._log.chunk(packed(parts))
            self._stream.flush()
            return True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Finish the log; if the run failed, what there is stays in ``<path>.part``."""
        self._over.set()
        self._due.set()
        self._thread.join()
        try:
            if self._failed is None:
                self._flush()
            if self._failed is None and kind is None:
                counts = {channel.topic: str(self._counts[key]) for key, channel in self._channels.items()}
                self._log.status("complete", counts)
                self._log.finish()
                self._stream.flush()
                os.fsync(self._stream.fileno())
        finally:
            self._stream.close()
        if self._failed is not None:
            raise self._failed
        if kind is None:
            self._partial.replace(self._path)


def _joined(parts: list[Rows]) -> Rows:
    first = parts[0]
    times = np.concatenate([part.times for part in parts])
    return Rows(first.channel, first.layout, times, np.concatenate([part.values for part in parts]), first.first)
