"""Salvage a damaged or unfinished log into a new file, and say exactly what was saved and what was lost."""

from __future__ import annotations

import hashlib
import os
import struct
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import numpy as np
from mcap.writer import MCAP0_MAGIC

from vines.errors import ChunkError, LogError, LogVersionError
from vines.logs._account import account
from vines.logs._channels import PROVENANCE, RECOVERED
from vines.logs._chunk import repacked
from vines.logs._contents import Messages
from vines.logs._file import LogFile
from vines.logs._head import Head, head_of
from vines.logs._pack import CHUNK_BYTES
from vines.logs._read import Log, assemble, bytes_of_file, unfit
from vines.logs._salvage import Salvage, salvage
from vines.logs._unpack import CHUNK_LIMIT, Unpacker
from vines.logs._walk import Found, walk
from vines.logs._write import replacing

__all__ = ["Recovery", "read_damaged", "recover"]


@dataclass(frozen=True)
class Recovery:
    """What became of a damaged log.

    Attributes
    ----------
    path : Path
        The new file.
    saved : tuple of str
        What is in it, one line each.
    lost : tuple of str
        What is not, one line each; empty if everything was there and only an index or the end was damaged.
    """

    path: Path
    saved: tuple[str, ...]
    lost: tuple[str, ...]


@dataclass(frozen=True)
class _Saved:
    """A new log in the making: its bytes, read back and compared, and what is told of it."""

    data: bytes
    saved: tuple[str, ...]
    lost: tuple[str, ...]
    every_message: bool


def recover(
    path: str | os.PathLike[str], out: str | os.PathLike[str] | None = None, *, max_chunk: int = CHUNK_LIMIT
) -> Recovery:
    """Salvage a damaged or unfinished MCAP file into a new one.

    Only what its own checksum vouches for is taken: whole chunks by their CRC, provenance, parameters and
    descriptions by the SHA-256 that a log of vines holds of each. A message that is intact and cannot be read, such as
    one that does not fit its schema, is set aside, counted and named, and the others are saved. The new file is read
    back and compared with what was taken before it gets its name. The damaged file is not touched.

    Parameters
    ----------
    path : path-like
        The damaged file; any MCAP file will do, but what has no checksum is marked as unverified.
    out : path-like, optional
        The new file; ``<name>.recovered.mcap`` beside the damaged one if left out. It must not exist.
    max_chunk : int
        As in :func:`vines.logs.read`.

    Returns
    -------
    Recovery

    Raises
    ------
    FileMissingError
        If there is no such file, or no such folder.
    LogError
        If the file is intact (rewritten or filtered by another program too), is no MCAP file, or holds no intact
        message; if `out` exists; or if what was saved does not read back as it was.
    """
    file = Path(path)
    data = bytes_of_file(file)
    target = _target(file) if out is None else Path(out)
    if os.path.lexists(target):
        raise LogError(f"{target} exists and is not overwritten; name another file with --out")
    made = _salvaged(file, data, _complaint(file, data, max_chunk), max_chunk)
    with replacing(target) as stream:
        stream.write(made.data)
        stream.flush()
        if Path(stream.name).read_bytes() != made.data:
            raise LogError(f"{target} does not read back as it was written; is the disk sound?")
    return Recovery(target, made.saved, made.lost)


def read_damaged(path: str | os.PathLike[str], *, max_chunk: int = CHUNK_LIMIT) -> Log:
    """Return what `recover` would make of a damaged log of which every message is left; nothing is written.

    Raises
    ------
    FileMissingError
        If there is no such file.
    LogError
        As :func:`vines.logs.read`, if messages are lost or nobody counted them.
    """
    file = Path(path)
    data = bytes_of_file(file)
    try:
        return assemble(file, data, max_chunk)
    except (ChunkError, LogVersionError):
        raise
    except LogError as damaged:
        try:
            made = _salvaged(file, data, damaged, max_chunk)
        except LogError:
            raise damaged from None
        if not made.every_message:
            raise
        lost = "; ".join(made.lost) or "nothing but an index or the end mark"
        remarks = (f"damaged, shown as `vines recover` would save it; lost: {lost}",)
        return replace(assemble(file, made.data, max_chunk), remarks=remarks)


def _target(file: Path) -> Path:
    name = file.name.removesuffix(".part").removesuffix(".mcap")
    return file.with_name(f"{name}.recovered.mcap")


def _complaint(file: Path, data: bytes, max_chunk: int) -> LogError:
    """Return why a log cannot be read; refuse one that can."""
    try:
        log = assemble(file, data, max_chunk)
    except LogVersionError as other:
        raise LogError(f"{file} is intact, there is nothing to recover; {other}") from None
    except LogError as complaint:
        return complaint
    agree = log.remarks[0] if log.kind != "foreign" and log.remarks else "its checksums and its SHA-256 agree"
    raise LogError(f"{file} is intact: {agree}, there is nothing to recover")


def _salvaged(file: Path, data: bytes, complaint: LogError, max_chunk: int) -> _Saved:
    """Return what is intact in the bytes of a file as a new log, once that reads back as what was taken."""
    if sum(a == b for a, b in zip(data, MCAP0_MAGIC, strict=False)) < len(MCAP0_MAGIC) - 2:
        raise LogError(f"{file} is not an MCAP file (it begins with {data[:8]!r}); nothing can be recovered")
    found = salvage(data, Unpacker(len(data), max_chunk))
    head = head_of(found)
    messages, unverified, doubled = _believed(found, head)
    if not messages:
        if isinstance(complaint, ChunkError):
            raise complaint
        reason = "no message is intact" if head.channels else "no description of a channel is intact"
        raise LogError(f"{file}: {reason} in {len(data)} bytes, nothing can be recovered; make the run again")
    note = {"from": file.name, "sha256": hashlib.sha256(data).hexdigest()}
    aside: dict[bytes, str] = {}
    while True:
        told = account(found, head, messages, unverified, aside)
        lost = (*told.lost, f"{doubled} messages that stand in the file before, to the byte") if doubled else told.lost
        kept = [message for message in messages if message not in aside]
        stream = BytesIO()
        _write(LogFile(stream, profile=found.profile), note, head, kept, told.saved, lost)
        made = stream.getvalue()
        back = _compare(file, made, head, kept, max_chunk)
        try:
            assemble(file, made, max_chunk)
        except LogError as refused:
            strange = unfit(file, back)
            aside |= strange
            if not strange or len(aside) == len(set(messages)):
                raise LogError(f"{refused}; what is intact cannot be read either, so nothing is written") from None
        else:
            # A foreign file counts nothing: it has every message if it is whole but for those that are set aside.
            whole = not head.ours and found.ended and not found.lost and len(lost) == told.aside
            return _Saved(made, told.saved, lost, told.every_message or whole)


def _by_channel(messages: Sequence[bytes]) -> dict[int, Messages]:
    """Return message records by their channels."""
    every: defaultdict[int, Messages] = defaultdict(Messages)
    alike: defaultdict[tuple[int, int], list[int]] = defaultdict(list)
    for place, message in enumerate(messages):
        alike[_channel(message), len(message)].append(place)
    for (number, size), places in alike.items():
        block = np.frombuffer(b"".join(messages[place] for place in places), np.uint8).reshape(-1, size)
        every[number].blocks.append(block)
        every[number].places.append(np.array(places, np.int64))
    return every


def _believed(found: Salvage, head: Head) -> tuple[list[bytes], Counter[bytes], int]:
    """Return the messages that can be taken, in order of time, those nothing vouches for, and how many were twice.

    A checksum vouches for those in chunks, or else the digest of the whole channel. Those without either are taken from
    a file that holds no digests, and from a log of vines only if it was cut and nothing else is wrong with it: then
    record follows record up to the cut. Where no digest tells how often a message was written, those that are equal to
    the byte, time included, are one: damage copies what stands in a file.
    """
    checked, loose = (
        [message for message in group if head.describes(_channel(message))] for group in (found.checked, found.loose)
    )
    fitting = _fitting(head, [*checked, *loose]) if head.ours and loose else set()
    if head.ours and not found.only_cut:
        loose = [message for message in loose if _channel(message) in fitting]
    doubled = 0
    if not head.ours:
        doubled = len(loose) - len(loose := list(dict.fromkeys(loose)))
    unverified = Counter(message for message in loose if _channel(message) not in fitting)
    return sorted([*checked, *loose], key=_time_and_sequence), unverified, doubled


def _fitting(head: Head, messages: Sequence[bytes]) -> set[int]:
    """Return the channels whose messages are what the digest of their content says."""
    return {
        number
        for number, each in _by_channel(messages).items()
        if head.contents.get(head.channels[number].topic)
        == each.digest(head.channels[number], head.schemas.get(head.channels[number].schema_id))
    }


def _channel(message: bytes) -> int:
    return int.from_bytes(message[9:11], "little")


def _time_and_sequence(message: bytes) -> tuple[int, int]:
    sequence, time = struct.unpack_from("<IQ", message, 11)
    return time, sequence


def _write(
    log: LogFile,
    note: dict[str, str],
    head: Head,
    messages: Sequence[bytes],
    saved: Sequence[str],
    lost: Sequence[str],
) -> None:
    """Write the new file: as the old one, with a record of what happened to it."""
    if head.ours:
        # First, as in every log of vines.
        gone = {"recovered_from": note["from"], "remark": "the provenance of the run was damaged or left out"}
        log.metadata(PROVENANCE, head.metadata.get(PROVENANCE, gone))
    for name, values in head.metadata.items():
        if name != RECOVERED and not (head.ours and name == PROVENANCE):
            log.metadata(name, values)
    log.metadata(RECOVERED, {**note, "saved": "\n".join(saved), "lost": "\n".join(lost) or "nothing"})
    for name, attachment in head.attachments.items():
        log.attachment(name, attachment.media_type, attachment.data)
    for schema in head.schemas.values():
        log.schema(schema)
    described = {number: channel for number, channel in head.channels.items() if head.describes(number)}
    for channel in described.values():
        log.topic(channel)
    log.digests()
    for part in _shares(messages):
        log.chunk(repacked(part))
    if head.ours:
        every = _by_channel(messages)
        counts = {
            channel.topic: str(len(every[number]) if number in every else 0) for number, channel in described.items()
        }
        log.status("recovered", counts)
    log.finish()


def _shares(messages: Sequence[bytes]) -> Iterator[Sequence[bytes]]:
    """Yield the messages in shares of the size of a chunk."""
    start = size = 0
    for place, message in enumerate(messages):
        if size and size + len(message) > CHUNK_BYTES:
            yield messages[start:place]
            start, size = place, 0
        size += len(message)
    yield messages[start:]


def _compare(file: Path, made: bytes, head: Head, messages: Sequence[bytes], max_chunk: int) -> Found:
    """Return what is in a new log; refuse one that does not read back as what was taken, channel by channel."""
    back = walk(file, made, Unpacker(len(made), max(max_chunk, len(made) * 100)))
    taken = _by_channel(messages)
    for number, each in taken.items():
        channel = head.channels[number]
        schema = head.schemas.get(channel.schema_id)
        same = back.topics.get(number) == channel and back.schema(number) == schema
        if not same or back.digest(number) != each.digest(channel, schema):
            raise LogError(
                f"{file}: what was saved on {channel.topic} does not read back as it was; nothing is written"
            )
    if set(back.messages) != set(taken):
        raise LogError(f"{file}: what was saved does not read back as it was; nothing is written")
    return back
