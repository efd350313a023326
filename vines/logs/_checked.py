"""Is a log of vines what was written? By its bytes, or else by what its records and channels say.

Another program that rewrites a log changes its bytes and its numbers. It is then told from damage by digests of
content: of records whatever the order of their entries, and of channels whatever their numbers. Logs that are older
than the digests of channels have their descriptions checked so, and their messages counted.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from mcap import records

from vines.errors import LogError
from vines.logs._channels import CONTENT, DIGESTS, FIRST_SENSOR, STATUS
from vines.logs._digests import description, digest_of, trusted
from vines.logs._walk import AGAIN, Found

__all__ = ["NUMBERS", "Rewritten", "described", "rewritten", "vouched", "written_counts"]

_ONCE = ("name", "kind", "word", "attractor")
"""The order in which older logs hold the entries of vines.run."""
NUMBERS = (*range(1, 32), *range(FIRST_SENSOR, FIRST_SENSOR + 100))
"""The numbers that vines gives to channels and schemas."""


def written_counts(found: Found) -> dict[str, int]:
    """Return how many messages its writer counted on each topic.

    Raises
    ------
    ValueError
        If a count is no number.
    """
    status = found.metadata.get(STATUS, {})
    return {topic: int(count) for topic, count in status.items() if topic not in ("status", "sha256")}


@dataclass(frozen=True)
class Rewritten:
    """What became of a log that another program rewrote.

    Attributes
    ----------
    whole : bool
        Whether nothing is missing.
    verified : bool
        Whether a digest vouches for the messages, or at least a checksum of the program that rewrote them.
    remarks : tuple of str
        What a reader should know, a line each.
    channels : frozenset of int
        Numbers of the channels that are those of the log; others were added.
    """

    whole: bool
    verified: bool
    remarks: tuple[str, ...]
    channels: frozenset[int]


def rewritten(file: Path, found: Found) -> Rewritten:
    """Check a log whose bytes are not those that vines wrote by what it says.

    Raises
    ------
    LogError
        If something is not what was written.
    """
    unfit = f"{file} is damaged: its SHA-256 does not fit, and"
    good = set(trusted(DIGESTS, found.metadata.get(DIGESTS, {})).values())
    contents = trusted(CONTENT, found.metadata.get(CONTENT, {}))
    if not good:
        raise LogError(f"{unfit} neither do the digests of its records; {AGAIN}")
    if CONTENT in found.metadata and not contents:
        raise LogError(f"{unfit} neither do the digests of its content; {AGAIN}")
    for name, record in _records(found):
        if not vouched(record, good):
            raise LogError(f"{unfit} its record {name} is not what was written; {AGAIN}")
    missing = [name for name in trusted(DIGESTS, found.metadata[DIGESTS]) if _is_record(name) and not _has(found, name)]
    lines = [f"its record {name} is missing" for name in missing]
    ours: set[int] = set()
    counts = written_counts(found)
    if contents and set(counts) != {topic for topic in contents if f"description of {topic}" in contents}:
        raise LogError(f"{unfit} its status counts other channels than those that were written; {AGAIN}")
    for topic, written in counts.items():
        here = [number for number, channel in found.topics.items() if channel.topic == topic]
        fitting = [number for number in here if contents and found.digest(number) == contents.get(topic)]
        if fitting or not here:
            ours |= set(fitting[:1])
            if not here and written:
                lines.append(f"{topic} is missing ({written} messages)")
            continue
        have = sum(map(found.count, here))
        if len(here) > 1 or have > written or (contents and have == written):
            raise LogError(f"{unfit} the messages on {topic} are not those that were written; {AGAIN}")
        if not described(found.topics[here[0]], found.schema(here[0]), good, contents):
            raise LogError(f"{unfit} the description of {topic} is not what was written; {AGAIN}")
        ours.add(here[0])
        if have < written:
            lines.append(f"{topic}: {have} of {written} messages, which of them cannot be checked")
    whole = not lines
    others = [found.topics[number].topic for number in found.topics if number not in ours]
    if others:
        lines.append(f"added to the log and not part of it: {', '.join(others)}")
    by = f"rewritten by {found.library!r}" if found.library else "rewritten by another program"
    checked = "content as written"
    if not contents:
        by_whom = "only checksums of that program vouch" if found.covered else "nothing vouches"
        checked = f"as many messages as written, for whose content {by_whom} (an older log, or one without {CONTENT})"
    remarks = (f"{by}, {checked if whole else 'in part'}", *lines)
    return Rewritten(whole, bool(contents) or found.covered, remarks, frozenset(ours))


def _is_record(name: str) -> bool:
    return not name.startswith(("schema ", "channel "))


def _has(found: Found, name: str) -> bool:
    return name in found.metadata or name in found.attachments


def _records(found: Found) -> Iterator[tuple[str, records.Metadata | records.Attachment]]:
    """Yield the records that stand before the channels."""
    known = trusted(DIGESTS, found.metadata[DIGESTS])
    for name, values in found.metadata.items():
        if name in known:
            yield name, records.Metadata(name=name, metadata=values)
    for name, attachment in found.attachments.items():
        if name in known:
            yield name, attachment


def vouched(record: records.Metadata | records.Attachment, good: Collection[str]) -> bool:
    """Return whether a record is what was written, whatever the order of its entries or its times are now."""
    if isinstance(record, records.Metadata):
        values = record.metadata
        orders = (values, sorted(values), sorted(values, key=_once))
        return any(digest_of(replace(record, metadata={key: values[key] for key in order})) in good for order in orders)
    return digest_of(record) in good or digest_of(replace(record, create_time=0, log_time=0)) in good


def _once(key: str) -> int:
    return _ONCE.index(key) if key in _ONCE else len(_ONCE)


def described(
    channel: records.Channel, schema: records.Schema | None, good: Collection[str], contents: Mapping[str, str]
) -> bool:
    """Return whether a channel and its schema are described as they were, whatever their numbers are now.

    Parameters
    ----------
    channel, schema : mcap.records.Channel, mcap.records.Schema
        As they stand in the file.
    good : collection of str
        The digests of records that the log holds.
    contents : mapping of str to str
        Those of its content; empty in an older log.
    """
    if contents:
        return description(channel, schema) == contents.get(f"description of {channel.topic}")
    return (
        schema is not None
        and any(digest_of(replace(schema, id=number)) in good for number in NUMBERS)
        and any(digest_of(replace(channel, id=number, schema_id=number)) in good for number in NUMBERS)
    )
