"""JSON objects that lie in the store as files, read so that whatever stands there instead is told in one line."""

from __future__ import annotations

import errno
import json
from pathlib import Path
from typing import Any

__all__ = ["is_lasting", "read_object"]

_LASTING = frozenset({errno.EISDIR, errno.ELOOP, errno.ENOENT, errno.ENOTDIR})


def is_lasting(error: OSError) -> bool:
    """Whether something else stands in the place of a file; any other refusal of the system may pass."""
    return error.errno in _LASTING


def read_object(path: Path) -> dict[str, Any]:
    """Return the JSON object in a file.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it does not hold one object; one line.
    """
    try:
        form = json.loads(path.read_bytes().decode("utf-8"))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    if not isinstance(form, dict):
        raise ValueError(f"it holds a {type(form).__name__} where an object should stand")
    return form
