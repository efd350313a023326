"""A log that is being written, in the viewer as it grows."""

from __future__ import annotations

import contextlib
import math
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import rerun as rr

from vines.errors import ViewerError
from vines.logs import Tail
from vines.schema import numpy_dtype
from vines.viewer._called import called_in
from vines.viewer._clock import SIM_TIME, Clock
from vines.viewer._curves import curves
from vines.viewer._impacts import lanes
from vines.viewer._layout import Shown, following
from vines.viewer._live import Live, live
from vines.viewer._scene import cavity
from vines.viewer._text import send_impact_log

__all__ = ["follow"]

_LOOK = 0.5
"""Seconds between two looks at the log."""
_SILENT = 10.0
"""Seconds without anything new after which that is told."""
_REACH = 2.0
"""Displacement of the mass for which there is room, b."""


def follow(
    path: str | os.PathLike[str],
    how: str = "window",
    *,
    file: Path | None = None,
    picture: Path | None = None,
    tell: Callable[[str], object] = print,
    seconds: float | None = None,
) -> None:
    """Show a log that is being written as it grows, until its writer has finished it and Ctrl-C comes.

    Parameters
    ----------
    path : path-like
        The log, under the name that it has now (``.part``) or will have.
    how : {"window", "web", "headless", "save"}
        As for :func:`vines.viewer.live`; the last two end with the log.
    file : Path, optional
        The recording, if it is saved.
    picture : Path, optional
        Where a picture goes at the end, without a window.
    tell : callable
        Called with what has to be known, a line each.
    seconds : float, optional
        How long to wait at most.

    Raises
    ------
    FileMissingError
        If there is no such log, finished or being written.
    LogError
        If what is added is damaged.
    ViewerError
        If a run of several balls is followed, or the viewer cannot start.
    """
    until = math.inf if seconds is None else time.monotonic() + seconds
    with contextlib.closing(Tail(path)) as tail, live(how, file=file, tell=tell) as show:
        shown: _Rig | _Run | None = None
        try:
            for added in _added(tail, tell, until):
                if shown is None and tail.kind:
                    shown = _Rig(show, tail) if tail.kind == "rig" else _Run(show, tail)
                if shown is not None and added:
                    shown.add(added)
            if tail.ended:
                tell(f"{tail.path} is finished")
            if picture is not None:
                show.picture(picture)
            while how in ("window", "web") and show.alive and time.monotonic() < until:
                time.sleep(_LOOK)
        except KeyboardInterrupt:
            return


def _added(tail: Tail, tell: Callable[[str], object], until: float) -> Iterator[dict[str, np.ndarray]]:
    """Yield what is added to a log until it ends."""
    last, told = time.monotonic(), False
    while True:
        added = tail.take()
        yield added
        if tail.ended or time.monotonic() > until:
            return
        if added:
            last, told = time.monotonic(), False
        elif time.monotonic() - last > _SILENT and not told:
            told = True
            tell(
                f"{tail.path}: nothing new for {_SILENT:.0f} s; "
                f"if its writer is gone, `vines recover {tail.path}` saves it"
            )
        time.sleep(_LOOK)


class _Rig:
    """The curves of a rig."""

    def __init__(self, show: Live, tail: Tail):
        self._show = show
        labels = {name: f"{about.get('quantity')} [{about.get('unit')}]" for name, about in tail.about.items()}
        rows = "\n".join(f"| {name} | {about} |" for name, about in labels.items())
        show.begin(tail.name, labels, f"### {tail.name}\n\n| | |\n|---|---|\n{rows}")

    def add(self, added: dict[str, np.ndarray]) -> None:
        """Show more samples."""
        for name, rows in added.items():
            if name != "base":
                self._show.samples(name, rows["t"], np.where(rows["valid"] == 1, rows["value"], np.nan))


class _Run:
    """The motion and the curves of a run of one ball."""

    def __init__(self, show: Live, tail: Tail):
        self._show, self._tail = show, tail
        self._rec: rr.RecordingStream | None = None
        self._clock: Clock | None = None
        self._impacts: list[np.ndarray] = []

    def add(self, added: dict[str, np.ndarray]) -> None:
        """Show more states and impacts."""
        if any(key.isdecimal() for key in added):
            raise ViewerError(f"{self._tail.path} is of several balls; such a run is shown once it is finished")
        states = added.get("states")
        impacts = added.get("impacts")
        if self._rec is None and states is not None:
            self._begin(states)
        if impacts is not None:
            self._impacts.append(impacts)
        if self._rec is None or self._clock is None or states is None or not len(states):
            return
        waiting = np.concatenate(self._impacts) if self._impacts else np.empty(0, numpy_dtype("vines.v1.Impact"))
        self._impacts = []
        of_states = {name: states[name] for name in states.dtype.names or ()}
        of_impacts = {name: waiting[name] for name in waiting.dtype.names or ()}
        names = called_in(self._tail.system, self._tail.parameters)
        cavity(self._rec, "/run/cavity", of_states, self._clock, reach=_REACH, walls=names.walls)
        curves(self._rec, "/run", of_states, of_impacts, self._clock, names=names)
        lanes(self._rec, "/run/lanes", of_states, of_impacts, self._clock)
        send_impact_log(self._rec, "/run/impacts", of_impacts, self._clock)
        self._rec.flush()

    def _begin(self, states: np.ndarray) -> None:
        Omega = self._tail.parameters.get("Omega")
        period = 2 * math.pi / (Omega or 1.0)
        times = (0.0, math.inf, 0.0, math.inf)
        names = called_in(self._tail.system, self._tail.parameters)
        moving = {"following": True, "timeline": SIM_TIME, "called": names}
        shown = Shown("/run", self._tail.name, *times, period, _REACH, **moving)
        self._rec = rec = self._show.recording(self._tail.name, following(shown))
        self._clock = Clock(float(states["t"][0]), float(states["phase"][0]), Omega)
        rows = "\n".join(f"| {key} | {value:.10g} |" for key, value in self._tail.parameters.items())
        text = f"### {self._tail.name}\n\n| | |\n|---|---|\n{rows}"
        rec.log("/run/about", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
