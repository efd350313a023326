"""A channel as it stands in a file, before anything is known of its sensor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from vines.errors import RigError, nearest

__all__ = ["RawChannel", "RawFile"]


@dataclass(frozen=True, slots=True, eq=False)
class RawChannel:
    """Numbers of one channel and what its file says of them; ``None`` where it says nothing.

    Attributes
    ----------
    name : str
        How the file calls it; unique in the file.
    values : ndarray, shape (n,)
        Its samples, in `unit`.
    unit : str or None
        Unit of the samples as written.
    rate : float or None
        Samples a second.
    start : float or None
        Seconds from the earliest first sample of the file to that of this channel.
    times : ndarray of float64 or None, shape (n,)
        Times of the samples, where the file gives one for each: seconds, or in what unit the file does not say.
    tick : float or None
        Seconds of one unit of `times`: 1, or ``None`` where the file does not say.
    about : mapping of str to str
        Anything else that the file says of it.
    """

    name: str
    values: npt.NDArray[np.generic]
    unit: str | None = None
    rate: float | None = None
    start: float | None = None
    times: npt.NDArray[np.float64] | None = None
    tick: float | None = 1.0
    about: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class RawFile:
    """What a file of a recorder holds.

    Attributes
    ----------
    form : str
        Its format, such as ``NI TDMS``.
    channels : tuple of RawChannel
        In the order of the file.
    started : str or None
        When it was started, ISO 8601, if it says so.
    other : tuple of str
        What else is in it and is no channel, each in a few words.
    dialect : str
        How a file of text was read, as ``channels.tsv`` would state it.
    remarks : tuple of str
        What was found and has to be known: that its end is missing, say.
    """

    form: str
    channels: tuple[RawChannel, ...]
    started: str | None = None
    other: tuple[str, ...] = ()
    dialect: str = ""
    remarks: tuple[str, ...] = ()

    def channel(self, name: str) -> RawChannel:
        """Return a channel by name.

        Raises
        ------
        RigError
            If there is none of that name.
        """
        for each in self.channels:
            if each.name == name:
                return each
        raise RigError(f"there is no field {name!r}: {nearest(name, [each.name for each in self.channels])}")
