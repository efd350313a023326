"""MCAP: the log of a run that was watched, whose recorder's samples are in it at their full rate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.logs import Raw
from vines.logs import read as read_log
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["FORMAT", "read"]

_OUT_OF_RANGE = 1.05
"""A lost sample is written as so many times the range, and is flagged as what lies out of it."""


def read(path: Path) -> RawFile:
    """Read a log that ``vines rig watch`` wrote; a channel is called as it was watched.

    Raises
    ------
    RigError
        If it holds only what is thinned for viewers.
    """
    log = read_log(path)
    if not log.raw:
        raise RigError("it holds no samples of a recorder at their full rate: give the raw file that it was made from")
    earliest = min(each.start for each in log.raw.values())
    remarks = [f"{name}: {int(each.lost.sum())} samples were lost" for name, each in log.raw.items() if each.lost.any()]
    if not log.complete:
        remarks.append(f"its status is {log.status}: what was lost at its end is not known")
    return RawFile(
        form="MCAP log of vines",
        channels=tuple(
            RawChannel(
                name=name,
                values=_whole(each),
                unit=each.about.get("unit"),
                rate=each.rate,
                start=each.start - earliest,
                about={key: text for key, text in each.about.items() if key not in ("unit", "rate", "dtype")},
            )
            for name, each in log.raw.items()
        ),
        started=log.provenance.get("start_utc"),
        remarks=tuple(remarks),
    )


def _whole(raw: Raw) -> npt.NDArray[np.generic]:
    """Return the samples with those that were lost out of range, or no numbers where no range is known."""
    if not raw.lost.any():
        return raw.values
    values = raw.values.astype(np.float64)
    values[raw.lost] = _OUT_OF_RANGE * float(raw.about.get("range") or "nan")
    return values


FORMAT = Format(
    name="mcap",
    label="MCAP log of vines",
    summary="channels of a run that was watched, at their full rate; lost samples",
    suffixes=(".mcap",),
    read=read,
    begins=lambda head, suffix: head.startswith(b"\x89MCAP0\r\n"),
)
