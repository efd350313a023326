"""Ctrl-C, and the SIGTERM of a batch system, end a run at once and say how to go on."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator
from types import FrameType

import click

from vines.cli._supervised import STOPPED, is_supervised

__all__ = ["stoppable"]

_PATIENCE = 0.6


def _leave_soon() -> None:
    """End the process even if threads of executors and clusters would take seconds to say goodbye."""

    def leave() -> None:
        time.sleep(_PATIENCE)
        os._exit(STOPPED)

    threading.Thread(target=leave, daemon=True).start()


@contextlib.contextmanager
def stoppable(remedy: str) -> Iterator[None]:
    """Turn SIGTERM into the same as Ctrl-C, and end with one line instead of a traceback.

    Parameters
    ----------
    remedy : str
        How to go on.
    """

    def stop(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    except KeyboardInterrupt:
        if not is_supervised():
            click.echo(f"vines: stopped; what is finished is kept, {remedy}", err=True)
        _leave_soon()
        raise SystemExit(STOPPED) from None
    finally:
        signal.signal(signal.SIGTERM, before)
