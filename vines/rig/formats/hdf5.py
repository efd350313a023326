"""HDF5: vectors, columns of long matrices and fields of compound types; attributes say unit, rate and start."""

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
            return _text(value)
    return None


def _text(value: Any) -> Any:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def _columns(name: str, each: Any) -> dict[str, np.ndarray]:
    """Return the channels of a dataset: a vector, the columns ``name[1]`` of a long matrix, fields ``name.field``."""
    kinds = each.dtype
    if each.ndim == 1 and len(each) > 1 and kinds.names:
        values = each[()]
        return {f"{name}.{field}": np.ascontiguousarray(values[field]) for field in kinds.names if _plain(kinds[field])}
    if not _plain(kinds) or each.size < 2:
        return {}
    if each.ndim == 1:
        return {name: each[()]}
    if each.ndim != 2 or max(each.shape) < 16 * min(each.shape):
        return {}
    values = each[()] if each.shape[0] > each.shape[1] else each[()].T
    return {f"{name}[{k + 1}]": np.ascontiguousarray(values[:, k]) for k in range(values.shape[1])}


def _plain(kind: np.dtype) -> bool:
    return kind.kind in "iuf" and not kind.shape


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
            columns = _columns(name, each)
            if not columns:
                other.append(f"{name} {each.shape} of {each.dtype}")
                return
            # A rate may stand once for all, at the group or the file.
            attributes = {**dict(file.attrs), **dict(each.parent.attrs), **dict(each.attrs)}
            unit = first_of(dict(each.attrs), _UNIT)
            rate, step = _number(first_of(attributes, _RATE)), _number(first_of(attributes, _STEP))
            slope = _number(first_of(dict(each.attrs), ("slope",)))
            for place, (label, values) in enumerate(columns.items()):
                own = _text(unit[place]) if np.ndim(unit) == 1 and len(unit) == len(columns) else unit
                channels.append(
                    RawChannel(
                        name=label,
                        values=values if slope is None else values * slope,
                        unit=own if isinstance(own, str) else None,
                        rate=rate if rate else 1.0 / step if step else None,
                        start=_number(first_of(dict(each.attrs), _START)),
                        about={key: str(value) for key, value in each.attrs.items()},
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
    summary="vectors, columns of long matrices, compound types; attributes `unit`, `sampling_rate` or `dt`, `start`",
    suffixes=(".h5", ".hdf5", ".hdf"),
    read=read,
    begins=_begins,
    write=write,
)
