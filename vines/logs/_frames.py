"""The frame of an MCAP file: its records one after the other, its end, its footer."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from vines.errors import LogError

__all__ = ["data_section", "frames", "indexed", "summary_start"]

_FOOTER = struct.Struct("<BQQQI")


def frames(data: bytes, start: int, stop: int) -> Iterator[tuple[int, int, bytes]]:
    """Yield the place, opcode and content of each record between two places.

    Raises
    ------
    ValueError
        If a record is longer than what is left.
    """
    while start < stop:
        if start + 9 > stop:
            raise ValueError(f"a record at byte {start} is cut off")
        opcode, length = struct.unpack_from("<BQ", data, start)
        if start + 9 + length > stop:
            raise ValueError(f"a record at byte {start} is longer than the file")
        yield start, opcode, data[start + 9 : start + 9 + length]
        start += 9 + length


def indexed(data: bytes, start: int, stop: int) -> list[np.ndarray]:
    """Return where each of the message indexes at a place, behind a chunk, says that messages begin in it."""
    offsets: list[np.ndarray] = []
    while start + 15 <= stop and data[start] == Opcode.MESSAGE_INDEX:
        (length,) = struct.unpack_from("<Q", data, start + 1)
        if start + 9 + length > stop:
            break
        offsets.append(np.frombuffer(data, "<u8", 2 * (max(0, length - 6) // 16), start + 15)[1::2])
        start += 9 + length
    return offsets


def data_section(file: Path, data: bytes, remedy: str) -> tuple[int, int]:
    """Return where the data section begins and ends, its own end record included.

    Raises
    ------
    LogError
        If the file is no MCAP file, is cut short, or has a damaged footer or summary.
    """
    if not data.startswith(MCAP0_MAGIC):
        raise LogError(f"{file} is not an MCAP file (it begins with {data[:8]!r}); a log of vines ends in .mcap")
    tail = len(data) - len(MCAP0_MAGIC)
    footer = tail - _FOOTER.size
    if footer < len(MCAP0_MAGIC) or data[tail:] != MCAP0_MAGIC:
        raise LogError(f"{file} is cut short: {len(data)} bytes and no end mark; {remedy}")
    opcode, length, summary, _, crc = _FOOTER.unpack_from(data, footer)
    if (opcode, length) != (Opcode.FOOTER, 20):
        raise LogError(f"{file} is damaged: no footer before the end mark; {remedy}")
    if summary and crc and crc != zlib.crc32(memoryview(data)[summary : tail - 4]):
        raise LogError(f"{file} is damaged: the checksum of its summary does not fit; {remedy}")
    return len(MCAP0_MAGIC), summary or footer


def summary_start(data: bytes) -> tuple[int, int] | None:
    """Return where an intact summary begins and ends, or None where there is none whose checksum fits.

    The end mark behind it may be cut off: the checksum alone decides.
    """
    for kept in range(len(MCAP0_MAGIC), -1, -1):
        tail = len(data) - kept
        footer = tail - _FOOTER.size
        if footer < len(MCAP0_MAGIC) or data[tail:] != MCAP0_MAGIC[:kept]:
            continue
        opcode, length, summary, _, crc = _FOOTER.unpack_from(data, footer)
        fits = (opcode, length) == (Opcode.FOOTER, 20) and 0 < summary <= footer
        if fits and crc and crc == zlib.crc32(memoryview(data)[summary : tail - 4]):
            return summary, footer
    return None
