"""A command in a child process, so that signals end it within a second.

Python runs the handler of a signal between two of its own instructions, and a kernel or a query may go on for hours. So
the process that a user started only waits, passes signals on, and ends what does not end by itself.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path
from types import FrameType

from vines.cli._interrupt import STOPPED, stopped

__all__ = ["PATIENCE", "go_on_in_a_child", "is_supervised"]

PATIENCE = 0.8
"""Seconds that a command has after a signal; those that Python hears end in less."""
_SET_DEATH_SIGNAL = 1
"""``PR_SET_PDEATHSIG`` of prctl(2)."""
_WAITING: set[int] = set()
"""The process that waits for this one, if one does."""


def is_supervised() -> bool:
    """Whether another process waits for this one and tells that it was stopped."""
    return os.getppid() in _WAITING


def go_on_in_a_child(remedy: str, *, patience: float = PATIENCE) -> None:
    """Return in a child process; the process that calls ends here, with the exit code of the child.

    Parameters
    ----------
    remedy : str
        What the line that tells of a stop says beside that; see `stopped`.
    patience : float
        Seconds that the child has after a signal.

    Notes
    -----
    Where the child cannot be made to die with its parent, which takes Linux, everything stays in one process.
    """
    if sys.platform != "linux":
        return
    parent = os.getpid()
    heard = {signal.SIGINT, signal.SIGTERM, signal.SIGCHLD}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, heard)
    child = os.fork()
    if child:
        code = _wait(child, heard, patience)
        if code == STOPPED:
            shown = "\x1b[?25h" if sys.stderr.isatty() else ""  # a progress bar hides the cursor
            os.write(2, os.fsencode(f"{shown}{stopped(remedy)}\n"))
        os._exit(code)
    _WAITING.add(parent)
    _die_with(parent)
    signal.signal(signal.SIGINT, _once)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _die_with(parent: int) -> None:
    """Let this process be killed when its parent is."""
    import ctypes

    ctypes.CDLL(None).prctl(_SET_DEATH_SIGNAL, signal.SIGKILL)
    if os.getppid() != parent:  # it was killed before that
        os._exit(STOPPED)


def _once(number: int, frame: FrameType | None) -> None:
    """Interrupt the command; a terminal and the parent both tell of one Ctrl-C."""
    del frame
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt


def _wait(child: int, heard: set[signal.Signals], patience: float) -> int:
    """Wait for the child and return its exit code; pass signals on and kill what does not heed them."""
    end = float("inf")
    while True:
        told = signal.sigtimedwait(heard, max(0.0, min(end - time.monotonic(), 3600.0)))
        if told is None and time.monotonic() >= end:
            _kill(child)
            os.waitpid(child, 0)
            return STOPPED
        if told is None:
            continue
        if told.si_signo == signal.SIGCHLD:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                code = os.waitstatus_to_exitcode(status)
                if code < 0 and end != float("inf"):  # it was told to stop before it could hear
                    return STOPPED
                return code if code >= 0 else 128 - code
        elif end == float("inf"):
            end = time.monotonic() + patience
            os.kill(child, told.si_signo)


def _kill(process: int) -> None:
    """Kill a process and what it has started, such as the server of a viewer."""
    try:
        children = Path(f"/proc/{process}/task/{process}/children").read_text("ascii").split()
    except OSError:  # it has just ended
        children = []
    os.kill(process, signal.SIGKILL)
    for child in map(int, children):
        _kill(child)
