"""UFF dataset 58: time histories of modal analysis software, text or binary."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from vines.errors import RigError
from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["FORMAT", "read", "write"]

_TIME_RESPONSE = 1
_TIME = 17
_QUANTITIES = {8: "displacement", 11: "velocity", 12: "acceleration"}


def read(path: Path) -> RawFile:
    """Read the time histories of a file; a channel is called by its first line, with a number where two share it.

    The time step is written with six digits (2.6 ppm), so a stated rate is to be preferred.

    Raises
    ------
    RigError
        If samples are missing.
    """
    need("pyuff")
    import pyuff

    file = pyuff.UFF(str(path))
    kinds = np.atleast_1d(np.asarray(file.get_set_types(), int))
    channels: list[RawChannel] = []
    other: list[str] = []
    remarks: list[str] = []
    for place, kind in enumerate(kinds.tolist()):
        if kind != 58:
            other.append(f"dataset {kind}")
            continue
        each: Any = file.read_sets(place)
        values = np.asarray(each["data"])
        if each.get("func_type") != _TIME_RESPONSE and each.get("abscissa_spec_data_type") != _TIME:
            other.append(f"dataset 58 with function type {each.get('func_type')}, no time history")
            continue
        if np.iscomplexobj(values):
            other.append("a complex time history")
            continue
        count = int(each.get("num_pts") or len(values))
        name = str(each.get("id1") or "").strip() or "NONE"
        if len(values) < count:
            raise RigError(f"{name}: {count} samples are declared, {len(values)} are there; its end is missing")
        if len(values) > count:
            # The last line of text is filled up with zeros.
            remarks.append(f"{name}: {len(values) - count} numbers behind the {count} samples declared are left out")
        used = [channel.name for channel in channels]
        name = name if name not in used else f"{name} ({sum(one.split(' (')[0] == name for one in used) + 1})"
        unit = str(each.get("ordinate_axis_units_lab") or "").strip()
        even = int(each.get("abscissa_spacing", 1)) == 1
        step = float(each.get("abscissa_inc") or 0.0)
        about = {
            key: str(each[key]).strip() for key in ("id2", "id3", "id4", "id5", "rsp_node", "rsp_dir") if key in each
        }
        about["quantity"] = _QUANTITIES.get(int(each.get("ordinate_spec_data_type") or 0), "unknown")
        channels.append(
            RawChannel(
                name=name,
                values=values[:count],
                unit=None if unit.upper() in ("", "NONE") else unit,
                rate=1.0 / step if even and step > 0 else None,
                start=float(each.get("abscissa_min") or 0.0) if even else None,
                times=None if even else np.asarray(each["x"], np.float64)[:count],
                about=about,
            )
        )
    return RawFile("UFF dataset 58", tuple(channels), other=tuple(other), remarks=tuple(remarks))


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write channels with rates as binary datasets 58 in double precision, see `Format`."""
    need("pyuff")
    import pyuff

    file = pyuff.UFF(str(path))
    for place, each in enumerate(channels):
        values = np.asarray(each.values, np.float64) * float(each.about.get("slope", "1"))
        start = each.start or 0.0
        form = pyuff.prepare_58(
            binary=1,
            id1=each.name,
            id2="run",
            id3=started,
            id4="NONE",
            id5="NONE",
            func_type=_TIME_RESPONSE,
            rsp_node=place + 1,
            rsp_dir=1,
            ref_node=1,
            ref_dir=1,
            data=values,
            x=start + np.arange(len(values)) / (each.rate or 1.0),
            abscissa_spacing=1,
            abscissa_spec_data_type=_TIME,
            abscissa_axis_units_lab="s",
            ordinate_spec_data_type=0,
            ordinate_axis_units_lab=each.unit or "NONE",
            orddenom_spec_data_type=0,
            z_axis_spec_data_type=0,
        )
        # "overwrite" would close and open a binary file anew in the middle of a set and lose its head.
        with warnings.catch_warnings():
            # pyuff leaves the handle of a binary set to the garbage collector.
            warnings.simplefilter("ignore", ResourceWarning)
            file.write_sets(form, "add")


def _begins(head: bytes, suffix: str) -> bool:
    del suffix
    # A line of -1 and nothing else: text may begin with a negative number, too.
    lines = head.split(b"\n", 4)
    return next((line.strip() for line in lines if line.strip()), b"") == b"-1"


FORMAT = Format(
    name="uff",
    label="UFF dataset 58",
    summary="text or binary; first id line as the name, unit of the ordinate, time step",
    suffixes=(".uff", ".unv", ".uf", ".bunv", ".ufb"),
    read=read,
    begins=_begins,
    write=write,
)
