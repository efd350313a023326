"""The log file of a run: what was asked for, what happened when, and how it ended."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import TextIO

from vines.pipeline._events import Event, Report

__all__ = ["Journal"]

_PAUSE = 10.0
"""Seconds between two lines of progress of a stage; a failure is written at once."""


class Journal:
    """Writes events into a file and passes them on. The file is made with the first event that computes something.

    Parameters
    ----------
    folder : Path
        Where the log files of runs are.
    pipeline : str
        Name of the pipeline; stands in the name of the file.
    asked : mapping
        What was asked for.
    report : callable
        Gets the events too.
    """

    def __init__(self, folder: Path, pipeline: str, asked: Mapping[str, object], report: Report) -> None:
        self._folder = folder
        self._pipeline = pipeline
        self._asked = {key: value for key, value in asked.items() if value not in (None, False, (), {}, "", "local")}
        self._report = report
        self._stream: TextIO | None = None
        self._said = 0.0
        self._failed: dict[str, int] = {}

    @property
    def path(self) -> Path | None:
        """The file; None if nothing was written."""
        return None if self._stream is None else Path(self._stream.name)

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._stream is None:
            return
        said = "done" if error is None else ("stopped" if isinstance(error, KeyboardInterrupt) else f"ended: {error}")
        self._write(said)
        self._stream.close()

    def __call__(self, event: Event) -> None:
        """Write an event down if it says something new, and pass it on."""
        counted = f"{event.done} of {event.wanted}" + (f", {event.failed} failed" if event.failed else "")
        match event.what:
            case "started":
                self._write(f"{event.stage}: started, {counted} there: {event.text}")
                self._failed[event.stage] = event.failed
            case "progress":
                fresh = event.failed > self._failed.get(event.stage, 0)
                if fresh or time.monotonic() - self._said > _PAUSE:
                    why = f": {event.text}" if fresh and event.text else ""
                    self._write(f"{event.stage}: {counted}, {event.jobs} at work{why}")
                    self._failed[event.stage] = event.failed
            case "done" | "failed" | "skipped":
                self._write(f"{event.stage}: {event.what}, {counted}" + (f": {event.text}" if event.text else ""))
            case "waiting":
                self._write("waiting for another run on the same data")
            case _:
                pass
        self._report(event)

    def _write(self, text: str) -> None:
        if self._stream is None:
            self._stream = self._open()
        self._said = time.monotonic()
        self._stream.write(f"{datetime.now().astimezone().isoformat(timespec='milliseconds')} {text}\n")
        self._stream.flush()

    def _open(self) -> TextIO:
        from vines.store import versions

        self._folder.mkdir(parents=True, exist_ok=True)
        stamp = datetime.now().astimezone().strftime("%Y%m%dT%H%M%S")
        path = self._folder / f"{stamp}-{self._pipeline}-{os.getpid()}.log"
        stream = path.open("w", encoding="utf-8")
        asked = " ".join(f"{key}={value}" for key, value in self._asked.items())
        packages = ", ".join(f"{name} {version}" for name, version in versions().items())
        stream.write(f"run {self._pipeline} {asked}\n{packages}, on {platform.node()}, process {os.getpid()}\n")
        return stream
