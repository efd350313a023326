"""When this process imported a module: what was changed in its file since then, the process does not run.

Light, and set up by ``import vines`` itself, before anything that computes is imported.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from types import ModuleType

__all__ = ["imported_at"]

_BEGAN = time.time_ns()
_TIMES: dict[str, int] = {}


class _Witness:
    """A finder that finds nothing: it is asked first, and writes down when."""

    def find_spec(self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> None:
        """Take note of an import, or of one more by ``importlib.reload``."""
        del path, target
        _TIMES[name] = time.time_ns()


def imported_at(module: str) -> int:
    """Return when the import of a module began, in nanoseconds since the epoch.

    For a module that was there before vines it is when vines was imported.

    Examples
    --------
    >>> imported_at("vines.errors") <= time.time_ns()
    True
    """
    return _TIMES.get(module, _BEGAN)


sys.meta_path.insert(0, _Witness())
