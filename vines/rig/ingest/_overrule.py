"""What ``channels.tsv`` overrules of a file, each with its reason."""

from __future__ import annotations

from vines.errors import RigError, nearest

__all__ = ["OVERRULED", "Overruling"]

OVERRULED = ("unit", "fs", "t0")
"""What may be overruled: the columns in which the right value stands."""


class Overruling:
    """The reasons of a row, and what they were used for.

    Parameters
    ----------
    text : str
        Cell of the column ``overrule``: ``KEY: reason``, several parted by semicolons.

    Raises
    ------
    RigError
        If there is no such key, or no reason.

    Examples
    --------
    >>> found = Overruling("unit: the task was named before the scale; fs: wf_increment is 1")
    >>> found.take("fs", "the file says 1 Hz, 2048 is taken"), found.take("t0", "")
    (True, False)
    >>> found.used
    ['fs: the file says 1 Hz, 2048 is taken: wf_increment is 1']
    """

    def __init__(self, text: str) -> None:
        self.reasons: dict[str, str] = {}
        self.used: list[str] = []
        for part in filter(str.strip, text.split(";")):
            key, _, reason = (piece.strip() for piece in part.partition(":"))
            if key not in OVERRULED:
                raise RigError(f"overrule {part.strip()!r}: it is KEY: reason, and KEY is {nearest(key, OVERRULED)}")
            if not reason:
                raise RigError(f"overrule {part.strip()!r}: write the reason behind {key}:")
            self.reasons[key] = reason

    def take(self, key: str, what: str) -> bool:
        """Say whether something may be overruled, and note what was."""
        if key in self.reasons:
            self.used.append(f"{key}: {what}: {self.reasons[key]}")
        return key in self.reasons
