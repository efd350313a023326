"""WAV: whole numbers without units; a sidecar ``<file>.json`` names the channels and says what full scale is.

The sidecar is ``{"channels": [{"name": ..., "unit": "V", "full_scale": 10.0, "start": 0.0}, ...], "started": ...}``.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from vines.errors import RigError
from vines.packages import need
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["FORMAT", "read", "sidecar", "write"]


def sidecar(path: Path) -> Path:
    """Return the name of a file's sidecar.

    Examples
    --------
    >>> sidecar(Path("raw/run.wav")).name
    'run.wav.json'
    """
    return path.with_name(path.name + ".json")


def read(path: Path) -> RawFile:
    """Read a file; without a sidecar its channels are numbered, have no unit, and are parts of full scale."""
    need("soundfile")
    import soundfile

    values, rate = soundfile.read(str(path), dtype="float64", always_2d=True)
    told, started = _told(path, values.shape[1])
    channels = []
    for place, about in enumerate(told):
        column = np.ascontiguousarray(values[:, place])
        full = about.get("full_scale")
        channels.append(
            RawChannel(
                name=str(about.get("name", place + 1)),
                values=column if full is None else column * float(full),
                unit=about.get("unit") if full is not None else None,
                rate=float(rate),
                start=None if about.get("start") is None else float(about["start"]),
                about={} if full is None else {"full_scale": f"{float(full):g}"},
            )
        )
    return RawFile("WAV", tuple(each for each in channels if len(each.values)), started)


def _told(path: Path, count: int) -> tuple[list[dict[str, Any]], str | None]:
    """Return what the sidecar says of each channel."""
    place = sidecar(path)
    if not place.is_file():
        return [{} for _ in range(count)], None
    try:
        form = json.loads(place.read_text("utf-8"))
        told = [dict(each) for each in form["channels"]]
        for each in told:
            float(each["full_scale"])
            str(each["name"])
    except (ValueError, KeyError, TypeError) as unfit:
        raise RigError(f"its sidecar {place.name} does not say name and full_scale of each channel ({unfit})") from None
    if len(told) != count:
        raise RigError(f"its sidecar {place.name} describes {len(told)} channels, the file has {count}")
    return told, form.get("started")


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write int32 steps of at most 24 bit, of channels equally long, and the sidecar, see `Format`."""
    need("soundfile")
    import soundfile

    # libsndfile keeps the upper 24 of 32 bits.
    columns = np.stack([np.asarray(each.values, np.int32) << 8 for each in channels], axis=1)
    soundfile.write(str(path), columns, round(channels[0].rate or 0.0), subtype="PCM_24")
    told = [
        {"name": each.name, "unit": each.unit, "full_scale": float(each.about["slope"]) * 2**23, "start": each.start}
        for each in channels
    ]
    sidecar(path).write_text(json.dumps({"started": started, "channels": told}, indent=1) + "\n", encoding="utf-8")


def _begins(head: bytes, suffix: str) -> bool:
    del suffix
    return head.startswith((b"RIFF", b"RIFX", b"RF64"))


FORMAT = Format(
    name="wav",
    label="WAV",
    summary="rate; the sidecar `<file>.json` gives name, unit and full scale of each channel",
    suffixes=(".wav", ".wave"),
    read=read,
    begins=_begins,
    write=write,
)
