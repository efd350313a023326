"""Canonical JSON and the keys made of it."""

from __future__ import annotations

import hashlib
import json
from typing import Any

__all__ = ["canonical", "key_of"]

_ENCODER = json.JSONEncoder(sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)


def canonical(form: Any) -> str:
    """Return the one JSON text of plain data: keys sorted, no spaces, floats in their shortest exact form.

    Cast numbers to their type before: ``1`` and ``1.0`` are different texts.

    Examples
    --------
    >>> canonical({"b": 0.1, "a": [1, None]})
    '{"a":[1,null],"b":0.1}'
    """
    return _ENCODER.encode(form)


def key_of(form: Any) -> str:
    """Return the SHA-256 of the canonical JSON, as 64 hexadecimal digits.

    Examples
    --------
    >>> key_of({"A": 0.02})[:12]
    '5c2154459499'
    """
    return hashlib.sha256(canonical(form).encode()).hexdigest()
