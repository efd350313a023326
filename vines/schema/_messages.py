"""The messages of a log, from the compiled protobuf descriptors in ``schemas/``.

All fields of our messages have a fixed width, so each message has one length and a numpy structured array is
packed into protobuf (and read back) without touching single values: :func:`wire_format` gives the layout of
such a message, its tags included.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError

from vines.errors import SchemaError, UnknownNameError, nearest
from vines.places import shipped

if TYPE_CHECKING:
    from google.protobuf.message import Message

__all__ = [
    "WireFormat",
    "field_notes",
    "file_descriptor_set",
    "foxglove_schema",
    "message_class",
    "message_names",
    "numpy_dtype",
    "raw_schema",
    "schema_bytes",
    "wire_format",
]

_Field = descriptor_pb2.FieldDescriptorProto

_FIXED: dict[int, tuple[str, int]] = {
    _Field.TYPE_DOUBLE: ("<f8", 1),
    _Field.TYPE_FIXED64: ("<u8", 1),
    _Field.TYPE_SFIXED64: ("<i8", 1),
    _Field.TYPE_FLOAT: ("<f4", 5),
    _Field.TYPE_FIXED32: ("<u4", 5),
    _Field.TYPE_SFIXED32: ("<i4", 5),
}
"""Fixed-width protobuf types: their numpy type and the wire type of their tag."""


@dataclass(frozen=True)
class WireFormat:
    """How a message of fixed length lies in memory.

    Attributes
    ----------
    dtype : numpy.dtype
        The fields of the message at their offsets; the bytes between them are the tags.
    blank : bytes
        A message with all fields zero: the tags in place, as a template.
    tags : numpy.ndarray
        Offsets of the bytes of ``blank`` that are tags, for telling whether foreign bytes have this layout.
    """

    dtype: np.dtype
    blank: bytes
    tags: np.ndarray


@cache
def file_descriptor_set() -> descriptor_pb2.FileDescriptorSet:
    """Return the descriptors of all messages, with their comments.

    Raises
    ------
    FileMissingError
        If the installation is incomplete.
    OSError
        If the system does not let the compiled set be read.
    SchemaError
        If it is damaged.

    Examples
    --------
    >>> [file.name for file in file_descriptor_set().file]
    ['vines/v1/ball.proto', 'vines/v1/ball_impact.proto', 'vines/v1/ball_stick.proto', 'vines/v1/base_motion.proto',
     'vines/v1/impact.proto', 'vines/v1/nes.proto', 'vines/v1/orbit.proto', 'vines/v1/oscillator.proto',
     'vines/v1/sensor_sample.proto', 'vines/v1/state.proto', 'vines/v1/stick.proto']
    """
    return _compiled("vines.v1.binpb")


def _compiled(name: str) -> descriptor_pb2.FileDescriptorSet:
    path = shipped("schemas") / name
    found = descriptor_pb2.FileDescriptorSet()
    data = path.read_bytes()
    try:
        found.ParseFromString(data)
    except DecodeError as broken:
        raise SchemaError(f"{path} cannot be read as protobuf descriptors ({broken}); install vines again") from broken
    return found


@cache
def _descriptors() -> dict[str, tuple[descriptor_pb2.FileDescriptorProto, int]]:
    """Return for each full message name its file and its place in it."""
    return {
        f"{file.package}.{message.name}": (file, place)
        for file in file_descriptor_set().file
        for place, message in enumerate(file.message_type)
    }


def message_names() -> tuple[str, ...]:
    """Return the full names of all messages, sorted.

    Examples
    --------
    >>> message_names()
    ('vines.v1.Ball', 'vines.v1.BallImpact', 'vines.v1.BallStick', 'vines.v1.BaseMotion', 'vines.v1.Impact',
     'vines.v1.Nes', 'vines.v1.Orbit', 'vines.v1.Oscillator', 'vines.v1.SensorSample', 'vines.v1.State',
     'vines.v1.Stick')
    """
    return tuple(sorted(_descriptors()))


def _find(name: str) -> tuple[descriptor_pb2.FileDescriptorProto, int]:
    try:
        return _descriptors()[name]
    except KeyError:
        raise UnknownNameError(f"no message is called {name!r}; {nearest(name, message_names())}") from None


@cache
def numpy_dtype(name: str) -> np.dtype:
    """Return the structured dtype of a message, its fields in the order of the schema.

    Parameters
    ----------
    name : str
        Full name, such as ``"vines.v1.State"``.

    Raises
    ------
    UnknownNameError
        If there is no such message.

    Examples
    --------
    >>> numpy_dtype("vines.v1.Impact").names[:4]
    ('t', 'side', 'x1', 'v1')
    """
    wire = wire_format(name).dtype
    return np.dtype([(field, wire[field]) for field in wire.names or ()])


@cache
def wire_format(name: str) -> WireFormat:
    """Return how a message of this name is laid out in protobuf's wire format, all fields present.

    Raises
    ------
    UnknownNameError
        If there is no such message.
    SchemaError
        If a field of it has no fixed width.

    Examples
    --------
    >>> layout = wire_format("vines.v1.State")
    >>> layout.dtype.itemsize, len(layout.blank)
    (141, 141)
    """
    file, place = _find(name)
    names: list[str] = []
    formats: list[str] = []
    offsets: list[int] = []
    tags: list[int] = []
    blank = bytearray()
    for field in sorted(file.message_type[place].field, key=lambda field: field.number):
        if field.type not in _FIXED or field.label == _Field.LABEL_REPEATED:
            raise SchemaError(f"field {field.name!r} of {name} has no fixed width; use double, sfixed32 or sfixed64")
        form, wire_type = _FIXED[field.type]
        tag = _varint(field.number << 3 | wire_type)
        tags.extend(range(len(blank), len(blank) + len(tag)))
        blank += tag
        names.append(field.name)
        formats.append(form)
        offsets.append(len(blank))
        blank += bytes(np.dtype(form).itemsize)
    dtype = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": len(blank)})
    return WireFormat(dtype, bytes(blank), np.array(tags, dtype=np.intp))


def _varint(value: int) -> bytes:
    """Return a non-negative integer as a protobuf varint."""
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


@cache
def schema_bytes(name: str) -> bytes:
    """Return the FileDescriptorSet that an MCAP channel of this message carries, comments included.

    Our files import nothing, so one file is complete.

    Raises
    ------
    UnknownNameError
        If there is no such message.
    """
    file, _ = _find(name)
    return descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString(deterministic=True)


@cache
def foxglove_schema() -> bytes:
    """Return the FileDescriptorSet of the messages that viewers know without vines, as a channel carries it.

    Examples
    --------
    >>> b"FrameTransforms" in foxglove_schema()
    True
    """
    found = descriptor_pb2.FileDescriptorSet()
    found.CopyFrom(_compiled("foxglove.binpb"))
    for file in found.file:
        file.ClearField("source_code_info")
    return found.SerializeToString(deterministic=True)


@cache
def raw_schema() -> bytes:
    """Return the FileDescriptorSet of ``vines.v1.RawSamples``, comments included, as a channel carries it.

    It lies apart from the other messages of vines: it holds lists, whose length is that of a channel.

    Examples
    --------
    >>> b"RawSamples" in raw_schema()
    True
    """
    return _compiled("vines.raw.binpb").SerializeToString(deterministic=True)


@cache
def field_notes(name: str) -> dict[str, tuple[str, str]]:
    """Return for each field of a message its unit and its description, from the comments of the schema.

    Returns
    -------
    dict
        Field name to (unit, description); ``"-"`` is the unit of a plain number.

    Raises
    ------
    UnknownNameError
        If there is no such message.

    Examples
    --------
    >>> field_notes("vines.v1.Impact")["w_dot"][0]
    'b omega0'
    """
    file, place = _find(name)
    comments = {
        tuple(location.path): " ".join(location.leading_comments.split())
        for location in file.source_code_info.location
        if location.leading_comments
    }
    notes: dict[str, tuple[str, str]] = {}
    for number, field in enumerate(file.message_type[place].field):
        # Paths in descriptor.proto: field 4 of a file is message_type, field 2 of a message is field.
        unit, _, text = comments.get((4, place, 2, number), "[-]").partition("]")
        notes[field.name] = (unit.removeprefix("["), text.strip())
    return notes


@cache
def message_class(name: str) -> type[Message]:
    """Return a protobuf class of a message, for files that were not packed by vines.

    Raises
    ------
    UnknownNameError
        If there is no such message.
    """
    file, _ = _find(name)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))
