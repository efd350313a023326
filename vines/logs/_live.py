"""Write a log while its run goes on, so that a killed process loses a second of it at most."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from vines.errors import FileMissingError, LogError, SchemaError
from vines.logs._balls import rows_of_ball
from vines.logs._bare import BARE, more_rows
from vines.logs._channels import BALLS, BASE, CHANNELS, NES, OF_BALLS, Channel, Rows, as_rows
from vines.logs._chunk import packed
from vines.logs._curves import curve_channel, curve_rows
from vines.logs._file import LogFile
from vines.logs._pack import CHUNK_BYTES, cut
from vines.logs._raw import block_of, raw_channels, raw_rows
from vines.logs._rig import rate_of, sensor_channels
from vines.logs._write import begin
from vines.model import system_names, with_all_balls
from vines.schema import numpy_dtype

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
    raw : mapping of str to mapping of str to str, optional
        Channels of a recorder that are kept as it gives them, at their full rate, with what is known of each: ``unit``,
        ``rate`` and ``dtype`` (``<f4``, ``<f8`` or ``<i4``) are needed.
    balls : int, optional
        Of a run with several balls, how many; rows are then as :func:`vines.logs.write_run` takes them.
    system : str, optional
        The system of the run; the VI-NES if left out.
    bare : bool
        Whether the log also carries what viewers draw without vines; one of several balls never does.

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
        raw: Mapping[str, Mapping[str, str]] | None = None,
        balls: int = 0,
        system: str | None = None,
        bare: bool = True,
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
            self._channels = {channel.key: channel for channel in (*CHANNELS, *_beside(system))}
        else:
            self._channels = {BASE.key: BASE, **sensor_channels(sensors)}
        self._taken = [key for key in self._channels if self._channels[key] not in (*self._balls, NES)]
        self._raw = raw_channels(raw or {})
        self._rest = {key: (0, np.empty(0, each.metadata["dtype"])) for key, each in self._raw.items()}
        self._channels |= {each.key: each for each in self._raw.values()}
        self._curves: dict[str, Channel] = {}
        self._about = (name, dict(parameters)) if bare and sensors is None and not balls else None
        if self._about is not None:
            self._channels |= {each.key: each for each in BARE}
        elif bare and sensors is not None:
            sensed = [key for key in self._taken if key != BASE.key]
            self._curves = {key: curve_channel(place, self._channels[key]) for place, key in enumerate(sensed)}
            self._channels |= {each.key: each for each in self._curves.values()}
        self._bare = self._about is not None
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
            of several balls, or of a ball with a mass beside it, hold all bodies.
        rows : numpy.ndarray, shape (n,), structured
            The fields of its message, not before the rows that were added earlier.

        Raises
        ------
        SchemaError
            If there is no such channel, the rows do not fit it, or they are earlier than the last ones.
        OSError
            If the file could not be written.
        """
        if key not in self._taken:
            raise SchemaError(f"this log has no channel {key!r}; it has {', '.join(self._taken)}")
        # A copy: what the caller does to the array afterwards must not change what is written.
        own = np.array(rows, ndmin=1)
        added = {key: as_rows(own, self._channels[key], self._counts[key])}
        if key == OF_BALLS[0].key:
            added |= {each.key: as_rows(rows_of_ball(own, each), each, self._counts[each.key]) for each in self._balls}
        if key == "states" and NES.key in self._channels:
            added |= {NES.key: as_rows(own, NES, self._counts[NES.key])}
        if not len(own):
            return
        if self._bare:
            parts = {each.key: np.empty(0, numpy_dtype(each.message)) for each in CHANNELS} | {key: added[key].values}
            about = self._about if key == "states" else None
            added |= self._numbered(more_rows(**parts, about=about))
        elif key in self._curves:
            values = added[key].values
            added |= self._numbered([curve_rows(self._curves[key], values, rate_of(values["t"]))])
        self._take(added)
        if key == "states":
            self._about = None

    def _numbered(self, every: list[Rows]) -> dict[str, Rows]:
        """Return rows that are not empty by their channels, behind those added before in number and time."""
        return {
            key: replace(each, first=self._counts[key], times=np.maximum(each.times, np.uint64(self._latest[key])))
            for each in every
            if len(each) and (key := each.channel.key)
        }

    def add_raw(self, key: str, first: int, values: np.ndarray) -> None:
        """Add samples of a recorder as it gave them; they are on disk within a second.

        Parameters
        ----------
        key : str
            The name of a channel in `raw`.
        first : int
            Number of the first sample since the run began; where it is not the one behind the last, samples were lost.
        values : numpy.ndarray, shape (n,)
            Samples in the unit and of the type of the channel.

        Raises
        ------
        SchemaError
            If there is no such channel, the samples are of another type, or they were added already.
        OSError
            If the file could not be written.
        """
        if key not in self._raw:
            raise SchemaError(f"this log has no raw channel {key!r}; it has {', '.join(self._raw) or 'none'}")
        channel = self._raw[key]
        dtype, count = channel.metadata["dtype"], block_of(channel)
        if values.ndim != 1 or values.dtype != np.dtype(dtype):
            raise SchemaError(f"samples of {key!r} are {values.dtype} {values.shape}; the log has {dtype}, shape (n,)")
        begin, rest = self._rest[key]
        expected = begin + len(rest)
        if first < expected:
            raise SchemaError(f"samples of {key!r} begin at number {first}, before the last one at {expected - 1}")
        if first > expected:
            self._take_raw(key, begin, rest, len(rest))
            begin, rest = first, rest[:0]
        joined = np.concatenate([rest, values])
        whole = len(joined) // count * count
        self._take_raw(key, begin, joined[:whole], count)
        self._rest[key] = (begin + whole, joined[whole:].copy())

    def _take_raw(self, key: str, first: int, values: np.ndarray, count: int) -> None:
        if len(values):
            channel = self._raw[key]
            self._take({channel.key: raw_rows(channel, first, values, count, self._counts[channel.key])})

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
            taken = [_alike(parts) for parts in self._waiting.values() if parts]
            self._waiting = {key: [] for key in self._channels}
            self._size = 0
            if not taken:
                return False
            # In the lock: a chunk is whole in the file before the next one begins. Messages of one channel in a chunk
            # are of one length: those of the next length go into the next chunk.
            while taken:
                for parts in cut([_joined(groups[0]) for groups in taken]):
                    self._log.chunk(packed(parts))
                taken = [groups[1:] for groups in taken if len(groups) > 1]
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
                for key, (first, rest) in self._rest.items():
                    self._take_raw(key, first, rest, len(rest))
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


def _beside(system: str | None) -> tuple[Channel, ...]:
    """Return the channel of a mass on a spring beside the ball, of a system that has one."""
    bodies = with_all_balls(system).bodies if system in system_names() else ()
    return (NES,) if any(body.position.name == "x3" for body in bodies) else ()


def _alike(parts: list[Rows]) -> list[list[Rows]]:
    """Return rows in groups that follow each other, those of one group laid out alike."""
    groups: list[list[Rows]] = []
    for part in parts:
        if groups and groups[-1][0].layout.blank == part.layout.blank:
            groups[-1].append(part)
        else:
            groups.append([part])
    return groups


def _joined(parts: list[Rows]) -> Rows:
    first = parts[0]
    times = np.concatenate([part.times for part in parts])
    return Rows(first.channel, first.layout, times, np.concatenate([part.values for part in parts]), first.first)
