"""When the samples of a channel were taken: rates and starts that are stated, against what the file says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.formats import RawChannel
from vines.rig.ingest._overrule import Overruling
from vines.rig.ingest._run_form import ChannelRow

__all__ = ["Sampling", "check_starts", "even_rate", "sampling"]

_RATE_AGREES = 2e-5
"""Relative difference between a stated rate and that of a file that is taken for rounding: UFF58 keeps six digits."""
_EVEN = 0.02
"""Largest error of a time stamp, in samples, that is taken for rounding."""
_EXACT = 1e-3
"""Relative error of the interval between two stamps that say the sampling interval as they stand."""
_MOST = 0.9
_BLOCK = 64
_DECIMALS = 10
_TICKS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "days": 86400.0}


@dataclass(frozen=True, slots=True)
class Sampling:
    """Rate and start of a channel.

    Attributes
    ----------
    rate, start : float
        Samples a second; time of the first on the clock of its recorder [s].
    remarks : tuple of str
        What was concluded and has to be known.
    """

    rate: float
    start: float
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Told:
    """A rate as a file says it, by which part of it rounding of its times may have changed it, and their unit [s]."""

    rate: float
    u: float = 0.0
    tick: float = 1.0
    unit: str = "s"


def even_rate(times: npt.NDArray[np.float64], where: str) -> float:
    """Return the rate of time stamps.

    Raises
    ------
    RigError
        If they are not even: a sample is missing, doubled or late; or if they are rounded so that they leave it open.
    """
    told = _stamps_rate(times, where)
    if told.u > _RATE_AGREES:
        _refuse_rounded(told, where)
    return told.rate


def _refuse_rounded(told: _Told, where: str) -> NoReturn:
    raise RigError(
        f"{where}: its time stamps are rounded and tell the rate, about {told.rate:.6g} Hz, to {told.u:.2g} only; "
        "write fs in Hz"
    )


def _stamps_rate(times: npt.NDArray[np.float64], where: str) -> _Told:
    """Return the rate of even time stamps."""
    n = len(times)
    if n < 2 or not np.isfinite(times).all() or not times[-1] > times[0]:
        raise RigError(f"{where}: its time stamps don't rise; a rate cannot be taken from them")
    # Medians of blocks keep one gap from looking like many small errors, and rounding from deciding.
    block = min(_BLOCK, n - 1)
    step = float(np.median(times[block:] - times[:-block])) / block
    if not step > 0:
        raise RigError(f"{where}: its time stamps don't rise; a rate cannot be taken from them")
    exact = np.mean(np.abs(np.diff(times) - step) < _EXACT * step) > _MOST
    rounding = 0.0 if exact else _rounding(times)
    allowed = _EVEN * step + rounding + 1e-9
    for pace in (float(times[-1] - times[0]) / (n - 1), step):
        error = np.abs(times - times[0] - pace * np.arange(n))
        if error.max() <= allowed:
            return _Told(1.0 / pace, rounding / float(times[-1] - times[0]))
    place = int(np.argmax(error > allowed))
    raise RigError(
        f"{where}: time stamps are not even: sample {place} is {error[place] / step:.3g} sampling intervals off; "
        "resample, or give the runs before and after the gap as two"
    )


def _rounding(times: npt.NDArray[np.float64]) -> float:
    """Return to what the last time stamps are rounded, which have most digits before the point; 0 if to no decimal."""
    last = times[-_BLOCK:]
    for decimals in range(_DECIMALS):
        scaled = last * 10.0**decimals
        if np.abs(scaled - np.rint(scaled)).max() < max(1e-6, 4 * np.spacing(np.abs(scaled).max())):
            return 10.0**-decimals
    return 0.0


def sampling(row: ChannelRow, raw: RawChannel, where: str, overruling: Overruling) -> Sampling:
    """Return rate and start of a channel, where table and file agree or the file is overruled.

    Raises
    ------
    RigError
        If they contradict each other, neither says it, or the times have no unit.
    """
    told = None
    try:
        told = _told(row, raw, where)
    except RigError as wrong:
        if row.fs == "file" or not overruling.take("fs", str(wrong).removeprefix(f"{where}: ").split(";")[0]):
            raise
    if row.fs == "file":
        if told is None:
            raise RigError(f"{where}: no sampling rate: fs is file, but the file states none; write it in Hz")
        if told.u > _RATE_AGREES:
            _refuse_rounded(told, where)
        return Sampling(told.rate, _start(row, raw, where, told.tick))
    if told is not None and abs(told.rate / row.fs - 1) > _RATE_AGREES + told.u:
        if not overruling.take("fs", f"the file says {told.rate:.9g} Hz, {row.fs:.9g} is taken"):
            raise RigError(
                f"{where}: channels.tsv says {row.fs:.9g} samples a second, the file {told.rate:.9g}; one of them is "
                "wrong: correct fs, or write 'fs: REASON' into overrule"
            )
        told = None
    tick = None if told is None else told.tick
    remark = () if told is None or raw.tick is not None else (f"times without a unit fit fs as {told.unit}",)
    return Sampling(row.fs, _start(row, raw, where, tick), remark)


def _told(row: ChannelRow, raw: RawChannel, where: str) -> _Told | None:
    """Return the rate that a file says, by its times or as it states it; None if it says none.

    Raises
    ------
    RigError
        If it contradicts itself, or its times have no unit and don't fit the stated rate in any.
    """
    if raw.times is None:
        return None if raw.rate is None else _Told(raw.rate)
    if raw.tick is None and row.fs == "file":
        raise RigError(f"{where}: its times have no unit: write time_unit=s, ms or the like into dialect, or fs in Hz")
    found = _stamps_rate(raw.times, where)
    if raw.tick is None and row.fs != "file":
        fits = {**_TICKS, "samples": 1.0 / row.fs}
        near = [name for name, size in fits.items() if abs(found.rate / size / row.fs - 1) < _RATE_AGREES + found.u]
        if not near:
            raise RigError(
                f"{where}: its times have no unit and rise by {1 / found.rate:.6g} a sample, which fits fs = "
                f"{row.fs:.9g} Hz in none of {', '.join(fits)}; correct fs, or write 'fs: REASON' into overrule"
            )
        found = replace(found, rate=found.rate / fits[near[0]], tick=fits[near[0]], unit=near[0])
    if raw.rate is None:
        return found
    if abs(found.rate / raw.rate - 1) > _RATE_AGREES + found.u:
        raise RigError(
            f"{where}: the file states {raw.rate:.9g} samples a second, but its times have {found.rate:.9g}; write the "
            "right fs, and 'fs: REASON' into overrule"
        )
    return replace(found, rate=raw.rate, u=0.0)


def _start(row: ChannelRow, raw: RawChannel, where: str, tick: float | None) -> float:
    """Return the time of the first sample on the clock of the recorder, of the file's times where `tick` is known."""
    if row.t0 != "file":
        return row.t0
    if raw.times is not None:
        if tick is None and raw.times[0] != 0:
            raise RigError(f"{where}: t0 is file, but its times are overruled or have no unit; write it in seconds")
        return float(raw.times[0]) * (tick or 1.0)
    if raw.start is None:
        raise RigError(f"{where}: t0 is file, but the file does not say when the channel starts; write it in seconds")
    return raw.start


def check_starts(channels: Sequence[tuple[ChannelRow, RawChannel, Overruling]]) -> None:
    """Refuse channels of one file whose starts differ by other than the file says.

    Raises
    ------
    RigError
        One line with both differences.
    """
    first: dict[str, tuple[ChannelRow, float]] = {}
    for row, raw, overruling in channels:
        told = raw.start if raw.times is None or raw.tick is None else float(raw.times[0]) * raw.tick
        rate = raw.rate if row.fs == "file" else row.fs
        if told is None or row.t0 == "file":
            continue
        other, known = first.setdefault(row.file, (row, told))
        assert other.t0 != "file"
        apart, stated = told - known, row.t0 - other.t0
        if abs(apart - stated) <= _EVEN / (rate or 1e9) + 1e-9:
            continue
        what = f"the file says that {row.name} begins {apart:.6g} s after {other.name}, t0 says {stated:.6g} s"
        if not overruling.take("t0", what):
            raise RigError(f"{row.where}: {what}; write file for t0, or 't0: REASON' into overrule")
