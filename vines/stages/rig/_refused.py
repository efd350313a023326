"""Why one run cannot be used, in a line, so that the others go on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from vines.errors import VinesError

__all__ = ["reason_of", "told_of"]


def reason_of(error: Exception) -> str:
    """Return the reason for a row of a run, in one line.

    Examples
    --------
    >>> reason_of(ZeroDivisionError("division by zero"))
    'unexpected ZeroDivisionError: division by zero'
    """
    text = " ".join(str(error).split())
    return text if isinstance(error, VinesError) else f"unexpected {type(error).__name__}: {text}"


def told_of(folder: Path) -> dict[str, Any]:
    """Return what the ``run.json`` of a run that cannot be used says, as far as it can be read."""
    try:
        told = json.loads((folder / "run.json").read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return told if isinstance(told, dict) else {}
