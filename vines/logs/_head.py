"""Which descriptions of a damaged log can be believed: metadata, attachments, schemas and channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from mcap import records

from vines.logs._channels import BALLS, CONTENT, DIGESTS, KINDS, OURS, SAMPLE, STATUS, Channel
from vines.logs._checked import NUMBERS, described, vouched
from vines.logs._digests import digest_of, trusted
from vines.logs._salvage import Piece, Salvage
from vines.schema import wire_format

__all__ = ["Head", "head_of"]

_TWICE = (SAMPLE, "foxglove.FrameTransforms")
"""Schemas that a log holds under several numbers; older logs keep the digest of the last one only."""
_MADE_ANEW = (DIGESTS, CONTENT, STATUS)


@dataclass
class Head:
    """The intact descriptions of a file, and which were lost.

    Attributes
    ----------
    metadata, attachments : dict of str
        By name.
    schemas, channels : dict of int
        By their numbers in the file.
    status : dict of str to str
        What the status of the log says; no digest covers it.
    digests, contents : dict of str to str
        The digests of records and of content, if they are intact.
    unverified : list of str
        Records for which nothing vouches.
    lost : list of str
        Records that were there and are not intact.
    """

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, records.Attachment] = field(default_factory=dict)
    schemas: dict[int, records.Schema] = field(default_factory=dict)
    channels: dict[int, records.Channel] = field(default_factory=dict)
    status: dict[str, str] = field(default_factory=dict)
    digests: dict[str, str] = field(default_factory=dict)
    contents: dict[str, str] = field(default_factory=dict)
    unverified: list[str] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)

    @property
    def ours(self) -> bool:
        """Whether vines wrote the log, and something of what it said about the log is left."""
        return bool(self.digests or self.status) or any(name.startswith(OURS) for name in self.metadata)

    def written(self, topic: str) -> int | None:
        """Return how many messages the status counts on a topic, if it says so."""
        count = self.status.get(topic, "")
        return int(count) if count.isdecimal() else None

    def describes(self, number: int) -> bool:
        """Return whether a channel is described, with the schema that it names."""
        channel = self.channels.get(number)
        return channel is not None and (channel.schema_id == 0 or channel.schema_id in self.schemas)


def head_of(found: Salvage) -> Head:
    """Return the descriptions that a checksum or a digest vouches for; where the file has none, all of them."""
    head = Head()
    entries = [piece.record for piece in found.pieces if isinstance(piece.record, records.Metadata)]
    head.status = next((each.metadata for each in entries if each.name == STATUS), {})
    for name, into in ((DIGESTS, head.digests), (CONTENT, head.contents)):
        into.update(next((d for each in entries if each.name == name and (d := trusted(name, each.metadata))), {}))
    good = set(head.digests.values())
    _records(found, head, good)
    native = _native(found, head, good)
    _descriptions(found, head, good, native)
    if native:
        _anew(found, head, good)
        held = {digest_of(each) for each in (*head.schemas.values(), *head.channels.values())}
        head.lost += [
            name
            for name, digest in head.digests.items()
            if name.startswith(("schema ", "channel ")) and digest not in held
        ]
    return head


def _native(found: Salvage, head: Head, good: set[str]) -> bool:
    """Return whether numbers are those of the digests; in a file that was rewritten they are others.

    The header alone does not tell, since some programs keep it.
    """
    channels = [(piece.record, piece.checked) for piece in found.pieces if isinstance(piece.record, records.Channel)]
    checked = [channel for channel, is_checked in channels if is_checked]
    if found.library != "vines" or checked:
        return found.library == "vines" and all(digest_of(channel) in good for channel in checked)
    schemas = {piece.record.id: piece.record for piece in found.pieces if isinstance(piece.record, records.Schema)}
    return not any(
        digest_of(channel) not in good and described(channel, schemas.get(channel.schema_id), good, head.contents)
        for channel, _ in channels
    )


def _records(found: Salvage, head: Head, good: set[str]) -> None:
    """Take metadata and attachments."""
    for piece in found.pieces:
        record = piece.record
        if not isinstance(record, (records.Metadata, records.Attachment)) or record.name in _MADE_ANEW:
            continue
        if head.digests and not vouched(record, good):
            continue
        if not head.digests:
            head.unverified.append(record.name)
        if isinstance(record, records.Metadata):
            head.metadata[record.name] = record.metadata
        else:
            head.attachments[record.name] = record
    head.lost += [
        name
        for name in head.digests
        if not name.startswith(("schema ", "channel ")) and name not in head.metadata and name not in head.attachments
    ]


def _descriptions(found: Salvage, head: Head, good: set[str], native: bool) -> None:
    """Take schemas and channels, what has a checksum first."""
    described_by = [piece for piece in found.pieces if isinstance(piece.record, (records.Schema, records.Channel))]
    checked = [piece for piece in described_by if piece.checked]
    rest = [piece for piece in described_by if not piece.checked]
    _take(head, checked)
    if not head.digests:
        head.unverified += [_name(piece) for piece in rest]
        _take(head, rest)
        return
    _take(head, [piece for piece in rest if digest_of(piece.record) in good])
    if native:
        _take(head, [piece for piece in rest if _twice(piece, good)])
        return
    loose = Head()
    _take(loose, rest)
    for number, channel in loose.channels.items():
        schema = head.schemas.get(channel.schema_id, loose.schemas.get(channel.schema_id))
        if number not in head.channels and described(channel, schema, good, head.contents):
            head.channels[number] = channel
            if schema is not None:
                head.schemas[schema.id] = schema


def _take(head: Head, pieces: Sequence[Piece]) -> None:
    """Take descriptions whose numbers are free; of two that differ neither can be believed."""
    for kind, into in ((records.Schema, head.schemas), (records.Channel, head.channels)):
        new: dict[int, list[records.Schema | records.Channel]] = {}
        for piece in pieces:
            record = piece.record
            if isinstance(record, kind) and record.id not in into and record not in new.get(record.id, []):
                new.setdefault(record.id, []).append(record)
        into.update({number: each[0] for number, each in new.items() if len(each) == 1})  # type: ignore[arg-type]


def _twice(piece: Piece, good: set[str]) -> bool:
    """Return whether a schema is equal to one that is vouched for under another number."""
    schema = piece.record
    return (
        isinstance(schema, records.Schema)
        and schema.name in _TWICE
        and any(digest_of(replace(schema, id=number)) in good for number in NUMBERS)
    )


def _anew(found: Salvage, head: Head, good: set[str]) -> None:
    """Describe channels of vines of which nothing is left but digest and messages, if both fit."""
    for channel in (*KINDS.values(), *BALLS):
        number = channel.number
        encoding, data = channel.described()
        schema = records.Schema(id=number, data=data, encoding=encoding, name=channel.message)
        topic = records.Channel(
            id=number,
            topic=channel.topic,
            message_encoding=channel.encoding,
            metadata=dict(channel.metadata),
            schema_id=number,
        )
        taken = head.describes(number) or channel.topic in {
            each.topic for key, each in head.channels.items() if key != number
        }
        if not taken and {digest_of(schema), digest_of(topic)} <= good and _fits(found, channel):
            head.schemas[number], head.channels[number] = schema, topic


def _fits(found: Salvage, channel: Channel) -> bool:
    """Return whether every message on a channel's number is laid out as vines lays out its message."""
    layout = wire_format(channel.message)
    blank = np.frombuffer(layout.blank, np.uint8)
    for message in (*found.checked, *found.loose):
        if int.from_bytes(message[9:11], "little") == channel.number:
            raw = np.frombuffer(message, np.uint8)[31:]
            if len(raw) != len(blank) or (raw[layout.tags] != blank[layout.tags]).any():
                return False
    return True


def _name(piece: Piece) -> str:
    record = piece.record
    if isinstance(record, records.Channel):
        return f"channel {record.topic}"
    return f"schema {record.name}" if isinstance(record, records.Schema) else record.name
