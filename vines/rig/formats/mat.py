"""MATLAB v4 to v7: vectors of numbers are channels, also inside structures; read() takes v7.3, too.

MATLAB has no convention for units. A structure with the fields ``data``, ``unit``, ``fs`` (and ``start``) is understood
as a channel; of plain vectors only the numbers are known, and ``channels.tsv`` must say the rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile
from vines.rig.formats.hdf5 import first_of

__all__ = ["FORMAT", "read", "write"]

_HEADER = b"MATLAB 5.0 MAT-file"


def read(path: Path) -> RawFile:
    """Read a file of any version, v7.3 included; a channel is called by its variable, with dots inside structures."""
    need("pymatreader")
    import pymatreader

    found: Mapping[str, Any] = pymatreader.read_mat(str(path))
    channels: list[RawChannel] = []
    other: list[str] = []
    for name, value in found.items():
        if not name.startswith("__"):
            _take(name, value, channels, other)
    with path.open("rb") as stream:
        version = "v7.3" if stream.read(10) == b"MATLAB 7.3" else "up to v7"
    return RawFile(f"MATLAB {version}", tuple(channels), other=tuple(other))


def _take(name: str, value: Any, channels: list[RawChannel], other: list[str]) -> None:
    """Take a variable: a vector, a matrix with a channel a column, or a structure."""
    if isinstance(value, Mapping):
        if isinstance(value.get("data"), np.ndarray) and value["data"].ndim == 1:
            channels.append(_structure(name, value))
            return
        for key, inner in value.items():
            _take(f"{name}.{key}", inner, channels, other)
        return
    if isinstance(value, np.ndarray) and value.dtype.kind in "iufb" and value.size > 1:
        if value.ndim == 1:
            channels.append(RawChannel(name, value))
            return
        if value.ndim == 2 and max(value.shape) >= 16 * min(value.shape):
            columns = value if value.shape[0] > value.shape[1] else value.T
            for place in range(columns.shape[1]):
                channels.append(RawChannel(f"{name}[{place + 1}]", np.ascontiguousarray(columns[:, place])))
            return
    shape = f" {value.shape}" if isinstance(value, np.ndarray) else ""
    other.append(f"{name} ({type(value).__name__}{shape})")


def _structure(name: str, value: Mapping[str, Any]) -> RawChannel:
    rate, start, slope = (first_of(value, names) for names in (("fs", "rate"), ("start", "t0"), ("slope",)))
    unit = first_of(value, ("unit", "units"))
    data = value["data"]
    return RawChannel(
        name=name,
        values=data if slope is None else data * float(slope),
        unit=None if unit is None else str(unit),
        rate=None if rate is None else float(rate),
        start=None if start is None else float(start),
    )


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write a v5 file with a structure a channel, see `Format`."""
    from scipy.io import savemat

    form: dict[str, Any] = {"started": started}
    for each in channels:
        about = {"slope": float(each.about["slope"])} if "slope" in each.about else {}
        form[each.name] = {
            "data": np.asarray(each.values),
            "unit": each.unit or "",
            "fs": each.rate or 0.0,
            "start": each.start or 0.0,
            **about,
        }
    savemat(path, form, oned_as="column")
    # The head holds the wall clock; a run made again shall have the same bytes.
    with path.open("r+b") as stream:
        stream.write((_HEADER + b", written by vines").ljust(116))


def _begins(head: bytes, suffix: str) -> bool:
    del suffix
    return head.startswith(b"MATLAB") and not head.startswith(b"MATLAB 7.3")


FORMAT = Format(
    name="mat",
    label="MATLAB",
    summary="vectors, columns of long matrices; a structure with `data`, `unit`, `fs`, `start` is a channel",
    suffixes=(".mat",),
    read=read,
    begins=_begins,
    write=write,
)
