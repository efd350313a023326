"""One channel from the numbers of its file to SI: unit, sensitivity, sign, rate, clipping, coupling and delay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import binary_dilation

from vines.errors import RigError
from vines.rig.formats import RawChannel
from vines.rig.ingest._clipping import clipped_samples
from vines.rig.ingest._frames import frames_lost
from vines.rig.ingest._lost import lost_signal
from vines.rig.ingest._overrule import Overruling
from vines.rig.ingest._run_form import ChannelRow
from vines.rig.ingest._sampling import sampling
from vines.rig.recording import ROLES
from vines.rig.units import si_factor, volts_per_unit

__all__ = ["U_CORNER", "Calibrated", "calibrate"]

U_CORNER = 0.01
"""Relative standard uncertainty of the corner of a high-pass: of a calibrated conditioner, about a per cent."""

_GUARD = 2

_BY_LIGHT = ("base_disp", "base_vel", "lo_disp", "lo_vel")
"""Roles of lasers, which lose their target; shocks make an acceleration as wild as that."""


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
    remarks : tuple of str
        What was concluded from its file and has to be known.
    bursts : str
        Stretches in which a laser had lost its target, in words.
    """

    row: ChannelRow
    values: npt.NDArray[np.float64]
    valid: npt.NDArray[np.bool_]
    rate: float
    start: float
    clipped: int
    remarks: tuple[str, ...] = ()
    bursts: str = ""

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """Times of the samples on the clock of the recorder [s]."""
        return self.start + np.arange(len(self.values)) / self.rate


def calibrate(
    row: ChannelRow, raw: RawChannel, *, max_clipped: float, overruling: Overruling | None = None
) -> Calibrated:
    """Return a channel in SI units.

    Parameters
    ----------
    row : ChannelRow
        Its row of ``channels.tsv``.
    raw : RawChannel
        What its file holds.
    max_clipped : float
        Share of clipped samples above which it is refused.
    overruling : Overruling, optional
        Reasons for what contradicts the file; what was used of them is noted in it.

    Raises
    ------
    RigError
        If what is stated contradicts the file, samples are missing, their times uneven, or too many clipped.
    """
    where = row.where
    overruling = overruling or Overruling(row.overrule)
    if raw.values.ndim != 1 or not len(raw.values):
        raise RigError(f"{where}: it holds no samples")
    values = np.asarray(raw.values, np.float64)
    camera = row.role == "ball_cam"
    bad = ~np.isfinite(values)
    if bad.any() and not camera:
        first = raw.about.get("no number", f"number {int(bad.argmax())}")
        raise RigError(
            f"{where}: {int(bad.sum())} of {len(bad)} samples are NaN or infinite, the first is {first}; "
            "raw samples must be numbers: a lost one is written as out of range"
        )
    factor = _si_per_unit(row, raw, where, overruling)
    if row.scale != 1 or row.offset:
        values = values * row.scale + row.offset
    found = sampling(row, raw, where, overruling)
    rate = found.rate
    # A temperature stays where it is for long, without being clipped.
    still = row.role == "temperature"
    if camera:
        values, lost = frames_lost(values, where, row.range)
    else:
        lost = np.abs(values) >= row.range if still else clipped_samples(values, row.range)
    share = lost.mean()
    gone = _no_signal(values, lost) if row.role in _BY_LIGHT else None
    if share > max_clipped and not camera:
        raise RigError(
            f"{where}: {share:.2%} of the samples are clipped at {row.range:g} {row.unit}, allowed is "
            f"{max_clipped:.2%} (max_clipped in run.json); record again with a larger range"
        )
    remarks = found.remarks
    clipped = int(lost.sum())
    bursts = "" if gone is None else _told(lost, *gone, rate)
    if gone is not None and bursts:
        lost = lost | gone[0] | gone[1]
        remarks = (*remarks, bursts)
        if lost.mean() > max_clipped:
            raise RigError(
                f"{where}: {bursts}; {lost.mean():.2%} of the samples are without signal, allowed is {max_clipped:.2%} "
                "(max_clipped in run.json): see to the laser's target and record again"
            )
    valid = np.ones(len(values), bool)
    if lost.any():
        places = np.flatnonzero(lost)
        guard = 0 if camera else _GUARD
        for shift in range(-guard, guard + 1):
            valid[np.clip(places + shift, 0, len(valid) - 1)] = False
    values = values * (factor * float(row.sign))
    if row.high_pass:
        values = _undo_high_pass(values, row.high_pass, rate, valid)
    return Calibrated(row, values, valid, rate, found.start - row.group_delay, clipped, remarks, bursts)


def _no_signal(
    values: npt.NDArray[np.float64], out: npt.NDArray[np.bool_]
) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Return which samples are held and which wild; the way out of the range and back is neither."""
    found = lost_signal(values)
    near: npt.NDArray[np.bool_] = np.asarray(binary_dilation(out, iterations=_GUARD), np.bool_)
    return found.held & ~near, found.wild & ~near


def _told(out: npt.NDArray[np.bool_], held: npt.NDArray[np.bool_], wild: npt.NDArray[np.bool_], rate: float) -> str:
    """Say how often and how long a laser was lost; nothing where it never was."""
    parts = []
    for which, what in ((out, "out of range"), (held, "held"), (wild, "wild")):
        if which.any():
            count = int(np.count_nonzero(np.diff(which.astype(np.int8)) == 1) + which[0])
            parts.append(f"{count} {what} ({which.sum() / rate:.3g} s)")
    if not parts:
        return ""
    share = float((out | held | wild).mean())
    return f"the laser was lost in stretches, {', '.join(parts)}, {share:.2%} of the record"


def _si_per_unit(row: ChannelRow, raw: RawChannel, where: str, overruling: Overruling) -> float:
    """Return what one unit of the numbers, scale applied, is in the SI unit of the role."""
    try:
        quantity, factor = si_factor(row.unit)
    except RigError as unknown:
        raise RigError(f"{where}: channels.tsv: {unknown}") from None
    _check_unit(row, raw, (quantity, factor), where, overruling)
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


def _check_unit(
    row: ChannelRow, raw: RawChannel, stated: tuple[str, float], where: str, overruling: Overruling
) -> None:
    """Refuse a unit of the file that is not the one stated, unless it is overruled or the numbers are scaled counts."""
    if raw.unit is None:
        return
    scaled = row.scale != 1
    remedy = "correct unit, or write 'unit: REASON' into overrule"
    try:
        told = si_factor(raw.unit)
    except RigError as unknown:
        told, why = None, f"the file's {unknown}"
    else:
        why = f"channels.tsv says that its unit is {row.unit}, the file says {raw.unit}"
        if told[0] == "count" and not scaled:
            remedy = "write what one count is into scale"
        elif scaled and told[0] != "count":
            why = f"scale is {row.scale:g}, but the file holds {raw.unit} and no counts"
    fits = told is not None and (told[0] == "count" if scaled else told == stated)
    if not fits and not overruling.take("unit", f"the file says {raw.unit}, {row.unit} is taken"):
        raise RigError(f"{where}: {why}; {remedy}")


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
