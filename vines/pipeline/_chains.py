"""Identities along a carried chain. Without numpy: a status may need one of them."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

__all__ = ["carried_id"]

_DIGITS = 20


def carried_id(before: str, names: Sequence[str], values: Sequence[float]) -> str:
    """Return the id of a carried point: SHA-256 of its predecessor's id and its varied values.

    Parameters
    ----------
    before : str
        Id of the predecessor, or the identity of the point of another stage that starts the chain, or empty.
    names : sequence of str
        The axes, in the order of their names.
    values : sequence of float
        The varied values.
    """
    text = ",".join(f'"{name}":{value!r}' for name, value in zip(names, values, strict=True))
    return hashlib.sha256(f'{{"after":"{before}","values":{{{text}}}}}'.encode()).hexdigest()[:_DIGITS]
