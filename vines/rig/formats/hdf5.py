"""HDF5: every one-dimensional dataset of numbers is a channel; unit, rate and start are taken from its attributes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["FORMAT", "first_of", "is_hdf5", "read", "write"]

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_UNIT = ("unit", "units", "Unit", "Units", "unit_string")
_RATE = ("sampling_rate", "rate", "fs", "sample_rate", "sampling_frequency", "SamplingRate")
_STEP = ("dt", "wf_increment", "increment", "delta_t")
_START = ("t0", "start", "start_time")


def is_hdf5(head: bytes) -> bool:
    """Say whether a file begins as HDF5 does, behind a block of 512 bytes maybe."""
    return head.startswith(_SIGNATURE) or head[512:520] == _SIGNATURE


def first_of(attributes: Mapping[str, Any], names: tuple[str, ...]) -> Any:
    """Return the first attribute that is there, bytes as text; ``None`` if none is."""
    for name in names:
        if name in attributes:
            value = attributes[name]
            value = value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
            return value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return None


def _number(value: Any) -> float | None:
    try:
        return None if value is None else float(value)
    except (TypeError, ValueError):
        return None


def read(path: Path) -> RawFile:
    """Read a file; a channel is called by its path in the file."""
    need("h5py")
    import h5py

    channels: list[RawChannel] = []
    other: list[str] = []
    with h5py.File(path, "r") as file:
        started = first_of(dict(file.attrs), ("started", "start_utc"))

        def take(name: str, each: Any) -> None:
            if not isinstance(each, h5py.Dataset):
                return
            if each.ndim != 1 or each.dtype.kind not in "iuf" or len(each) < 2:
                other.append(f"{name} {each.shape} of {each.dtype}")
                return
            attributes = dict(each.attrs)
            unit = first_of(attributes, _UNIT)
            rate, step = _number(first_of(attributes, _RATE)), _number(first_of(attributes, _STEP))
            slope = _number(first_of(attributes, ("slope",)))
            values = each[()]
            channels.append(
                RawChannel(
                    name=name,
                    values=values if slope is None else values * slope,
                    unit=None if unit is None else str(unit),
                    rate=rate if rate else 1.0 / step if step else None,
                    start=_number(first_of(attributes, _START)),
                    about={key: str(value) for key, value in attributes.items()},
                )
            )

        file.visititems(take)
    return RawFile("HDF5", tuple(channels), None if started is None else str(started), tuple(other))


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write channels as datasets with the attributes unit, sampling_rate, start, slope, see `Format`."""
    need("h5py")
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["started"] = started
        for each in channels:
            place = file.create_dataset(each.name, data=np.asarray(each.values), track_times=False)
            place.attrs["unit"] = each.unit or ""
            if each.rate is not None:
                place.attrs["sampling_rate"] = each.rate
            place.attrs["start"] = float(each.start or 0.0)
            if "slope" in each.about:
                place.attrs["slope"] = float(each.about["slope"])


def _begins(head: bytes, suffix: str) -> bool:
    return is_hdf5(head) and not head.startswith(b"MATLAB") and suffix != ".mat"


FORMAT = Format(
    name="hdf5",
    label="HDF5",
    summary="one-dimensional datasets; attributes `unit`, `sampling_rate` or `dt`, `start`",
    suffixes=(".h5", ".hdf5", ".hdf"),
    read=read,
    begins=_begins,
    write=write,
)
