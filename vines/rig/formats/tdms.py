"""NI TDMS: LabVIEW's own files, with waveform properties and scaling."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from vines.errors import RigError
from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["FORMAT", "read", "write"]


def read(path: Path) -> RawFile:
    """Read a file with all its groups; a channel is called ``group/channel``.

    Raises
    ------
    RigError
        If the recorder or a copy did not write it to its end: how much is missing cannot be told.
    """
    need("nptdms")
    import nptdms
    import nptdms.log

    # It would print what is refused below in one line.
    nptdms.log.log_manager.set_level(logging.ERROR)

    channels: list[RawChannel] = []
    other: list[str] = []
    starts: list[np.datetime64 | None] = []
    with nptdms.TdmsFile.read(path) as file:
        if file.file_status.incomplete_final_segment:
            raise RigError(
                "its end is missing, the recorder or a copy was cut off: copy it again or mend the recording"
            )
        for group in file.groups():
            for each in group.channels():
                name = f"{group.name}/{each.name}"
                values: Any = each[:]
                if not len(values) or np.asarray(values).dtype.kind not in "iufb":
                    other.append(f"{name} ({len(values)} of {np.asarray(values).dtype})")
                    continue
                properties = each.properties
                step = properties.get("wf_increment")
                unit = properties.get("unit_string") or properties.get("NI_UnitDescription")
                began = properties.get("wf_start_time")
                starts.append(began if isinstance(began, np.datetime64) else None)
                channels.append(
                    RawChannel(
                        name=name,
                        values=np.asarray(values),
                        unit=str(unit) if unit else None,
                        rate=1.0 / float(step) if step else None,
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
    return RawFile("NI TDMS", tuple(channels), None if first is None else f"{first}Z", tuple(other))


def _later(channel: RawChannel, nanoseconds: float) -> RawChannel:
    start = (channel.start or 0.0) + 1e-9 * float(nanoseconds)
    return replace(channel, start=start)


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write channels named ``group/channel``; whole numbers are kept with a linear scale in ``about``.

    Parameters
    ----------
    path : Path
        Where.
    channels : tuple of RawChannel
        Float samples, or int32 with ``slope`` in ``about`` (the value of one step in `unit`).
    started : str
        ISO 8601 in UTC.

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
