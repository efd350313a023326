"""What a salvaged log holds and what it lacks, in words."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from vines.errors import printable
from vines.logs._head import Head
from vines.logs._salvage import Salvage

__all__ = ["UNVERIFIED", "Account", "account"]

UNVERIFIED = "unverified"
"""What is said of messages that are saved though nothing vouches for them."""


@dataclass(frozen=True)
class Account:
    """What was saved and what was lost, a line each.

    Attributes
    ----------
    saved, lost : tuple of str
        The lines.
    every_message : bool
        Whether every message that was counted is there.
    aside : int
        How many of the lines on what was lost tell of messages that are set aside.
    """

    saved: tuple[str, ...]
    lost: tuple[str, ...]
    every_message: bool
    aside: int


def account(
    found: Salvage, head: Head, messages: Sequence[bytes], unverified: Mapping[bytes, int], aside: Mapping[bytes, str]
) -> Account:
    """Return in words what is saved and what is lost.

    Parameters
    ----------
    found : Salvage
        What is intact in the file.
    head : Head
        Its descriptions that can be believed.
    messages : sequence of bytes
        The message records that can be believed.
    unverified : mapping of bytes to int
        Those of them that nothing vouches for, and how often each is there.
    aside : mapping of bytes to str
        Those of them that are not saved because they cannot be read, and what each does in the place of that.
    """
    saved, lost = _channels(head, [message for message in messages if message not in aside])
    strange = _aside(head, [message for message in messages if message in aside], aside)
    lost += strange
    # Without any count the messages that are missing are not known.
    every_message = bool(head.status) and found.ended and not lost
    undescribed = sum(not head.describes(_channel(message)) for message in found.checked)
    if undescribed:
        lost.append(f"{undescribed} messages whose channel is no longer described")
    left = len(found.checked) + len(found.loose) - undescribed - len(messages)
    if left:
        lost.append(f"{left} messages for which no checksum and no digest vouches")
    kept = [*head.metadata, *head.attachments]
    if kept:
        doubt = [name for name in kept if name in head.unverified]
        saved.append(f"records: {', '.join(kept)}" + (f" (unverified: {', '.join(doubt)})" if doubt else ""))
    lost += [f"record {name}: its SHA-256 does not fit, or it is gone" for name in head.lost]
    lost += [f"bytes {start} to {end - 1}: {what}" for start, end, what in found.lost]
    if not found.ended:
        count = "" if head.status else "; how many messages followed is not known"
        lost.append(f"the end of the file, after byte {found.size - 1}{count}")
    doubtful = sum(count for message, count in unverified.items() if message not in aside)
    if doubtful:
        saved.append(f"{doubtful} of the messages have no checksum: they are {UNVERIFIED}")
    return Account(tuple(map(printable, saved)), tuple(map(printable, lost)), every_message, len(strange))


def _aside(head: Head, messages: Sequence[bytes], why: Mapping[bytes, str]) -> list[str]:
    """Return a line a channel of the messages that are set aside."""
    by_channel: dict[int, list[bytes]] = {}
    for message in messages:
        by_channel.setdefault(_channel(message), []).append(message)
    return [
        f"{head.channels[number].topic}: {len(each)} messages that {why[each[0]]}, the first at t {_time(each[0]):.6g}"
        for number, each in by_channel.items()
    ]


def _time(message: bytes) -> float:
    return struct.unpack_from("<Q", message, 15)[0] / 1e9


def _channel(message: bytes) -> int:
    return int.from_bytes(message[9:11], "little")


def _channels(head: Head, messages: Sequence[bytes]) -> tuple[list[str], list[str]]:
    """Return a line a channel of what is saved, and of what is lost."""
    times: dict[int, list[int]] = {}
    for message in messages:
        number, time = struct.unpack_from("<H4xQ", message, 9)
        times.setdefault(number, []).append(time)
    saved: list[str] = []
    lost: list[str] = []
    for number, channel in head.channels.items():
        if not head.describes(number):
            continue
        own = times.get(number, [])
        written = head.written(channel.topic)
        span = f", t {min(own) / 1e9:.6g} to {max(own) / 1e9:.6g}" if own else ""
        of = f" of {written}" if written is not None else ""
        saved.append(f"{channel.topic}: {len(own)}{of} messages{span}")
        if written is not None and len(own) != written:
            lost.append(f"{channel.topic}: {written - len(own)} of {written} messages")
    here = {channel.topic for number, channel in head.channels.items() if head.describes(number)}
    for topic in head.status:
        written = head.written(topic)
        if topic.startswith("/") and topic not in here and written:
            lost.append(f"{topic}: {written} of {written} messages, its description is gone")
    return saved, lost
