"""Find what is intact in the bytes of a damaged MCAP file."""

from __future__ import annotations

import hashlib
import re
import struct
from dataclasses import dataclass, field
from io import BytesIO

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from vines.logs._contents import split
from vines.logs._frames import frames, summary_start
from vines.logs._unpack import Unpacker
from vines.logs._walk import BROKEN, line_of

__all__ = ["Piece", "Salvage", "salvage"]

_HEAD = re.compile(rb"(?=[\x01-\x0f].{5}\x00{3})", re.DOTALL)
"""Where a record may begin: a known opcode and a length below 2^40."""
_IN_A_ROW = 3
"""Records that must follow each other before a place counts as the beginning of one."""


@dataclass(frozen=True)
class Piece:
    """A record of the head of a file: metadata, an attachment, a schema or a channel."""

    opcode: int
    record: records.Metadata | records.Attachment | records.Schema | records.Channel
    checked: bool
    """Whether a checksum of a chunk or of the summary covers it."""


@dataclass
class Salvage:
    """What is intact in a file.

    Attributes
    ----------
    profile, library : str
        Profile and program that the header names.
    pieces : list of Piece
        Metadata, attachments, schemas and channels, in their order.
    checked : list of bytes
        The message records of intact chunks, heads included.
    loose : list of bytes
        Message records that no checksum covers: outside chunks, or in chunks that have none.
    lost : list of (int, int, str)
        First byte, byte after the last, and what was lost there.
    ended : bool
        Whether the end of the data section was found.
    size : int
        Bytes of the file.
    chunks : set of bytes
        Digests of the chunks that were taken.
    taken : int
        Byte after the last record from which something was taken.
    """

    profile: str = ""
    library: str = ""
    pieces: list[Piece] = field(default_factory=list)
    checked: list[bytes] = field(default_factory=list)
    loose: list[bytes] = field(default_factory=list)
    lost: list[tuple[int, int, str]] = field(default_factory=list)
    ended: bool = False
    size: int = 0
    chunks: set[bytes] = field(default_factory=set)
    taken: int = 0

    @property
    def only_cut(self) -> bool:
        """Whether a cut explains all that is wrong: up to it, record follows record from the beginning.

        What was cut off may hold bytes that look like records, from which nothing can be taken.
        """
        return not self.ended and all(start >= self.taken for start, _, _ in self.lost)


_KINDS = {
    Opcode.METADATA: records.Metadata,
    Opcode.ATTACHMENT: records.Attachment,
    Opcode.SCHEMA: records.Schema,
    Opcode.CHANNEL: records.Channel,
}
_TAKEN = frozenset({*_KINDS, Opcode.HEADER, Opcode.CHUNK, Opcode.MESSAGE})
_NAMES: dict[int, str] = {
    Opcode.METADATA: "a metadata record",
    Opcode.ATTACHMENT: "an attachment",
    Opcode.SCHEMA: "a schema",
    Opcode.CHANNEL: "the description of a channel",
    Opcode.CHUNK: "a chunk of messages",
    Opcode.MESSAGE: "a message",
    Opcode.MESSAGE_INDEX: "an index, which is made anew",
    Opcode.HEADER: "the header, which is made anew",
}


def salvage(data: bytes, unpacker: Unpacker) -> Salvage:
    """Go through the bytes of an MCAP file and take what is intact.

    A chunk that the unpacker refuses is lost. Damage inside a record costs that record; damage to its head costs what
    lies before the next place at which records follow each other again.
    """
    found = Salvage(size=len(data))
    at = len(MCAP0_MAGIC)
    while at < len(data) and not found.ended:
        step = _record(data, at)
        if step is None:
            after = _next(data, at + 1)
            what = _NAMES.get(data[at], "a record")
            cut = after is None
            found.lost.append((at, len(data) if cut else after, f"{what}, cut off" if cut else what))
            at = len(data) if after is None else after
            continue
        opcode, end = step
        try:
            _take(found, opcode, data[at + 9 : end], unpacker)
            if opcode in _TAKEN:
                found.taken = end
        except BROKEN as broken:
            found.lost.append((at, end, f"{_NAMES.get(Opcode(opcode), 'a record')} ({line_of(broken)})"))
        at = end
    _from_summary(found, data)
    return found


def _record(data: bytes, at: int) -> tuple[int, int] | None:
    """Return opcode and end of the record at a place, or None if what follows is not a record either."""
    first = _head(data, at)
    if first is None:
        return None
    end = first[1]
    return first if end == len(data) or data[end:] == MCAP0_MAGIC or _head(data, end, whole=False) else None


def _head(data: bytes, at: int, whole: bool = True) -> tuple[int, int] | None:
    if at + 9 > len(data):
        # The rest of a head that was cut off is no damage to the record before it.
        return None if whole else (0, len(data))
    opcode, length = struct.unpack_from("<BQ", data, at)
    if not Opcode.HEADER <= opcode <= Opcode.DATA_END or (whole and at + 9 + length > len(data)):
        return None
    if length >= 1 << 40:
        return None
    return opcode, at + 9 + length


def _next(data: bytes, start: int) -> int | None:
    """Return the first place at which records follow each other again."""
    for match in _HEAD.finditer(data, start):
        at = match.start()
        for _ in range(_IN_A_ROW):
            step = _head(data, at)
            if step is None:
                break
            at = step[1]
            if data[at:] == MCAP0_MAGIC or at == len(data):
                return match.start()
        else:
            return match.start()
    return None


def _take(found: Salvage, opcode: int, body: bytes, unpacker: Unpacker) -> None:
    """Take one record of the data section."""
    stream = ReadDataStream(BytesIO(body))
    if opcode == Opcode.HEADER:
        header = records.Header.read(stream)
        found.profile, found.library = header.profile, header.library
    elif opcode in _KINDS:
        found.pieces.append(_piece(opcode, body, checked=False))
    elif opcode == Opcode.CHUNK:
        # Copied by what damaged the file; its messages were written once.
        digest = hashlib.sha256(body).digest()
        if digest in found.chunks:
            raise ValueError("it stands in the file before")
        chunk = records.Chunk.read(stream)
        inside = unpacker.unpack(chunk)
        places, described = split(inside)
        found.chunks.add(digest)
        checked = chunk.uncompressed_crc != 0
        found.pieces += [_piece(kind, content, checked) for kind, content in described]
        starts = sorted((start, length) for (_, length), group in places.items() for start in group)
        messages = [inside[start : start + 9 + length] for start, length in starts]
        (found.checked if checked else found.loose).extend(messages)
    elif opcode == Opcode.MESSAGE:
        if len(body) < 22:
            raise ValueError("a message record is shorter than its header")
        found.loose.append(struct.pack("<BQ", opcode, len(body)) + body)
    elif opcode == Opcode.DATA_END:
        if len(body) != 4:
            raise ValueError("the end of the data is another")
        found.ended = True


def _piece(opcode: int, body: bytes, checked: bool) -> Piece:
    return Piece(opcode, _KINDS[Opcode(opcode)].read(ReadDataStream(BytesIO(body))), checked)


def _from_summary(found: Salvage, data: bytes) -> None:
    """Add the schemas and channels that an intact summary repeats."""
    place = summary_start(data)
    if place is not None:
        found.pieces += [
            _piece(opcode, body, checked=True)
            for _, opcode, body in frames(data, *place)
            if opcode in (Opcode.SCHEMA, Opcode.CHANNEL)
        ]
