"""The option with which a log may unpack to more than is allowed by default."""

from __future__ import annotations

import click

from vines.logs import CHUNK_LIMIT

__all__ = ["max_chunk_option"]

max_chunk_option = click.option(
    "--max-chunk",
    type=click.IntRange(min=1),
    default=CHUNK_LIMIT // 2**20,
    show_default=True,
    metavar="MIB",
    help="What one chunk of a file may unpack to, in MiB; the whole file may to as much, or to 100 times its size.",
)
