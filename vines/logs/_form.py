"""Messages of a fixed length in formats that are not ours: a template with slots that numpy fills.

Viewers know some messages by themselves, in protobuf (foxglove) or CDR (ROS 2). Their texts are the same in every
message of a log, so each has one length, and a template with the places of its numbers packs all of them at once.
"""

from __future__ import annotations

import struct

import numpy as np

from vines.schema import WireFormat

__all__ = ["ROS_LATEST", "STAMP", "Form", "stamps"]

ROS_LATEST = 2.0**31
"""Times from here on are none of ROS, whose seconds have 32 bits: a log that goes on for longer has none of these."""
STAMP = ("<u1", (5,))
"""A number below 2^35 as a protobuf varint of five bytes, whatever its size (longer than need be, which is allowed)."""


def stamps(values: np.ndarray) -> np.ndarray:
    """Return whole numbers as varints of five bytes, shape (n, 5).

    Examples
    --------
    >>> stamps(np.array([300])).tolist()
    [[172, 130, 128, 128, 0]]
    """
    pieces = (values.astype(np.uint64)[:, None] >> np.arange(0, 35, 7, dtype=np.uint64)).astype(np.uint8) & 0x7F
    pieces[:, :4] |= 0x80
    return pieces


class Form:
    """A message in the making: fixed bytes and slots."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.slots: list[tuple[str, object, int]] = []

    def slot(self, name: str, form: object) -> Form:
        """Leave room for a number (or an array of bytes) of this numpy type."""
        self.slots.append((name, form, len(self.data)))
        self.data += bytes(np.dtype(form).itemsize)  # type: ignore[call-overload]
        return self

    def put(self, data: bytes) -> Form:
        """Append fixed bytes."""
        self.data += data
        return self

    def tag(self, number: int, wire: int) -> Form:
        """Append the tag of a protobuf field with a number below 16."""
        return self.put(bytes([number << 3 | wire]))

    def double(self, number: int, name: str) -> Form:
        """Append a protobuf double."""
        return self.tag(number, 1).slot(name, "<f8")

    def text(self, number: int, text: str) -> Form:
        """Append a protobuf string."""
        return self.nest(number, Form().put(text.encode()))

    def nest(self, number: int, inner: Form) -> Form:
        """Append a protobuf message, whose length takes two bytes."""
        size = len(inner.data)
        self.tag(number, 2).put(bytes([size & 0x7F | 0x80, size >> 7]))
        start = len(self.data)
        self.slots += [(name, form, start + offset) for name, form, offset in inner.slots]
        return self.put(bytes(inner.data))

    def stamp(self, number: int) -> Form:
        """Append a google.protobuf.Timestamp with the slots ``sec`` and ``nanos``; one a message is filled."""
        inner = Form().tag(1, 0).slot(f"sec{len(self.slots)}", STAMP).tag(2, 0).slot(f"nano{len(self.slots)}", STAMP)
        return self.nest(number, inner)

    def align(self, size: int) -> Form:
        """Append the padding of CDR, which counts from after the four bytes of its head."""
        return self.put(bytes(-(len(self.data) - 4) % size))

    def cdr_text(self, text: str) -> Form:
        """Append a string of CDR."""
        data = text.encode() + b"\0"
        return self.align(4).put(struct.pack("<I", len(data)) + data)

    def cdr_doubles(self, names: list[str]) -> Form:
        """Append a sequence of doubles of CDR, a slot each."""
        self.align(4).put(struct.pack("<I", len(names))).align(8)
        for name in names:
            self.slot(name, "<f8")
        return self

    def layout(self) -> WireFormat:
        """Return where the slots lie."""
        names, forms, offsets = zip(*self.slots, strict=True) if self.slots else ((), (), ())
        dtype = np.dtype(
            {"names": list(names), "formats": list(forms), "offsets": list(offsets), "itemsize": len(self.data)}
        )
        return WireFormat(dtype, bytes(self.data), np.empty(0, np.intp))
