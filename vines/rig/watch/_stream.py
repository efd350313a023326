"""What is watched: streams of samples, live or from files that appear."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.watch._channel import Channel

__all__ = ["FASTEST", "IDLE", "SLOWEST", "Block", "Refusal", "Source", "Stream", "check_rate"]

IDLE = 0.2
"""Seconds after which a source that has nothing says so, so that nobody who asks has to wait longer."""
SLOWEST, FASTEST = 50.0, 1e6
"""Samples a second that make sense: the oscillator moves at some ten hertz."""


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Samples that came together.

    Attributes
    ----------
    first : int
        Number of the first one since the stream began; numbers between blocks that are missing were lost.
    values : ndarray, shape (channels, n)
        As the recorder gives them.
    """

    first: int
    values: npt.NDArray[np.generic]


@dataclass(frozen=True, eq=False)
class Stream:
    """One run of a recorder.

    Attributes
    ----------
    name : str
        What it is called.
    channels : tuple of Channel
        In the order of the values.
    rate : float
        Samples a second.
    blocks : iterator of Block or None
        None where there is nothing for `IDLE` seconds.
    dtype : str
        Type in which its samples are kept: ``<f4``, ``<f8`` or ``<i4``.
    run : mapping
        Entries of ``run.json`` that the source states.
    file : Path or None
        The file that it is read from; such a one is its own raw data.
    remarks : tuple of str
        What a person has to know.
    """

    name: str
    channels: tuple[Channel, ...]
    rate: float
    blocks: Iterator[Block | None]
    dtype: str = "<f4"
    run: Mapping[str, Any] = field(default_factory=dict)
    file: Path | None = None
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Refusal:
    """A file that cannot be read.

    Attributes
    ----------
    file : Path
        Which.
    reason : str
        One line.
    """

    file: Path
    reason: str


class Source(Protocol):
    """Where streams come from; a context that ends its connection."""

    live: bool
    """Whether it gives one stream, at the pace of the rig."""

    def streams(self) -> Iterator[Stream | Refusal | None]:
        """Yield each stream, and None where none begins for `IDLE` seconds."""
        ...

    def close(self) -> None:
        """Let go of device, connection or folder."""
        ...


def check_rate(rate: float, where: str) -> float:
    """Return a rate that can be; else refuse it.

    Raises
    ------
    RigError
        One line with what is allowed.
    """
    if not SLOWEST <= rate <= FASTEST:
        raise RigError(f"{where}: rate is {rate:g} samples a second, allowed is {SLOWEST:g} to {FASTEST:g}")
    return rate
