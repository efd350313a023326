"""MATLAB v4 to v7: vectors of numbers are channels, also inside structures; read() takes v7.3, too.

MATLAB has no convention for units. A structure with the fields ``data``, ``unit``, ``fs`` (and ``start``) is understood
as a channel, also in arrays and cells, as ``ch(1)`` and ``ch{1}``. Of plain vectors only the numbers are known, and
``channels.tsv`` must say the rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
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
    """Take a variable: a vector, a matrix with a channel a column, a structure, an array of such, or a cell array."""
    if isinstance(value, list):
        for place, inner in enumerate(value):
            _take(f"{name}{{{place + 1}}}", inner, channels, other)
        return
    if isinstance(value, Mapping):
        lengths = {len(inner) if isinstance(inner, list) else 0 for inner in value.values()}
        if len(lengths) == 1 and 0 not in lengths:
            # A structure array comes with a list a field.
            for place in range(lengths.pop()):
                element = {key: inner[place] for key, inner in value.items()}
                _take(f"{name}({place + 1})", element, channels, other)
            return
        if isinstance(value.get("data"), np.ndarray) and value["data"].dtype.kind in "iufb":
            channels += [_structure(each, value) for each in _columns(name, value["data"])]
            return
        for key, inner in value.items():
            _take(f"{name}.{key}", inner, channels, other)
        return
    found = _columns(name, value) if isinstance(value, np.ndarray) and value.dtype.kind in "iufb" else []
    channels += found
    if not found:
        shape = f" {value.shape}" if isinstance(value, np.ndarray) else ""
        other.append(f"{name} ({type(value).__name__}{shape})")


def _columns(name: str, values: np.ndarray) -> list[RawChannel]:
    """Return a vector as a channel, a long matrix as one a column, called ``name[1]``; anything else is none."""
    if values.size < 2:
        return []
    if values.ndim == 1:
        return [RawChannel(name, values)]
    if values.ndim != 2 or max(values.shape) < 16 * min(values.shape):
        return []
    columns = values if values.shape[0] > values.shape[1] else values.T
    return [
        RawChannel(f"{name}[{place + 1}]", np.ascontiguousarray(columns[:, place])) for place in range(columns.shape[1])
    ]


def _structure(channel: RawChannel, value: Mapping[str, Any]) -> RawChannel:
    """Return a channel with what the structure beside its data says."""
    rate, step = first_of(value, ("fs", "rate", "Fs")), first_of(value, ("dt", "Ts"))
    start, slope, unit = (first_of(value, names) for names in (("start", "t0"), ("slope",), ("unit", "units")))
    called = value.get("name")
    return replace(
        channel,
        values=channel.values if slope is None else np.asarray(channel.values, np.float64) * float(slope),
        unit=unit if isinstance(unit, str) and unit else None,
        rate=float(rate) if rate else 1.0 / float(step) if step else None,
        start=None if start is None else float(start),
        about={"name": called} if isinstance(called, str) else {},
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
    summary="vectors, columns of long matrices, cells; a structure with `data`, `unit`, `fs`, `start` is a channel",
    suffixes=(".mat",),
    read=read,
    begins=_begins,
    write=write,
)
