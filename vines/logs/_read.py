"""Read a log: all of it, checked, or a :class:`~vines.errors.LogError`.

Every checksum of the file is compared (data section, chunks, summary, and the SHA-256 in the log's own status, or else
the digests of its content), so a log that was cut or altered is never half read. Messages are decoded many equal ones
at a time; what was packed otherwise (by another writer of the same schema) goes through protobuf.
"""

from __future__ import annotations

import os
import stat
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from mcap import records

from vines.errors import FileMissingError, LogError, LogVersionError, printable
from vines.logs._account import UNVERIFIED
from vines.logs._channels import (
    BALL,
    BALL_TOPIC,
    CHANNELS,
    KINDS,
    OF_BALLS,
    PARAMETERS,
    PROVENANCE,
    RECOVERED,
    RUN,
    SAMPLE,
    SENSOR,
    STATUS,
    Channel,
)
from vines.logs._checked import rewritten, written_counts
from vines.logs._contents import Messages
from vines.logs._decode import differing_fields, table
from vines.logs._foreign import foreign_tables, is_readable, why_unfit
from vines.logs._raw import RAW, RAW_SAMPLES, Raw, raw_of
from vines.logs._unpack import CHUNK_LIMIT, Unpacker
from vines.logs._walk import AGAIN, BROKEN, Found, line_of, walk
from vines.model import VI_NES

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Log", "assemble", "bytes_of_file", "read", "unfit"]


@dataclass(frozen=True)
class Log:
    """A run as read from its log.

    Attributes
    ----------
    path : Path
        The file.
    name : str
        What the run is called.
    kind : str
        ``"run"`` of the simulator, ``"orbit"`` (one period of one), ``"rig"``, or ``"foreign"`` for an MCAP file that
        vines did not write.
    states, impacts, sticks : pyarrow.Table
        Columns as the fields of ``vines.v1.State``, ``Impact`` and ``Stick``, dimensionless; each column's
        metadata holds its ``unit`` and ``description``. Of several balls the states are those of the oscillator
        (``vines.v1.Oscillator``), and impacts and sticks have the number of the ``ball``.
    balls : dict of int to pyarrow.Table
        Of several balls the states of each (``vines.v1.Ball``) by its number from 1, at the times of `states`.
    nes, orbits, base : pyarrow.Table
        The same of ``vines.v1.Nes``, a mass on a spring beside the ball at the times of `states`, ``Orbit`` and, in SI
        units, ``BaseMotion``; without rows in most logs.
    sensors : dict of str to pyarrow.Table
        Samples of each sensor of a rig (``vines.v1.SensorSample``), SI; the table's metadata say what was measured.
    raw : dict of str to Raw
        Channels of the recorder as it gave them, at their full rate, where a run was watched.
    others : dict of str to pyarrow.Table
        Channels that are not of vines, by topic, the log time in nanoseconds first.
    encodings : dict of str to str
        Encoding of each channel that is not of vines, by topic, decoded or not.
    provenance : dict of str to str
        Where the numbers come from; what was not text is JSON.
    parameters : dict of str to float
        The parameters of the model.
    word : str
        The word of an orbit, else empty.
    attractor : str
        What the run settles to, if its writer knew.
    system : str
        The system of the run.
    declaration : str or None
        The TOML text that declared the run.
    status : str
        ``"complete"`` for a run that its writer finished, ``"recovered"`` for one that ``vines recover`` salvaged,
        ``"filtered"`` if another program took something out, ``"unverified"`` if one rewrote it without checksums,
        ``"unknown"`` where vines did not write the file.
    recovered : dict of str to str
        What was saved and what was lost, for a salvaged log.
    remarks : tuple of str
        What a reader should know, a line each: what another program did to the log, what is missing, which channels
        could not be decoded. Empty for a log as vines wrote it.
    sha256 : str
        Digest of the file.
    """

    path: Path
    name: str
    kind: str
    states: pa.Table
    impacts: pa.Table
    sticks: pa.Table
    balls: dict[int, pa.Table]
    nes: pa.Table
    orbits: pa.Table
    base: pa.Table
    sensors: dict[str, pa.Table]
    raw: dict[str, Raw]
    others: dict[str, pa.Table]
    encodings: dict[str, str]
    provenance: dict[str, str]
    parameters: dict[str, float]
    word: str
    attractor: str
    system: str
    declaration: str | None
    status: str
    recovered: dict[str, str]
    remarks: tuple[str, ...]
    sha256: str

    @property
    def complete(self) -> bool:
        """Whether the writer finished the run."""
        return self.status == "complete"


def read(path: str | os.PathLike[str], *, max_chunk: int = CHUNK_LIMIT) -> Log:
    """Read a log whole.

    Parameters
    ----------
    path : path-like
        An MCAP file. Of one that vines did not write, the channels in protobuf and JSON become the tables `others`;
        what cannot be decoded is named in `remarks`.
    max_chunk : int
        Bytes to which a chunk of the file may unpack, and the file if that is more than a hundred times its size.

    Raises
    ------
    FileMissingError
        If there is no such file.
    LogError
        If it is damaged, cut short or unfinished, if a message does not fit its schema, or if it is no regular file.
    ChunkError
        If a chunk unpacks to more than `max_chunk`, or is compressed in a way that is not known.
    LogVersionError
        If it was written with another version of the schema.
    """
    file = Path(path)
    return assemble(file, bytes_of_file(file), max_chunk)


def bytes_of_file(file: Path) -> bytes:
    """Return the content of a regular file; a folder, a pipe or a link without an end is told as that.

    Raises
    ------
    FileMissingError
        If there is nothing of that name.
    LogError
        If it is no regular file, or cannot be read.
    """
    try:
        mode = file.stat().st_mode
        if stat.S_ISREG(mode):
            return file.read_bytes()
    except FileNotFoundError:
        raise FileMissingError(
            f"there is no log {printable(str(file))}: there is no such file; "
            '`vines query "select path from logs"` lists the known ones'
        ) from None
    except OSError as refused:
        raise LogError(f"{file} cannot be read ({refused.strerror}); name an MCAP file") from None
    kinds = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe (FIFO)", stat.S_IFSOCK: "a socket"}
    raise LogError(f"{file} is {kinds.get(stat.S_IFMT(mode), 'a device')} and no MCAP file; name the file itself")


def assemble(file: Path, data: bytes, max_chunk: int = CHUNK_LIMIT) -> Log:
    """Return the log in the bytes of a file, once everything that it should hold has been found; errors as `read`."""
    found = walk(file, data, Unpacker(len(data), max_chunk))
    try:
        known = _known(file, found)
        tables = {number: table(found.messages[number], channel) for number, channel in known.items()}
        return _log(file, found, _checked(file, found, known), tables)
    except LogError:
        raise
    except BROKEN as broken:
        raise LogError(f"{file} is damaged ({line_of(broken)}); {AGAIN}") from broken


def unfit(file: Path, found: Found) -> dict[bytes, str]:
    """Return the message records of a file that cannot be read, and what each does in the place of that."""
    known = _known(file, found)
    strange: dict[bytes, str] = {}
    for number, messages in found.messages.items():
        topic, schema = found.topics[number], found.schema(number)
        if number not in known and not is_readable(topic):
            continue
        for message in messages.in_order():
            alone = Messages([np.frombuffer(message, np.uint8).reshape(1, -1)], [np.zeros(1, np.int64)])
            why = _why_unfit(alone, known[number]) if number in known else why_unfit(topic, schema, alone)
            if why:
                strange[message] = why
    return strange


def _why_unfit(message: Messages, channel: Channel) -> str:
    """Return why a message of vines cannot be read; empty if it can."""
    try:
        table(message, channel)
    except BROKEN as broken:
        return f"do not fit their schema ({line_of(broken)})"
    return ""


def _known(file: Path, found: Found) -> dict[int, Channel]:
    """Return the channels that carry messages of vines; refuse a schema that differs from ours."""
    known: dict[int, Channel] = {}
    for number, topic in found.topics.items():
        schema = found.schema(number)
        if schema is None or topic.message_encoding != "protobuf":
            continue
        if schema.name == SAMPLE:
            known[number] = Channel(
                number, topic.topic, SAMPLE, "t", topic.topic.removeprefix(SENSOR), dict(topic.metadata)
            )
        elif schema.name == BALL and (ball := topic.topic.removeprefix(BALL_TOPIC)).isdecimal():
            known[number] = Channel(number, topic.topic, BALL, "t", ball)
        elif schema.name in KINDS:
            known[number] = KINDS[schema.name]
        else:
            continue
        differing = differing_fields(schema.data, schema.name)
        if differing:
            raise LogVersionError(
                f"{file} was written with another version of {schema.name} (it lacks or changes "
                f"{', '.join(differing)}); read it with the vines that wrote it"
            )
    return known


@dataclass(frozen=True)
class _Verdict:
    """What checking said: status and remarks of a log, its channels of vines, and those that are decoded as foreign."""

    status: str
    remarks: tuple[str, ...]
    known: dict[int, Channel]
    others: dict[int, records.Channel]


def _checked(file: Path, found: Found, known: dict[int, Channel]) -> _Verdict:
    """Return what a log is, once it is known to be whole or what of it is missing."""
    if PROVENANCE not in found.metadata and STATUS not in found.metadata:
        # Of two channels of one kind none is the run's.
        keys = Counter((channel.message, channel.key) for channel in known.values())
        alone = {number: each for number, each in known.items() if keys[each.message, each.key] == 1}
        twice = sorted({found.topics[number].topic for number in known.keys() - alone.keys()})
        lines = [f"several channels hold the same kind of message, so each is a table of its own: {', '.join(twice)}"]
        others = {number: topic for number, topic in found.topics.items() if number not in alone}
        return _Verdict("unknown", tuple(lines if twice else ()), alone, others)
    status = found.metadata.get(STATUS, {}).get("status", "")
    if status not in ("complete", "recovered"):
        raise LogError(f"{file} is incomplete: its writer did not finish it (no {STATUS} = complete); {AGAIN}")
    if found.sha_fits is False:
        what = rewritten(file, found)
        belonging = {number: channel for number, channel in known.items() if number in what.channels}
        others = {number: topic for number, topic in found.topics.items() if number not in what.channels}
        status = status if what.verified else "unverified"
        return _Verdict(status if what.whole else "filtered", what.remarks, belonging, others)
    counts = written_counts(found)
    for number in known:
        topic = found.topics[number].topic
        if counts.get(topic, found.count(number)) != found.count(number):
            raise LogError(f"{file} is damaged: {found.count(number)} of {counts[topic]} messages on {topic}; {AGAIN}")
    if found.metadata.get(RUN, {}).get("kind", "run") != "rig" and status == "complete":
        several = any(channel in OF_BALLS for channel in known.values())
        for channel in OF_BALLS if several else CHANNELS:
            if channel not in known.values():
                raise LogError(f"{file} has no channel of {channel.message}; {AGAIN}")
    return _Verdict(status, (), known, {})


def _kind(found: Found, known: dict[int, Channel], about: dict[str, str]) -> str:
    """Return the kind of a log: as it says, or by its channels where that was lost."""
    if PROVENANCE not in found.metadata and STATUS not in found.metadata:
        return "foreign"
    if "kind" in about:
        return about["kind"]
    messages = {channel.message for channel in known.values()}
    if SAMPLE in messages or "vines.v1.BaseMotion" in messages:
        return "rig"
    return "orbit" if "vines.v1.Orbit" in messages else "run"


def _log(file: Path, found: Found, verdict: _Verdict, tables: dict[int, pa.Table]) -> Log:
    """Return the log."""
    about, known = found.metadata.get(RUN, {}), verdict.known
    kind = _kind(found, known, about)
    others, of_others = foreign_tables(file, verdict.others, found)
    salvaged = found.metadata.get(RECOVERED, {})
    remarks = [*verdict.remarks, *of_others]
    if salvaged:
        remarks.append(f"recovered; lost: {'; '.join(salvaged.get('lost', '').splitlines())}")
        remarks += [line for line in salvaged.get("saved", "").splitlines() if line.endswith(f"are {UNVERIFIED}")]
    try:
        parameters = {key: float(text) for key, text in found.metadata.get(PARAMETERS, {}).items()}
    except ValueError as unfit:
        raise LogError(f"{file} holds a parameter that is no number ({unfit}); {AGAIN}") from None
    declaration = found.attachments.get("declaration.toml") if kind != "foreign" else None
    of_message = {channel.message: tables[number] for number, channel in known.items()}
    return Log(
        path=file,
        name=about.get("name", file.stem),
        kind=kind,
        provenance=found.metadata.get(PROVENANCE, {}),
        parameters=parameters,
        word=about.get("word", ""),
        attractor=about.get("attractor", ""),
        system=about.get("system", VI_NES.name),
        declaration=None if declaration is None else declaration.data.decode(),
        status=verdict.status,
        recovered=salvaged,
        remarks=tuple(printable(line) for line in remarks),
        sensors={channel.key: tables[number] for number, channel in known.items() if channel.message == SAMPLE},
        raw=_raw(found),
        others=others,
        encodings={topic.topic: topic.message_encoding for topic in verdict.others.values()},
        sha256=found.sha256,
        balls=dict(
            sorted((int(channel.key), tables[number]) for number, channel in known.items() if channel.message == BALL)
        ),
        **{
            channel.key: of_message[message] if message in of_message else table(Messages(), channel)
            for message, channel in KINDS.items()
            if channel not in OF_BALLS or message in of_message
        },
    )


def _raw(found: Found) -> dict[str, Raw]:
    """Return the raw samples that a file holds, by the names of their channels."""
    return {
        topic.topic.removeprefix(RAW): raw_of(found.messages.get(number, Messages()), topic.metadata)
        for number, topic in sorted(found.topics.items())
        if (schema := found.schema(number)) is not None
        and (schema.name, topic.message_encoding) == (RAW_SAMPLES, "protobuf")
    }
