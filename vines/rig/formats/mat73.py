"""MATLAB v7.3: HDF5 behind a block of 512 bytes, read as any MATLAB file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel
from vines.rig.formats.hdf5 import is_hdf5
from vines.rig.formats.mat import FORMAT as OLDER

__all__ = ["FORMAT", "write"]

_HEADER = b"MATLAB 7.3 MAT-file"
_USERBLOCK = 512


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write a v7.3 file as MATLAB lays it out, see `Format`: arrays are transposed, text is UTF-16."""
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
    head = (_HEADER + b", written by vines").ljust(116) + bytes(8) + b"\x00\x02IM"
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


def _begins(head: bytes, suffix: str) -> bool:
    return head.startswith(_HEADER[:10]) or (is_hdf5(head) and suffix == ".mat")


FORMAT = Format(
    name="mat73",
    label="MATLAB v7.3",
    summary=OLDER.summary,
    suffixes=OLDER.suffixes,
    read=OLDER.read,
    begins=_begins,
    write=write,
)
