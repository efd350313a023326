"""Chunks unpacked within bounds: what a file declares about itself may be wrong on purpose."""

from __future__ import annotations

import zlib
from contextlib import suppress

import lz4.frame
import zstandard
from mcap import records

from vines.errors import ChunkError

__all__ = ["CHUNK_LIMIT", "Unpacker"]

CHUNK_LIMIT = 256 * 2**20
"""Bytes to which one chunk may unpack; writers close chunks at one to some ten MiB."""
_RATIO = 100
"""Times its own size to which a whole file may unpack; what sensors measure is packed to a half or so."""
_MIB = 2**20


class Unpacker:
    """Unpacks the chunks of one file, and refuses one that takes more memory than is allowed before it is taken.

    Parameters
    ----------
    size : int
        Bytes of the file.
    limit : int
        Bytes to which one chunk may unpack; the file may to as many, or to a hundred times its own size.
    """

    def __init__(self, size: int, limit: int = CHUNK_LIMIT):
        self._limit = limit
        self._left = max(limit, _RATIO * size)
        self._zstd = zstandard.ZstdDecompressor()

    def unpack(self, chunk: records.Chunk) -> bytes:
        """Return the records of a chunk.

        Raises
        ------
        ChunkError
            If it unpacks to more than is allowed, or is compressed in a way that is not known.
        ValueError
            If it does not unpack to the size or the checksum that it declares.
        """
        size = chunk.uncompressed_size
        if size > min(self._limit, self._left):
            what = "a chunk unpacks" if size > self._limit else "all chunks unpack"
            raise ChunkError(
                f"{what} to more than the {min(self._limit, self._left) / _MIB:.0f} MiB that are allowed "
                f"({size / _MIB:.0f} MiB are declared); if you trust the file, allow more with --max-chunk MIB"
            )
        data = self._decompressed(chunk, size)
        if len(data) != size:
            more = "more than" if len(data) > size else f"{len(data)} bytes instead of"
            raise ValueError(f"a chunk unpacks to {more} the {size} bytes that it declares")
        if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
            raise ValueError("the checksum of a chunk does not fit")
        self._left -= size
        return data

    def _decompressed(self, chunk: records.Chunk, size: int) -> bytes:
        """Return a chunk unpacked, or one byte more than was declared if there is more."""
        if chunk.compression == "":
            return chunk.data
        if chunk.compression == "zstd":
            if chunk.data and zstandard.frame_content_size(chunk.data) == size:
                with suppress(zstandard.ZstdError):  # of several frames, which a stream reads
                    return self._zstd.decompress(chunk.data, allow_extra_data=False)
            with self._zstd.stream_reader(chunk.data, read_across_frames=True) as stream:
                return stream.read(size + 1)
        if chunk.compression == "lz4":
            return lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        raise ChunkError(
            f"its chunks are compressed as {chunk.compression!r}, which vines does not know (it reads zstd, lz4 and "
            "none); rewrite the file with one of these, as with `mcap compress`"
        )
