"""Ctrl-C, and the SIGTERM of a batch system, end a command at once, in one line that says how to go on."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator
from types import FrameType

import click

__all__ = ["STOPPED", "stoppable", "stopped"]

STOPPED = 130
"""Exit code of a shell command that SIGINT ended."""
_PATIENCE = 0.6


def stopped(remedy: str) -> str:
    """Return the line that tells of a stop.

    Examples
    --------
    >>> stopped("'vines run fig4' goes on")
    "vines: stopped; what is finished is kept, 'vines run fig4' goes on"
    >>> stopped("")
    'vines: stopped'
    """
    return f"vines: stopped; what is finished is kept, {remedy}" if remedy else "vines: stopped"


def _leave_soon() -> None:
    """End the process even if threads of executors and clusters would take seconds to say goodbye."""

    def leave() -> None:
        time.sleep(_PATIENCE)
        os._exit(STOPPED)

    threading.Thread(target=leave, daemon=True).start()


@contextlib.contextmanager
def stoppable(remedy: str, *, silent: bool = False) -> Iterator[None]:
    """Turn SIGTERM into the same as Ctrl-C, and end with one line instead of a traceback.

    Parameters
    ----------
    remedy : str
        How to go on; see `stopped`.
    silent : bool
        Whether another process tells of the stop.
    """

    def stop(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    except (KeyboardInterrupt, click.exceptions.Abort):
        if not silent:
            click.echo(stopped(remedy), err=True)
        _leave_soon()
        raise SystemExit(STOPPED) from None
    finally:
        signal.signal(signal.SIGTERM, before)
