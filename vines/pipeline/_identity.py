"""Identities of points that depend on no other: a hash of the varied values, for many points at once.

A point that depends on no other is named by MurmurHash3 (x64, 128 bits) of its values, cut to 80 bits: a hash that
numpy computes for a million points in a fraction of a second. Ten million points of one pool share an identity with a
probability of 4e-11. Pools and results, where a collision would mix up studies, are named by SHA-256.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vines.store import Ids

__all__ = ["free_ids", "murmur"]

_C1 = np.uint64(0x87C37B91114253D5)
_C2 = np.uint64(0x4CF5AD432745937F)


def free_ids(columns: Sequence[np.ndarray]) -> Ids:
    """Return the ids of points that depend on no other.

    Parameters
    ----------
    columns : sequence of numpy.ndarray of float64, shape (n,)
        The varied values, axes in the order of their names.

    Examples
    --------
    >>> free_ids([np.array([0.5, 0.25])]).hex() == [free_ids([np.array([x])]).hex()[0] for x in (0.5, 0.25)]
    True
    """
    from vines.store import Ids

    # adding zero makes one zero of the two that floats have
    words = [np.ascontiguousarray(column + 0.0).view(np.uint64) for column in columns]
    high, low = murmur(words)
    raw = np.empty((len(high), 10), dtype=np.uint8)
    raw[:, :8] = high.astype(">u8")[:, None].view(np.uint8)
    raw[:, 8:] = low.astype(">u8")[:, None].view(np.uint8)[:, :2]
    return Ids(raw)


def murmur(words: Sequence[np.ndarray], seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return MurmurHash3_x64_128 (A. Appleby, public domain) of messages of whole 64-bit words.

    Parameters
    ----------
    words : sequence of numpy.ndarray of uint64, shape (n,)
        First words of all messages, second words, and so on; at least one.
    seed : int
        As in the reference.
    """
    n = len(words[0])
    h1 = np.full(n, seed, dtype=np.uint64)
    h2 = h1.copy()
    pairs = len(words) // 2
    for i in range(pairs):
        h1 ^= _rotate(words[2 * i] * _C1, 31) * _C2
        h1 = (_rotate(h1, 27) + h2) * np.uint64(5) + np.uint64(0x52DCE729)
        h2 ^= _rotate(words[2 * i + 1] * _C2, 33) * _C1
        h2 = (_rotate(h2, 31) + h1) * np.uint64(5) + np.uint64(0x38495AB5)
    if len(words) % 2:
        h1 ^= _rotate(words[-1] * _C1, 31) * _C2
    length = np.uint64(8 * len(words))
    h1 ^= length
    h2 ^= length
    h1 += h2
    h2 += h1
    h1, h2 = _mix(h1), _mix(h2)
    h1 += h2
    h2 += h1
    return h1, h2


def _rotate(x: np.ndarray, bits: int) -> np.ndarray:
    return (x << np.uint64(bits)) | (x >> np.uint64(64 - bits))


def _mix(x: np.ndarray) -> np.ndarray:
    x = (x ^ (x >> np.uint64(33))) * np.uint64(0xFF51AFD7ED558CCD)
    x = (x ^ (x >> np.uint64(33))) * np.uint64(0xC4CEB9FE1A85EC53)
    return x ^ (x >> np.uint64(33))
