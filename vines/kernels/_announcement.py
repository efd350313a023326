"""One line where kernels have to be compiled, so that nobody waits without knowing for what."""

from __future__ import annotations

import logging
import os
from pathlib import Path

__all__ = ["announce", "expected"]

_log = logging.getLogger("vines.kernels")
_said: list[bool] = []


def announce(folder: Path) -> None:
    """Say once a process that kernels are being compiled, on the log ``vines.kernels``; not if VINES_QUIET is set.

    Parameters
    ----------
    folder : Path
        Where they are kept.
    """
    if not _said and not os.environ.get("VINES_QUIET"):
        _log.warning(
            "vines: compiling kernels, some ten seconds for each kind of task and only once; kept in %s", folder
        )
    _said.append(True)


def expected() -> None:
    """Note that whoever called has said so already."""
    _said.append(True)
