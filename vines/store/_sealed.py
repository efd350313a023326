"""Text whose first line is the digest of the rest: what was damaged is not taken for what was written."""

from __future__ import annotations

import hashlib
import uuid
from pathlib import Path

__all__ = ["read_sealed", "write_sealed"]


def write_sealed(path: Path, text: str) -> None:
    """Replace a file that can be made again; atomic, and not made durable.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.parent / f".{path.name}.{uuid.uuid4().hex[:12]}"
    try:
        temporary.write_text(f"{_digest(text)}\n{text}", encoding="utf-8")
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def read_sealed(path: Path) -> str | None:
    """Return the text of a file that :func:`write_sealed` wrote; None if it is not there or not as it was written."""
    try:
        seal, _, text = path.read_bytes().decode("utf-8").partition("\n")
    except (OSError, UnicodeDecodeError):
        return None
    return text if seal == _digest(text) else None


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
