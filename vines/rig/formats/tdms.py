"""NI TDMS: LabVIEW's own files, with waveform properties and scaling."""

from __future__ import annotations

import logging
import struct
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from vines.errors import RigError
from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile
from vines.rig.units import si_factor

__all__ = ["FORMAT", "read", "write"]

_LEAD_IN = 28
_BIG_ENDIAN = 1 << 6
_UNKNOWN = 0xFFFFFFFFFFFFFFFF
"""Length in the lead-in of a segment while it is being written."""


def read(path: Path) -> RawFile:
    """Read a file with all its groups; a channel is called ``group/channel``.

    An index file beside it is not looked at: it may be that of an earlier state of the file.

    Raises
    ------
    RigError
        If a copy was cut off: how much is missing cannot be told.
    """
    need("nptdms")
    import nptdms
    import nptdms.log

    # It would print what is refused or said below in one line.
    nptdms.log.log_manager.set_level(logging.ERROR)

    channels: list[RawChannel] = []
    other: list[str] = []
    remarks: list[str] = []
    starts: list[np.datetime64 | None] = []
    with path.open("rb") as stream:
        if stream.read(4) == b"TDSh":
            raise RigError("it is the index of a TDMS file and holds no samples: give the file beside it, .tdms")
        stream.seek(0)
        file = nptdms.TdmsFile.read(stream)
        part: dict[str, int] = {}
        if file.file_status.incomplete_final_segment:
            if not _broke_off(stream):
                raise RigError("its end is missing, a copy was cut off: copy it again or mend the recording")
            part = _last_chunk(file.file_status.channel_statuses or {})
            lost = f", {max(part.values())} samples of a begun one are left out" if any(part.values()) else ""
            remarks.append(f"the recording broke off and was never closed: read to the last whole chunk{lost}")
    for group in file.groups():
        for each in group.channels():
            name = f"{group.name}/{each.name}"
            values = np.asarray(each[:])
            values = values[: len(values) - part.get(each.path, 0)]
            properties = each.properties
            axis = str(properties.get("wf_xunit_string") or "s")
            if not len(values) or values.dtype.kind not in "iufb" or not _is_time(axis):
                other.append(f"{name} ({len(values)} of {values.dtype}{'' if _is_time(axis) else ' over ' + axis})")
                continue
            step = float(properties.get("wf_increment") or 0.0) * si_factor(axis)[1]
            unit = properties.get("unit_string") or properties.get("NI_UnitDescription")
            began = properties.get("wf_start_time")
            starts.append(began if isinstance(began, np.datetime64) else None)
            channels.append(
                RawChannel(
                    name=name,
                    values=values,
                    unit=str(unit) if unit else None,
                    rate=1.0 / step if step else None,
                    start=float(properties.get("wf_start_offset", 0.0)) if step else None,
                    about={key: str(value) for key, value in properties.items()},
                )
            )
    known = [began for began in starts if began is not None]
    first = min(known) if known else None
    if first is not None:
        channels = [
            channel
            if began is None or channel.start is None
            else _later(channel, (began - first) / np.timedelta64(1, "ns"))
            for channel, began in zip(channels, starts, strict=True)
        ]
    return RawFile(
        "NI TDMS", tuple(channels), None if first is None else f"{first}Z", tuple(other), remarks=tuple(remarks)
    )


def _broke_off(stream: BinaryIO) -> bool:
    """Say whether the last segment was never closed: its lead-in then has no length."""
    place, size = 0, stream.seek(0, 2)
    while place + _LEAD_IN <= size:
        stream.seek(place)
        lead = stream.read(_LEAD_IN)
        order = ">" if struct.unpack("<I", lead[4:8])[0] & _BIG_ENDIAN else "<"
        (length,) = struct.unpack(f"{order}Q", lead[12:20])
        if length == _UNKNOWN:
            return True
        place += _LEAD_IN + length
    return False


def _last_chunk(statuses: Mapping[str, Any]) -> dict[str, int]:
    """Return how many samples each channel has of a chunk that was begun and not finished.

    Whole rows of interleaved samples are kept: they are equally many in all channels.
    """
    lengths = {status.read_length for status in statuses.values()}
    if len(lengths) == 1 or all(status.read_length == status.expected_length for status in statuses.values()):
        return dict.fromkeys(statuses, 0)
    return {path: status.read_length for path, status in statuses.items()}


def _is_time(unit: str) -> bool:
    try:
        return si_factor(unit)[0] == "time"
    except RigError:
        return False


def _later(channel: RawChannel, nanoseconds: float) -> RawChannel:
    return replace(channel, start=(channel.start or 0.0) + 1e-9 * float(nanoseconds))


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write channels named ``group/channel``, see `Format`; steps are kept as they are, with their scale.

    Raises
    ------
    RigError
        If a channel has no rate.
    """
    need("nptdms")
    import nptdms

    began = np.datetime64(started.removesuffix("Z"), "us")
    objects: list[Any] = [nptdms.RootObject({"title": path.stem})]
    objects += [nptdms.GroupObject(group) for group in dict.fromkeys(each.name.split("/")[0] for each in channels)]
    for each in channels:
        if each.rate is None:
            raise RigError(f"{each.name}: a TDMS waveform needs a rate")
        group, _, name = each.name.partition("/")
        properties: dict[str, Any] = {
            "wf_start_time": began,
            "wf_start_offset": float(each.start or 0.0),
            "wf_increment": 1.0 / each.rate,
            "wf_samples": len(each.values),
            "unit_string": each.unit or "",
        }
        if "slope" in each.about:
            properties |= {
                "NI_Number_Of_Scales": 1,
                "NI_Scale[0]_Scale_Type": "Linear",
                "NI_Scale[0]_Linear_Slope": float(each.about["slope"]),
                "NI_Scale[0]_Linear_Y_Intercept": 0.0,
                "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
            }
        objects.append(nptdms.ChannelObject(group, name, np.asarray(each.values), properties=properties))
    with nptdms.TdmsWriter(path) as file:
        file.write_segment(objects)


def _begins(head: bytes, suffix: str) -> bool:
    del suffix
    return head.startswith((b"TDSm", b"TDSh"))


FORMAT = Format(
    name="tdms",
    label="NI TDMS",
    summary="`group/channel`, scaling, `unit_string`, `wf_increment`, start times",
    suffixes=(".tdms",),
    read=read,
    begins=_begins,
    write=write,
)
