"""One channel from the numbers of its file to SI: unit, sensitivity, sign, rate, clipping, coupling and delay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.formats import RawChannel
from vines.rig.ingest._run_form import ChannelRow
from vines.rig.recording import ROLES
from vines.rig.units import si_factor, volts_per_unit

__all__ = ["U_CORNER", "Calibrated", "calibrate", "even_rate"]

U_CORNER = 0.01
"""Relative standard uncertainty of the corner of a high-pass: of a calibrated conditioner, about a per cent."""

_RATE_AGREES = 2e-5
"""Relative difference between a stated rate and that of a file that is taken for rounding: UFF58 keeps six digits."""
_EVEN = 0.02
"""Largest error of a time stamp, in samples, that is taken for rounding."""
_FULL = 0.9999
_GUARD = 2
_FLAT = 3


@dataclass(frozen=True, slots=True, eq=False)
class Calibrated:
    """A channel in SI units on the clock of its own recorder.

    Attributes
    ----------
    row : ChannelRow
        What is known of it.
    values : ndarray of float64, shape (n,)
        In the SI unit of its role, positive to the right, high-pass undone.
    valid : ndarray of bool, shape (n,)
        False where it was clipped, and two samples about.
    rate, start : float
        Samples a second and time of the first one [s], group delay taken off.
    clipped : int
        Samples at the end of the range, or lost.
    """

    row: ChannelRow
    values: npt.NDArray[np.float64]
    valid: npt.NDArray[np.bool_]
    rate: float
    start: float
    clipped: int

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """Times of the samples on the clock of the recorder [s]."""
        return self.start + np.arange(len(self.values)) / self.rate


def calibrate(row: ChannelRow, raw: RawChannel, *, max_clipped: float) -> Calibrated:
    """Return a channel in SI units.

    Parameters
    ----------
    row : ChannelRow
        Its row of ``channels.tsv``.
    raw : RawChannel
        What its file holds.
    max_clipped : float
        Share of clipped samples above which it is refused.

    Raises
    ------
    RigError
        If what is stated contradicts the file, samples are missing, their times uneven, or too many clipped.
    """
    where = f"{row.name} (raw/{row.file}, {row.field})"
    if raw.values.ndim != 1 or not len(raw.values):
        raise RigError(f"{where}: it holds no samples")
    values = np.asarray(raw.values, np.float64)
    bad = ~np.isfinite(values)
    if bad.any():
        raise RigError(
            f"{where}: {int(bad.sum())} of {len(bad)} samples are NaN or infinite, the first at {int(bad.argmax())}; "
            "raw samples must be numbers: a lost one is written as out of range"
        )
    factor = _si_per_unit(row, raw, where)
    rate = _rate(row, raw, where)
    start = _start(row, raw, where)
    lost = _clipped(values, row.range)
    share = lost.mean()
    if share > max_clipped:
        raise RigError(
            f"{where}: {share:.2%} of the samples are clipped at {row.range:g} {row.unit}, allowed is "
            f"{max_clipped:.2%} (max_clipped in run.json); record again with a larger range"
        )
    valid = np.ones(len(values), bool)
    if lost.any():
        places = np.flatnonzero(lost)
        for shift in range(-_GUARD, _GUARD + 1):
            valid[np.clip(places + shift, 0, len(valid) - 1)] = False
    values = values * (factor * float(row.sign))
    if row.high_pass:
        values = _undo_high_pass(values, row.high_pass, rate, valid)
    return Calibrated(row, values, valid, rate, start - row.group_delay, int(lost.sum()))


def _si_per_unit(row: ChannelRow, raw: RawChannel, where: str) -> float:
    """Return what one unit of the numbers in the file is in the SI unit of the role."""
    quantity, factor = si_factor(row.unit)
    if raw.unit is not None and si_factor(raw.unit) != (quantity, factor):
        raise RigError(f"{where}: channels.tsv says that its unit is {row.unit}, the file says {raw.unit}; correct one")
    wanted, unit = ROLES[row.role]
    if row.sensitivity == "scaled":
        if quantity != wanted:
            raise RigError(
                f"{where}: {row.unit} is a {quantity}, but {row.role} is a {wanted} [{unit}]: give its sensitivity"
            )
        return factor
    if quantity != "voltage":
        raise RigError(
            f"{where}: a sensitivity is given, but the numbers in the file are {row.unit}, not volts; write scaled "
            "if they are calibrated already"
        )
    measured, volts = volts_per_unit(row.sensitivity, row.sensitivity_unit)
    if measured != wanted:
        raise RigError(f"{where}: {row.sensitivity_unit} is of a sensor of {measured}, but {row.role} is a {wanted}")
    return factor / volts


def even_rate(times: npt.NDArray[np.float64], where: str) -> float:
    """Return the rate of time stamps.

    Raises
    ------
    RigError
        If they are not even: a sample is missing, doubled or late.
    """
    if len(times) < 2 or not np.isfinite(times).all() or not times[-1] > times[0]:
        raise RigError(f"{where}: its time stamps don't rise; a rate cannot be taken from them")
    # The median step keeps one gap from looking like many small errors.
    step = float(np.median(np.diff(times[: min(len(times), 4096)])))
    mean = (times[-1] - times[0]) / (len(times) - 1)
    if step > 0 and abs(mean - step) < _EVEN * step / 4:
        step = float(mean)
    if not step > 0:
        raise RigError(f"{where}: its time stamps don't rise; a rate cannot be taken from them")
    error = np.abs(times - times[0] - step * np.arange(len(times)))
    worst = float(error.max())
    if worst > _EVEN * step + 1e-9:
        place = int(np.argmax(error > _EVEN * step + 1e-9))
        raise RigError(
            f"{where}: time stamps are not even: sample {place} is {error[place] / step:.3g} sampling intervals off; "
            "resample, or give the runs before and after the gap as two"
        )
    return 1.0 / step


def _rate(row: ChannelRow, raw: RawChannel, where: str) -> float:
    """Return the sampling rate, where table and file agree on it."""
    told = raw.rate if raw.times is None else even_rate(raw.times, where)
    if row.fs == "file":
        if told is None:
            raise RigError(f"{where}: no sampling rate: fs is file, but the file states none; write it in Hz")
        return told
    if told is not None and abs(told / row.fs - 1) > _RATE_AGREES:
        raise RigError(
            f"{where}: channels.tsv says {row.fs:.9g} samples a second, the file {told:.9g}; one of them is wrong"
        )
    return row.fs


def _start(row: ChannelRow, raw: RawChannel, where: str) -> float:
    """Return the time of the first sample on the clock of the recorder."""
    if row.t0 != "file":
        return row.t0
    if raw.times is not None:
        return float(raw.times[0])
    if raw.start is None:
        raise RigError(f"{where}: t0 is file, but the file does not say when the channel starts; write it in seconds")
    return raw.start


def _clipped(values: npt.NDArray[np.float64], limit: float) -> npt.NDArray[np.bool_]:
    """Return where samples are at the end of the range, or stay at the largest or least value for three and more."""
    lost = np.abs(values) >= _FULL * limit
    for extreme in (values.max(), values.min()):
        if abs(extreme) < 0.05 * limit:
            continue
        flat = values == extreme
        if flat.sum() >= _FLAT:
            inner = flat.copy()
            for shift in range(1, _FLAT):
                inner[: len(flat) - shift] &= flat[shift:]
                inner[len(flat) - shift :] = False
            for shift in range(_FLAT):
                lost[shift:] |= inner[: len(flat) - shift]
    return lost


def _undo_high_pass(
    values: npt.NDArray[np.float64], corner: float, rate: float, valid: npt.NDArray[np.bool_]
) -> npt.NDArray[np.float64]:
    """Return what went into a first-order high-pass: the output plus its integral times the corner frequency.

    The mean of the output is offset of the electronics and would be integrated to a ramp; the slow random walk of the
    integrated noise is taken out with a straight line.
    """
    steady = values - (values.mean() if valid.all() else values[valid].mean())
    ramp = np.cumsum(steady)
    ramp -= 0.5 * steady
    ramp *= 2 * np.pi * corner / rate
    n = len(ramp)
    line = np.linspace(-1.0, 1.0, n)
    slope = float(line @ ramp) / float(line @ line)
    ramp -= ramp.mean() + slope * line
    steady += ramp
    return steady
