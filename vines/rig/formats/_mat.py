"""MATLAB v4 to v7.3: vectors of numbers are channels, also inside structures; v7.3 is HDF5 underneath.

MATLAB has no convention for units. A structure with the fields ``data``, ``unit``, ``fs`` (and ``start``) is understood
as a channel; of plain vectors only the numbers are known, and ``channels.tsv`` must say the rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vines.packages import need
from vines.rig.formats._hdf5 import first_of
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["read", "write", "write_73"]

_HEADER = b"MATLAB 5.0 MAT-file"
_USERBLOCK = 512


def read(path: Path) -> RawFile:
    """Read a file of any version; a channel is called by its variable, with dots inside structures."""
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
    """Write a v5 file with a structure a channel.

    Parameters
    ----------
    path : Path
        Where.
    channels : tuple of RawChannel
        What.
    started : str
        ISO 8601 in UTC.
    """
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


def write_73(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write a v7.3 file as MATLAB lays it out: HDF5 behind a block of 512 bytes, arrays transposed, text as UTF-16.

    Parameters
    ----------
    path, channels, started
        As of :func:`write`.
    """
    need("h5py")
    import h5py

    with h5py.File(path, "w", userblock_size=_USERBLOCK, libver="latest") as file:
        _text(file, "started", started)
        for each in channels:
            group = file.create_group(each.name)
            group.attrs["MATLAB_class"] = np.bytes_("struct")
            values = np.asarray(each.values)
            kind = "int32" if values.dtype == np.int32 else "double"
            _array(group, "data", values.reshape(1, -1), kind)
            _text(group, "unit", each.unit or "")
            numbers = {"fs": each.rate or 0.0, "start": each.start or 0.0}
            if "slope" in each.about:
                numbers["slope"] = float(each.about["slope"])
            for name, value in numbers.items():
                _array(group, name, np.array([[value]]), "double")
    head = b"MATLAB 7.3 MAT-file, written by vines".ljust(116) + bytes(8) + b"\x00\x02IM"
    with path.open("r+b") as stream:
        stream.write(head)


def _array(group: Any, name: str, values: np.ndarray, kind: str) -> None:
    place = group.create_dataset(name, data=values, track_times=False)
    place.attrs["MATLAB_class"] = np.bytes_(kind)


def _text(group: Any, name: str, text: str) -> None:
    codes = np.frombuffer(text.encode("utf-16-le"), np.uint16).reshape(-1, 1)
    place = group.create_dataset(name, data=codes, track_times=False)
    place.attrs["MATLAB_class"] = np.bytes_("char")
    place.attrs["MATLAB_int_decode"] = np.int32(2)
