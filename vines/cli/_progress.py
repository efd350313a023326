"""Progress of a run: bars on a terminal, plain lines in a log, nothing when asked."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from vines.pipeline import Event

__all__ = ["Lines", "Quiet", "duration", "progress"]

PAUSE = 2.0
"""Seconds between two plain lines of the same stage."""
SOON = 0.5
"""Seconds of points, without the first, from which the first line tells how long the others take."""


class Quiet:
    """Says nothing."""

    def __enter__(self) -> Quiet:
        return self

    def __exit__(self, *ignored: object) -> None:
        return None

    def __call__(self, event: Event) -> None:
        """Take note of nothing."""
        del event


class Lines(Quiet):
    """A line when a stage starts and ends, and every few seconds in between, with rate and time left."""

    def __init__(self) -> None:
        self._started: dict[str, tuple[float, int]] = {}
        self._measured: dict[str, tuple[float, int]] = {}
        self._told: set[str] = set()
        self._said = 0.0

    def __call__(self, event: Event) -> None:
        """Write a line if there is something new to say."""
        now = time.monotonic()
        match event.what:
            case "waiting":
                click.echo("waiting for another vines run on the same data", err=True)
            case "started":
                self._started[event.stage] = (now, event.done)
                self._said = now
                if event.wanted > 1:
                    click.echo(f"{event.stage}: {event.text}")
            case "progress":
                soon = event.stage in self._measured and event.stage not in self._told
                if now - (self._measured[event.stage][0] if soon else self._said) >= (SOON if soon else PAUSE):
                    self._said = now
                    if soon:
                        self._told.add(event.stage)
                    click.echo(f"{event.stage}: {event.done} of {event.wanted}{self._pace(event, now)}")
                if event.stage not in self._measured:  # the first points took what was imported and compiled as well
                    self._measured[event.stage] = (now, event.done)
            case "done":
                click.echo(f"{event.stage}: done{self._took(event, now)}{_failures(event)}")
            case "failed" | "skipped":
                click.echo(f"{event.stage}: {event.what}: {event.text}", err=True)
            case _:
                pass

    def _pace(self, event: Event, now: float) -> str:
        start, before = self._measured.get(event.stage, (now, event.done))
        fresh = event.done - before
        if fresh <= 0 or now <= start:
            return _failures(event)
        rate = fresh / (now - start)
        return f", {rate:.3g} points/s, {duration((event.wanted - event.done) / rate)} left{_failures(event)}"

    def _took(self, event: Event, now: float) -> str:
        start, _ = self._started.get(event.stage, (now, 0))
        points = f", {event.wanted} points" if event.wanted > 1 else ""
        return f"{points} ({now - start:.1f} s)"


class Bars(Lines):
    """A bar for each stage that is computed."""

    def __init__(self) -> None:
        super().__init__()
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
        from rich.progress import TimeRemainingColumn as Remaining

        self._bars = Progress(
            TextColumn("{task.description:18s}"),
            BarColumn(bar_width=28),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeElapsedColumn(),
            Remaining(),
            TextColumn("{task.fields[note]}"),
        )
        self._tasks: dict[str, Any] = {}

    def __enter__(self) -> Bars:
        self._bars.start()
        return self

    def __exit__(self, *ignored: object) -> None:
        self._bars.stop()

    def __call__(self, event: Event) -> None:
        """Move the bar of the stage."""
        match event.what:
            case "started":
                self._tasks[event.stage] = self._bars.add_task(
                    event.stage, total=event.wanted, completed=event.done, note="", rate=""
                )
            case "progress" | "done" if event.stage in self._tasks:
                completed = event.wanted if event.what == "done" else event.done
                task = self._tasks[event.stage]
                speed = self._bars.tasks[task].speed
                self._bars.update(
                    task,
                    total=event.wanted,  # a refinement adds points
                    completed=completed,
                    note=_failures(event),
                    rate=f"{speed:.3g}/s" if speed and event.wanted > 1 else "",
                )
            case "waiting":
                self._bars.console.print("waiting for another vines run on the same data")
            case "failed" | "skipped":
                self._bars.console.print(f"{event.stage}: {event.what}: {event.text}", markup=False)
            case _:
                pass


def progress(quiet: bool) -> Quiet:
    """Return what shows the progress of a run on this kind of output."""
    if quiet:
        return Quiet()
    return Bars() if sys.stdout.isatty() else Lines()


def duration(seconds: float) -> str:
    """Return a time in the unit in which it is read.

    Examples
    --------
    >>> duration(0.2), duration(18.4), duration(400.0), duration(89099.0), duration(4e6)
    ('0.2 s', '18 s', '6.7 min', '25 h', '46 days')
    """
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.0f} s" if seconds >= 1 else f"{seconds:.1g} s"


def _failures(event: Event) -> str:
    return f", {event.failed} failed" if event.failed else ""
