"""``vines run --watch``: each motion in the viewer as soon as it is computed."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

if TYPE_CHECKING:
    from vines.pipeline import Event
    from vines.viewer import Live

__all__ = ["Watched", "how_to_watch", "watched"]

_LOOK = 0.2
"""Seconds between two looks whether the window was closed."""


def how_to_watch(*, watch: bool, web: bool, save: Path | None, idle: str) -> Literal["window", "web", "save"] | None:
    """Return how a run is shown, if it is, from the options.

    Parameters
    ----------
    watch, web, save : bool, bool, Path or None
        The options.
    idle : str
        Another option with which nothing is computed that could be shown; empty if there is none.

    Raises
    ------
    click.UsageError
        If they do not go together.
    """
    for option, on in (("--web", web), ("--save", save is not None)):
        if on and not watch:
            raise click.UsageError(f"{option} says where --watch shows motions; give --watch too")
    if web and save is not None:
        raise click.UsageError("--web and --save exclude each other; give one of them")
    if save is not None and save.suffix.lower() != ".rrd":
        raise click.UsageError(f"--save {save}: a recording ends in .rrd, such as {save.with_suffix('.rrd')}")
    if watch and idle:
        raise click.UsageError(f"--watch shows what is computed, and {idle} computes nothing; leave one of them out")
    return None if not watch else "web" if web else "save" if save is not None else "window"


class Watched:
    """Shows the logs that the events of a run bring.

    Parameters
    ----------
    show : Live
        Where.
    tell : callable
        Called with what has to be known, a line each.

    Attributes
    ----------
    count : int
        Motions shown.
    """

    def __init__(self, show: Live, tell: Callable[[str], object]):
        self._show, self._tell = show, tell
        self._lost = False
        self.count = 0

    def __call__(self, event: Event) -> None:
        """Show the logs of an event; that a window was closed keeps no run from going on."""
        from vines.errors import VinesError
        from vines.logs import read

        for path in event.logs:
            if self._lost:
                return
            try:
                if self._show.alive:
                    log = read(path)
                    self._show.show(replace(log, name=f"{event.stage}: {log.name}"))
                    self.count += 1
                    continue
                why = "the viewer was closed"
            except (VinesError, RuntimeError) as error:
                why = str(error)
            self._lost = True
            self._tell(f"{why}; the run goes on without it")

    def stay(self, *, wait: bool) -> None:
        """Say if nothing was shown; else wait, if asked, until the viewer is closed or Ctrl-C comes."""
        if not (self.count or self._lost):
            self._tell("no motion was computed; --watch shows those of stages of the kind trajectory")
            return
        if self._lost or not wait or not self._show.alive:
            return
        self._tell("computed and stored; Ctrl-C ends the viewer")
        with contextlib.suppress(KeyboardInterrupt):
            while self._show.alive:
                time.sleep(_LOOK)


@contextlib.contextmanager
def watched(
    how: Literal["window", "web", "save"] | None, file: Path | None, tell: Callable[[str], object]
) -> Iterator[Watched | None]:
    """Open what shows a run; it ends with the context.

    Raises
    ------
    FileMissingError
        If the folder of `file` does not exist.
    PackageMissingError, ViewerError
        If there is no viewer, or no display.
    """
    if how is None:
        yield None
        return
    from vines.viewer import live

    with live(how, file=file, tell=tell) as show:
        yield Watched(show, tell)
