"""A share of the points of a stage, for jobs that know nothing of each other."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vines.errors import DeclarationError

if TYPE_CHECKING:
    import numpy as np

__all__ = ["Shard"]

_STRIPES = 16
"""Stripes of the grid that each shard takes: many, as neighbours take equally long; few, so that parts stay whole."""


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several equal shares.

    Attributes
    ----------
    number, count : int
        Which one, from 1, of how many.
    """

    number: int
    count: int

    @classmethod
    def read(cls, text: str) -> Shard:
        """Read ``i/n``.

        Raises
        ------
        DeclarationError
            If it is not of that form, or i is not one of 1 to n.

        Examples
        --------
        >>> Shard.read("2/4")
        Shard(number=2, count=4)
        """
        found = re.fullmatch(r"(\d+)/(\d+)", text.strip())
        if found is None or not 1 <= int(found[1]) <= int(found[2]):
            raise DeclarationError(f"--shard {text!r} is not i/n with 1 <= i <= n, such as 1/4")
        return cls(int(found[1]), int(found[2]))

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def mine(self, total: int) -> np.ndarray:
        """Return for each of so many points, or chains, whether it belongs to this share."""
        import numpy as np

        length = max(1, total // (_STRIPES * self.count))
        return np.arange(total) // length % self.count == self.number - 1
