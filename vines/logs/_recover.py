"""Salvage a damaged or unfinished log into a new file, and say exactly what was saved and what was lost."""

from __future__ import annotations

import hashlib
import os
import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap import records
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from vines.errors import FileMissingError, LogError
from vines.logs._channels import DIGESTS, KINDS, PROVENANCE, RECOVERED, STATUS
from vines.logs._chunk import repacked
from vines.logs._file import LogFile, digest_of, trusted
from vines.logs._pack import CHUNK_BYTES
from vines.logs._read import read
from vines.logs._salvage import Piece, Salvage, salvage
from vines.logs._write import replacing

__all__ = ["Recovery", "recover"]


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


def recover(path: str | os.PathLike[str], out: str | os.PathLike[str] | None = None) -> Recovery:
    """Salvage a damaged or unfinished MCAP file into a new one.

    Only what its own checksum vouches for is taken: whole chunks by their CRC, provenance, parameters and
    descriptions by the SHA-256 that a log of vines holds of each. The damaged file is not touched.

    Parameters
    ----------
    path : path-like
        The damaged file; any MCAP file will do, but what has no checksum is marked as unverified.
    out : path-like, optional
        The new file; ``<name>.recovered.mcap`` beside the damaged one if left out. It must not exist.

    Returns
    -------
    Recovery

    Raises
    ------
    FileMissingError
        If there is no such file, or no such folder.
    LogError
        If the file is intact, is no MCAP file, or holds no intact message; or if `out` exists.
    """
    file = Path(path)
    if not file.is_file():
        raise FileMissingError(f"{file}: there is no such file")
    target = _target(file) if out is None else Path(out)
    if target.exists():
        raise LogError(f"{target} exists and is not overwritten; name another file with --out")
    if _intact(file):
        raise LogError(f"{file} is intact: its checksums and its SHA-256 agree, there is nothing to recover")
    data = file.read_bytes()
    if sum(a == b for a, b in zip(data, MCAP0_MAGIC, strict=False)) < len(MCAP0_MAGIC) - 2:
        raise LogError(f"{file} is not an MCAP file (it begins with {data[:8]!r}); nothing can be recovered")
    found = salvage(data)
    head = _Head(found)
    messages = list(_described(found, head))
    if not messages:
        reason = "no message is intact" if head.channels else "no description of a channel is intact"
        raise LogError(f"{file}: {reason} in {len(data)} bytes, nothing can be recovered; make the run again")
    counts = Counter(struct.unpack_from("<H", message, 9)[0] for message in messages)
    saved, lost = _account(found, head, counts, messages, len(data))
    with replacing(target) as stream:
        _write(stream, file, found, head, messages, counts, saved, lost)
    return Recovery(target, tuple(saved), tuple(lost))


def _target(file: Path) -> Path:
    name = file.name.removesuffix(".part").removesuffix(".mcap")
    return file.with_name(f"{name}.recovered.mcap")


def _intact(file: Path) -> bool:
    try:
        read(file)
    except LogError as refused:
        # Files of other people, and of other versions of vines, are intact though vines cannot decode them.
        return "cannot decode" in str(refused) or "another version" in str(refused)
    return True


class _Head:
    """The intact descriptions of a file, and which were lost."""

    def __init__(self, found: Salvage):
        self.metadata: dict[str, dict[str, str]] = {}
        self.attachments: dict[str, records.Attachment] = {}
        self.schemas: dict[int, records.Schema] = {}
        self.channels: dict[int, records.Channel] = {}
        self.unverified: list[str] = []
        self.lost: list[str] = []
        everything = [piece.record for piece in found.pieces if isinstance(piece.record, records.Metadata)]
        self.status = next((each.metadata for each in everything if each.name == STATUS), {})
        self.digests = next((d for each in everything if each.name == DIGESTS and (d := trusted(each.metadata))), {})
        good = set(self.digests.values())
        seen: set[str] = set()
        for piece in found.pieces:
            digest = digest_of(piece.data())
            seen.add(digest)
            name = _name(piece)
            if not piece.checked and self.digests and digest not in good and name not in (DIGESTS, STATUS):
                continue
            if not piece.checked and not self.digests and name not in (DIGESTS, STATUS):
                self.unverified.append(name)
            self._take(piece)
        self._rebuild(good - seen)
        held = {digest_of(piece.data()) for piece in self._pieces()}
        self.lost += [name for name, digest in self.digests.items() if digest not in held]

    @property
    def ours(self) -> bool:
        """Whether vines wrote the file."""
        return bool(self.digests or self.status) or any(each.name in KINDS for each in self.schemas.values())

    def _take(self, piece: Piece) -> None:
        record = piece.record
        if isinstance(record, records.Metadata):
            if record.name not in (DIGESTS, STATUS):
                self.metadata[record.name] = record.metadata
        elif isinstance(record, records.Attachment):
            self.attachments[record.name] = record
        elif isinstance(record, records.Schema):
            self.schemas[record.id] = record
        else:
            self.channels[record.id] = record

    def _rebuild(self, missing: set[str]) -> None:
        """Make descriptions of our own channels anew where the digest says that they are what was there."""
        for channel in KINDS.values():
            encoding, data = channel.described()
            schema = records.Schema(id=channel.number, data=data, encoding=encoding, name=channel.message)
            topic = records.Channel(
                id=channel.number,
                topic=channel.topic,
                message_encoding=channel.encoding,
                metadata=dict(channel.metadata),
                schema_id=channel.number,
            )
            for opcode, record in ((Opcode.SCHEMA, schema), (Opcode.CHANNEL, topic)):
                piece = Piece(opcode, record, checked=True)
                if digest_of(piece.data()) in missing:
                    self._take(piece)

    def _pieces(self) -> Iterator[Piece]:
        for name, values in self.metadata.items():
            yield Piece(Opcode.METADATA, records.Metadata(name=name, metadata=values), checked=True)
        for kind, group in (
            (Opcode.ATTACHMENT, self.attachments),
            (Opcode.SCHEMA, self.schemas),
            (Opcode.CHANNEL, self.channels),
        ):
            for record in group.values():
                yield Piece(kind, record, checked=True)


def _name(piece: Piece) -> str:
    record = piece.record
    if isinstance(record, records.Channel):
        return f"channel {record.topic}"
    if isinstance(record, records.Schema):
        return f"schema {record.name}"
    return record.name


def _described(found: Salvage, head: _Head) -> Iterator[bytes]:
    """Yield the messages whose channel is described."""
    for group in (*found.chunks, _loose(found, head)):
        for message in group:
            (number,) = struct.unpack_from("<H", message, 9)
            channel = head.channels.get(number)
            if channel is not None and (channel.schema_id == 0 or channel.schema_id in head.schemas):
                yield message


def _loose(found: Salvage, head: _Head) -> list[bytes]:
    """Return the messages without checksum; a writer that keeps digests writes none, so there they are noise."""
    return [] if head.digests else found.loose


def _account(
    found: Salvage, head: _Head, counts: Counter[int], messages: list[bytes], size: int
) -> tuple[list[str], list[str]]:
    """Return in words what is saved and what is lost."""
    saved: list[str] = []
    lost: list[str] = []
    spans: dict[int, tuple[int, int]] = {}
    for message in messages:
        number, time = struct.unpack_from("<H4xQ", message, 9)
        first, last = spans.get(number, (time, time))
        spans[number] = (min(first, time), max(last, time))
    for number, channel in head.channels.items():
        have, written = counts[number], head.status.get(channel.topic)
        span = f", t {spans[number][0] / 1e9:.6g} to {spans[number][1] / 1e9:.6g}" if have else ""
        of = f" of {written}" if written is not None else ""
        saved.append(f"{channel.topic}: {have}{of} messages{span}")
        if written is not None and str(have) != written:
            lost.append(f"{channel.topic}: {int(written) - have} of {written} messages")
    loose = len(_loose(found, head))
    undescribed = sum(map(len, found.chunks)) + loose - len(messages)
    if undescribed:
        lost.append(f"{undescribed} messages whose channel is no longer described")
    kept = [*head.metadata, *head.attachments]
    if kept:
        doubt = [name for name in kept if name in head.unverified]
        saved.append(f"records: {', '.join(kept)}" + (f" (unverified: {', '.join(doubt)})" if doubt else ""))
    lost += [f"record {name}: its SHA-256 does not fit, or it is gone" for name in head.lost]
    lost += [f"bytes {start} to {end - 1}: {what}" for start, end, what in found.lost]
    if not found.ended:
        count = "" if head.status else "; how many messages followed is not known"
        lost.append(f"the end of the file, after byte {size - 1}{count}")
    if loose:
        saved.append(f"{loose} of the messages have no checksum: they are unverified")
    return saved, lost


def _write(
    stream: BinaryIO,
    file: Path,
    found: Salvage,
    head: _Head,
    messages: list[bytes],
    counts: Counter[int],
    saved: list[str],
    lost: list[str],
) -> None:
    """Write the new file: as the old one, with a record of what happened to it."""
    log = LogFile(stream, profile=found.profile)
    if head.ours:
        # First, as in every log of vines.
        gone = {"recovered_from": file.name, "remark": "the provenance of the run was damaged"}
        log.metadata(PROVENANCE, head.metadata.get(PROVENANCE, gone))
    for name, values in head.metadata.items():
        if name != RECOVERED and not (head.ours and name == PROVENANCE):
            log.metadata(name, values)
    note = {
        "from": file.name,
        "sha256": hashlib.sha256(file.read_bytes()).hexdigest(),
        "saved": "\n".join(saved),
        "lost": "\n".join(lost) or "nothing",
    }
    log.metadata(RECOVERED, note)
    for name, attachment in head.attachments.items():
        log.attachment(name, attachment.media_type, attachment.data)
    for schema in head.schemas.values():
        log.schema(schema)
    for channel in head.channels.values():
        if channel.schema_id == 0 or channel.schema_id in head.schemas:
            log.topic(channel)
    log.digests()
    for part in _shares(messages):
        log.chunk(repacked(part))
    if head.ours:
        log.status("recovered", {head.channels[number].topic: str(count) for number, count in counts.items()})
    log.finish()


def _shares(messages: list[bytes]) -> Iterator[list[bytes]]:
    """Yield the messages in shares of the size of a chunk."""
    share: list[bytes] = []
    size = 0
    for message in messages:
        if share and size + len(message) > CHUNK_BYTES:
            yield share
            share, size = [], 0
        share.append(message)
        size += len(message)
    yield share
