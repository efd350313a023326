"""Ids of many points at once: twenty hexadecimal digits each, kept as ten bytes, found by their order."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["BYTES", "Ids"]

BYTES = 10
_BLOCK = 2**16
DIGITS = 2 * BYTES


class Ids:
    """Ids in a fixed order.

    Parameters
    ----------
    raw : numpy.ndarray of uint8, shape (n, 10)
        The ids as bytes.
    """

    def __init__(self, raw: np.ndarray) -> None:
        self.raw = raw.reshape(-1, BYTES)

    def __len__(self) -> int:
        return len(self.raw)

    @classmethod
    def from_hex(cls, text: str) -> Ids:
        """Return the ids that stand in a text without anything between them.

        Examples
        --------
        >>> Ids.from_hex("00112233445566778899" * 2).hex()
        ['00112233445566778899', '00112233445566778899']
        """
        return cls(np.frombuffer(bytes.fromhex(text), dtype=np.uint8))

    @classmethod
    def of(cls, ids: Iterable[str]) -> Ids:
        """Return ids given one by one."""
        return cls.from_hex("".join(ids))

    @classmethod
    def joined(cls, several: Sequence[Ids]) -> Ids:
        """Return ids one after the other."""
        return cls(np.concatenate([each.raw for each in several]) if several else np.empty((0, BYTES), np.uint8))

    def text(self) -> str:
        """Return all ids in one text."""
        return self.raw.tobytes().hex()

    def hex(self) -> list[str]:
        """Return the ids one by one."""
        text = self.text()
        return [text[i : i + DIGITS] for i in range(0, len(text), DIGITS)]

    def take(self, places: Any) -> Ids:
        """Return the ids at some places."""
        return Ids(self.raw[places])

    def arrow(self) -> pa.Array:
        """Return the ids as an Arrow array of strings."""
        import pyarrow as pa

        offsets = np.arange(len(self) + 1, dtype=np.int32) * DIGITS
        return pa.StringArray.from_buffers(len(self), pa.py_buffer(offsets), pa.py_buffer(self.text().encode()))

    def locate(self, wanted: Ids) -> np.ndarray:
        """Return where each wanted id stands here, the last place if it stands here twice, -1 if nowhere.

        Examples
        --------
        >>> ids = Ids.of(["aa" * 10, "bb" * 10, "aa" * 10])
        >>> ids.locate(Ids.of(["bb" * 10, "cc" * 10, "aa" * 10])).tolist()
        [1, -1, 2]
        """
        found = np.full(len(wanted), -1, dtype=np.int32)
        for start in range(0, len(wanted) if len(self) else 0, _BLOCK):
            found[start : start + _BLOCK] = self._locate(wanted.take(slice(start, start + _BLOCK)))
        return found

    def _locate(self, wanted: Ids) -> np.ndarray:
        order, heads = self._sorted
        sought, rest = wanted._heads, wanted._tails
        at = np.searchsorted(heads, sought, side="right") - 1
        found = np.full(len(wanted), -1, dtype=np.int32)
        open_ends = np.arange(len(wanted))
        tails = self._tails
        # ids that agree in the first eight bytes and differ in the last two are passed by, one a turn
        while len(open_ends):
            open_ends = open_ends[at[open_ends] >= 0]
            open_ends = open_ends[heads[at[open_ends]] == sought[open_ends]]
            here = order[at[open_ends]]
            right = tails[here] == rest[open_ends]
            found[open_ends[right]] = here[right]
            open_ends = open_ends[~right]
            at[open_ends] -= 1
        return found

    @property
    def _heads(self) -> np.ndarray:
        return np.ascontiguousarray(self.raw[:, :8]).view(np.uint64).ravel()

    @cached_property
    def _tails(self) -> np.ndarray:
        return np.ascontiguousarray(self.raw[:, 8:]).view(np.uint16).ravel()

    @cached_property
    def _sorted(self) -> tuple[np.ndarray, np.ndarray]:
        heads = self._heads
        order = np.argsort(heads, kind="stable").astype(np.int32)
        return order, heads[order]
