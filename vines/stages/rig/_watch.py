"""Watching a rig: what comes from a source is logged, shown and told once a second."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import msgspec
import numpy as np

from vines.errors import RigError, StoreError
from vines.logs import LiveWriter, Thinner
from vines.rig.records import LOG_RATE
from vines.rig.watch import Channel, LoggedRun, Monitor, Refusal, Report, Source, Stream
from vines.schema import numpy_dtype
from vines.stages.rig._telling import report_line, status_text

if TYPE_CHECKING:
    from vines.stages.rig._foxglove import FoxgloveServer
    from vines.viewer import Live

__all__ = ["EVERY", "Told", "Watched", "watch_rig"]

EVERY = 1.0
"""Seconds between two reports."""
_SHOWN_RATE = 512.0
"""Samples a second of a channel that are shown while a run goes on."""
_SHOWN = {"m": (1e3, "mm")}
"""Units in which values are shown whose axis would have long numbers otherwise."""
_FULL = 0.9999
"""Part of the range from which on a sample is clipped."""
_SILENT = 5.0
"""Seconds without samples after which that is told."""


@dataclass(frozen=True, slots=True)
class Watched:
    """A stream that was watched.

    Attributes
    ----------
    name : str
        What it is called.
    log : Path or None
        Its log, if it has one.
    folder : Path or None
        The run folder in which the log is the raw file.
    file : Path or None
        The recording that it is of.
    seconds : float
        How long it was.
    report : Report or None
        The last one.
    missing : tuple of str
        Entries of ``run.json`` that a person has to fill in before it can be reconstructed.
    transient : float or None
        Seconds at its beginning until it had settled, if it did.
    """

    name: str
    log: Path | None
    folder: Path | None
    file: Path | None
    seconds: float
    report: Report | None
    missing: tuple[str, ...] = ()
    transient: float | None = None


class Told(Protocol):
    """Who is told what happens."""

    def began(self, stream: Stream, log: Path | None) -> None:
        """Take note of a stream that begins, and of where it is logged."""
        ...

    def report(self, report: Report) -> None:
        """Take note of how it goes, once a second."""
        ...

    def remark(self, text: str) -> None:
        """Take note of what a person has to know."""
        ...

    def ended(self, watched: Watched) -> None:
        """Take note of one that has ended."""
        ...


@dataclass
class _Session:
    """One stream that is being watched."""

    stream: Stream
    monitor: Monitor
    told: Told
    show: Live | None
    foxglove: FoxgloveServer | None
    settled_first: bool
    log_of: Callable[[float | None, float], LoggedRun | Path | None]
    live: LiveWriter | None = None
    run: LoggedRun | None = None
    log: Path | None = None
    origin: int = 0
    last: Report | None = None
    transient: float | None = None
    thinners: dict[str, tuple[Thinner, Thinner]] = field(default_factory=dict)

    def begin(self, first: int, settle: float | None = None) -> None:
        """Open the log; its times count from the sample with this number."""
        where = self.log_of(settle, first / self.stream.rate)
        self.origin = first
        if where is None:
            return
        self.run = where if isinstance(where, LoggedRun) else None
        self.log = where.log if isinstance(where, LoggedRun) else where
        sensors = {
            each.name: {
                **each.about,
                "rate": repr(self.stream.rate),
                "thinned": "all samples are on /raw, or in the file",
            }
            for each in self.stream.channels
        }
        raw = {
            each.name: {
                "unit": each.unit,
                "rate": repr(self.stream.rate),
                "dtype": self.stream.dtype,
                "role": each.role,
                **({} if each.range is None else {"range": repr(each.range)}),
            }
            for each in self.stream.channels
        }
        numbers = {"b [m]": self.monitor.b} if self.monitor.b is not None else {}
        origin = {"stage": "vines rig watch", **{k: v for k, v in self.stream.run.items() if k == "start_utc" and v}}
        if self.stream.file is not None:
            origin["file"] = self.stream.file.name
        self.live = LiveWriter(
            self.log,
            name=self.run.run_id if self.run else self.stream.name,
            provenance=origin,
            parameters=numbers,
            sensors=sensors,
            raw=None if self.stream.file is not None else raw,
        )

    def take(self, first: int, values: np.ndarray, si: np.ndarray) -> None:
        """Log and show a block."""
        for place, channel in enumerate(self.stream.channels):
            thinners = self.thinners.get(channel.name)
            if thinners is None:
                groups = (int(np.ceil(self.stream.rate / rate)) for rate in (LOG_RATE, _SHOWN_RATE))
                thinners = (Thinner(next(groups)), Thinner(next(groups)))
                self.thinners[channel.name] = thinners
            kept, shown = (thinner.add(first, si[place]) for thinner in thinners)
            if self.live is not None:
                if self.stream.file is None:
                    self.live.add_raw(
                        channel.name, first - self.origin, np.ascontiguousarray(values[place], self.stream.dtype)
                    )
                t = (kept[0] - self.origin) / self.stream.rate - channel.delay
                rows = _rows(t, kept[1], channel)
                if len(rows):
                    self.live.add(channel.name, rows)
            t = shown[0] / self.stream.rate - channel.delay
            if self.show is not None:
                self.show.samples(channel.name, t, shown[1] * _SHOWN.get(channel.si, (1.0, ""))[0])
            if self.foxglove is not None:
                self.foxglove.samples(channel.name, t, shown[1])

    def report(self) -> None:
        """Say what is known by now, everywhere."""
        self.last = report = self.monitor.report()
        if report.settled and self.transient is None:
            self.transient = report.t
        self.told.report(report)
        if self.run is not None:
            with (self.run.folder / "derived" / "watch.jsonl").open("ab") as stream:
                stream.write(msgspec.json.encode(report) + b"\n")
        if self.show is not None:
            self.show.impacts(*self.monitor.recent(1.5 * EVERY))
            found = {"response": 1e3 * (report.max_abs_x1 or np.nan), "share": report.share, "r": report.r}
            known = {key: value for key, value in found.items() if value is not None and np.isfinite(value)}
            self.show.status(report.t, status_text(report, self.stream), report_line(report), known)
        if self.foxglove is not None:
            self.foxglove.status(report.t, report)
        if self.live is None and self.settled_first and report.settled:
            self.begin(round(self.monitor.time * self.stream.rate), report.t - report.since)
            if self.log is not None:
                self.told.remark(f"settled after {report.t - report.since:.0f} s: logged from here on to {self.log}")


def watch_rig(
    source: Source,
    told: Told,
    *,
    out: Path,
    name: str | None = None,
    settled_first: bool = False,
    seconds: float | None = None,
    show: Live | None = None,
    foxglove: FoxgloveServer | None = None,
    b: float | None = None,
    memory: float | None = None,
) -> list[Watched]:
    """Watch a source until it ends, so many seconds are logged, or Ctrl-C.

    A live stream becomes a run folder in `out`, whose raw file is the log; a file becomes a log in `out`. What is
    logged when Ctrl-C comes is complete; if the process is killed, a second of it is lost at most.

    Parameters
    ----------
    source : Source
        From :func:`vines.rig.watch.open_source`; it is closed.
    told : Told
        Who is told.
    out : Path
        Folder for logs and run folders; a campaign, too.
    name : str, optional
        Of the run folder; that of the stream if left out.
    settled_first : bool
        Whether a live stream is logged only from when it has settled.
    seconds : float, optional
        How long a live stream is logged.
    show : Live, optional
        Where it is shown.
    foxglove : FoxgloveServer, optional
        Where it is served.
    b : float, optional
        Half length of the cavity less the ball's radius [m], if the source does not state it.
    memory : float, optional
        2/lam in time units of the rig [s].

    Returns
    -------
    list of Watched

    Raises
    ------
    RigError
        If what arrives is no stream, or its log is in the way; what was logged before is complete.
    """
    done: list[Watched] = []
    try:
        for stream in source.streams():
            if stream is None:
                continue
            if isinstance(stream, Refusal):
                told.remark(f"{stream.file}: {stream.reason}")
                continue
            gauged = stream.run.get("b")
            half = float(gauged["value"]) if isinstance(gauged, Mapping) and gauged.get("value") else b
            session = _Session(
                stream,
                Monitor(stream.channels, stream.rate, b=half, memory=memory),
                told,
                show,
                foxglove,
                settled_first and source.live,
                _places(stream, out, name),
            )
            with _ending(session, told, done):
                _watch(session, seconds if source.live else None)
            if source.live:
                break
    except KeyboardInterrupt:
        pass
    finally:
        source.close()
    return done


def _watch(session: _Session, seconds: float | None) -> None:
    """Go through the blocks of a stream."""
    stream, monitor = session.stream, session.monitor
    if session.show is not None:
        units = {each.name: _SHOWN.get(each.si, (1.0, each.si))[1] for each in stream.channels}
        session.show.begin(stream.name, {c.name: f"{c.quantity} [{units[c.name]}]" for c in stream.channels})
    if session.foxglove is not None:
        session.foxglove.begin(stream.name, {c.name: f"{c.quantity} [{c.si}]" for c in stream.channels})
    if not session.settled_first:
        session.begin(0)
    session.told.began(stream, session.log)
    for remark in stream.remarks:
        session.told.remark(remark)
    heard, silent, due = time.monotonic(), False, EVERY
    for block in stream.blocks:
        now = time.monotonic()
        if block is not None:
            heard, silent = now, False
            session.take(block.first, block.values, monitor.take(block))
        elif now - heard > _SILENT and not silent:
            silent = True
            session.told.remark(f"no samples for {_SILENT:.0f} s")
        # By the clock of the samples: a file has no pace of its own, and a gap is no time to catch up.
        if monitor.time >= due:
            due = max(due + EVERY, float(np.ceil(monitor.time)))
            session.report()
        if seconds is not None and session.live is not None:
            logged = monitor.time - session.origin / stream.rate
            if logged >= seconds - 0.5 / stream.rate:
                return


@contextlib.contextmanager
def _ending(session: _Session, told: Told, done: list[Watched]) -> Iterator[None]:
    """Finish the log however the stream ends, and say what became of it."""
    failure: BaseException | None = None
    try:
        yield
    except (KeyboardInterrupt, RigError, OSError) as ended:
        failure = ended
    with session.live if session.live is not None else contextlib.nullcontext():
        pass
    if session.run is not None:
        session.run.write(session.last)
    watched = Watched(
        session.stream.name,
        session.log,
        session.run.folder if session.run else None,
        session.stream.file,
        session.monitor.time,
        session.last,
        tuple(session.run.missing) if session.run else (),
        None if session.settled_first else session.transient,
    )
    done.append(watched)
    told.ended(watched)
    if failure is not None:
        raise failure


def _places(stream: Stream, out: Path, name: str | None) -> Callable[[float | None, float], LoggedRun | Path | None]:
    """Return what makes the place of a stream's log once it begins."""

    def place(settle: float | None, late: float) -> LoggedRun | Path:
        out.mkdir(parents=True, exist_ok=True)
        if stream.file is not None:
            return _free(out, stream.name, ".mcap")
        begun = _later(str(stream.run.get("start_utc", "")), late)
        folder = out / name if name is not None else _free(out, stream.name, "")
        return LoggedRun(folder, stream, begun, settle)

    return place


def _free(out: Path, name: str, suffix: str) -> Path:
    """Return a path that does not exist yet."""
    for number in range(1, 100_000):
        path = out / f"{name}{'' if number == 1 else f'_{number}'}{suffix}"
        if not path.exists() and not path.with_name(f"{path.name}.part").exists():
            return path
    raise StoreError(f"{out} holds too many runs called {name}; give another --out")


def _later(start: str, seconds: float) -> str:
    """Return a time in UTC so many seconds after another, or now where that is none."""
    try:
        told = datetime.fromisoformat(start)
    except ValueError:
        told = datetime.now(UTC)
    found = (told.astimezone(UTC) + timedelta(seconds=seconds)).replace(tzinfo=None)
    text = found.isoformat(timespec="milliseconds" if found.microsecond else "seconds")
    return f"{text}Z"


def _rows(t: np.ndarray, values: np.ndarray, channel: Channel) -> np.ndarray:
    """Return samples as messages; those before the run began are none."""
    rows = np.zeros(len(t), numpy_dtype("vines.v1.SensorSample"))
    rows["t"], rows["value"] = t, values
    rows["valid"] = 1 if channel.range is None else np.abs(values) < _FULL * channel.range * abs(channel.factor)
    return rows[t >= 0]
