"""The lines of a text by which its layout is found: many of its beginning, some of its end."""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["COMMENTS", "Lines", "take_lines", "whole_lines"]

COMMENTS = ("#", "%", "//")
"""What a comment begins with. A semicolon does, too, in some files, but it parts cells in more."""

_BEGINNING = 3000
_END = 24
_END_BYTES = 1 << 18
_BEGINS = tuple(mark.encode() for mark in COMMENTS)
_SEPARATED = re.compile(rb"[,;|\t]|[ ]+")


@dataclass(frozen=True, slots=True)
class Lines:
    """Lines of a text.

    Attributes
    ----------
    first : tuple of str
        The beginning.
    last : tuple of str
        Lines of the end that hold something and are no comments; all of a short text.
    """

    first: tuple[str, ...]
    last: tuple[str, ...]


def whole_lines(text: bytes) -> tuple[bytes, str]:
    r"""Return a text that ends with a line end, and what was cut off: half a row of a recorder that was switched off.

    A last line without a line end is whole if it has as many separators as the line before, and its last cell is not
    shorter than all before it.

    Examples
    --------
    >>> whole_lines(b"0.0,1.25\n0.1,1.5"), whole_lines(b"0.0,1.25\n0.1,1.50"), whole_lines(b"0,1\n1")
    ((b'0.0,1.25\n', '0.1,1.5'), (b'0.0,1.25\n0.1,1.50\n', ''), (b'0,1\n', '1'))
    """
    if text.endswith(b"\n"):
        return text, ""
    body, end, last = text.rpartition(b"\n")
    if not last.strip():
        return body + end, ""
    before = [line for line in body[-_END_BYTES:].split(b"\n")[-_END:] if line.strip()]
    if not before:
        return text + b"\n", ""
    parts, others = _SEPARATED.split(last.strip()), [_SEPARATED.split(line.strip()) for line in before]
    whole = len(parts) == len(others[-1]) and len(parts[-1]) >= min(len(other[-1]) for other in others)
    return (text + b"\n", "") if whole else (body + end, last.decode("utf-8", "replace"))


def take_lines(text: bytes) -> Lines:
    r"""Return lines of a text.

    Examples
    --------
    >>> take_lines(b"# a note\nt,x\n\n0,1\n")
    Lines(first=('# a note', 't,x', '', '0,1'), last=('t,x', '0,1'))
    """
    # A long text is not copied for the sake of its first lines.
    place = 0
    for _ in range(_BEGINNING):
        end = text.find(b"\n", place)
        if end < 0:
            break
        place = end + 1
    first = text[:place].removesuffix(b"\n").split(b"\n")
    # The piece at the end may begin within a line.
    tail = text[-_END_BYTES:].split(b"\n")[len(text) > _END_BYTES :]
    last = [line.decode() for line in tail if line.strip() and not line.lstrip().startswith(_BEGINS)]
    return Lines(tuple(line.decode() for line in first), tuple(last[-_END:]))
