"""The synthetic rig while it runs: the same motion and instruments, a piece at a time and without an end."""

from __future__ import annotations

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from vines.errors import ParameterError
from vines.rig.ingest import ChannelRow, RunForm
from vines.rig.synth._contact import damping_table
from vines.rig.synth._instruments import BITS, FULL_SCALE, STEP, G, base_acceleration, position
from vines.rig.synth._kernel import IMPACT, PHASE, ROW, advance
from vines.rig.synth._make import raw_run
from vines.rig.synth._motion import Motion, kernel_parameters, parameter_array
from vines.rig.synth._settings import RigSettings

__all__ = ["LiveRig"]

_PROBED, _SETTLED = 2.0, 20.0
"""Seconds of a run by which a laboratory would choose its ranges, after so many that it settles."""
_MANY = 200_000
_BEHIND = 4e-3
"""[s] Motion that is kept before a piece: sensors are late by less."""


_USUAL: dict[str, object] = {
    "recorders": 1,
    "false": 0.0,
    "dropouts": 0.0,
    "skew": 0.0,
    "E_course": (),
    "r_course": (),
}
"""Settings that need the whole record, and what they are for a rig that goes on."""
_NO_COURSE = np.zeros((2, 0))


class LiveRig:
    """A rig that runs.

    Parameters
    ----------
    settings : RigSettings
        The rig; it starts from `start` and is not let settle unless `settle` says so.
    seed : int
        Of everything that is drawn.

    Attributes
    ----------
    rows : tuple of ChannelRow
        What its laboratory states of the channels.
    form : RunForm
        What it states of the run.
    impacts : int
        How many there were so far.

    Raises
    ------
    ParameterError
        If a rig cannot be so, or a setting is one that needs the whole record.

    Examples
    --------
    >>> rig = LiveRig(RigSettings(rate=12800.0), 1)
    >>> rig.take(1280).shape, [row.name for row in rig.rows]
    ((4, 1280), ['base_disp', 'base_acc', 'lo_disp', 'lo_acc'])
    """

    def __init__(self, settings: RigSettings, seed: int):
        s = settings.check()
        for name, usual in _USUAL.items():
            if getattr(s, name) != usual:
                raise ParameterError(f"synthetic rig, live: {name} is {getattr(s, name)}, allowed is {usual}")
        if s.fault == "clock":
            raise ParameterError("synthetic rig, live: fault is clock, allowed are none, sign and unit")
        probe = raw_run(msgspec.structs.replace(s, settle=_SETTLED, duration=_PROBED), seed)
        self.settings, self.rows, self.form = s, probe.rows, _of_now(probe.form, s)
        self._rng = np.random.default_rng(np.random.SeedSequence([seed, 89]))
        self._step = (1 + 1e-6 * s.ppm) / s.rate
        self._p = kernel_parameters(s, self._rng)
        self._values = parameter_array(self._p)
        self._modes = np.array([complex(-z, np.sqrt(1 - z * z)) * 2 * np.pi * f for f, z, _ in s.modes], np.complex128)
        self._gains = np.zeros((2, len(self._modes)), np.complex128)
        self._gains[0] = [gain for *_, gain in s.modes]
        self._draws = self._rng.normal(0.0, s.sigma_r, _MANY) if s.sigma_r else np.zeros(1)
        self._quiet = self._rng.random(_MANY) < s.missed
        self._state = np.array([*s.start, 0.0, 0.0, -1.0, 0.0, 0.0])
        self._tables = damping_table()
        self._tail = np.empty((5, 0))
        self._number = 0
        self._filter = np.zeros(1)
        self.impacts = 0
        for _ in range(round(s.settle)):
            self._advance(round(s.rate))

    def take(self, count: int) -> npt.NDArray[np.float32]:
        """Let the rig run on for so many samples and return them, in volts, shape (channels, count)."""
        motion = self._advance(count)
        s = self.settings
        # Times of the samples since the first row of the motion.
        t = motion.step * (len(motion.x1) - count + np.arange(count, dtype=np.float64))
        found = np.empty((len(self.rows), count), np.float32)
        for row, out in zip(self.rows, found, strict=True):
            volts = self._seen(row, motion, t)
            if s.fault == "sign" and s.fault_channel == row.name:
                volts = -volts
            volts += self._rng.normal(0.0, 2 * FULL_SCALE / 2**s.enob / np.sqrt(12), count)
            out[:] = STEP * np.clip(np.rint(volts / STEP), -(2 ** (BITS - 1)), 2 ** (BITS - 1) - 1)
        return found

    def _advance(self, count: int) -> Motion:
        """Integrate so many steps; return them with what is kept of those before."""
        out = np.empty((5, count + 1))
        rows = np.full((4000, len(IMPACT)), np.nan)
        self._state[ROW] = -1.0
        found = advance(
            self._state, self._number, count, self._step, self._values, self._draws, self._quiet, *self._tables,
            self._modes, self._gains, _NO_COURSE, _NO_COURSE, self.settings.ball, out, rows,
        )  # fmt: skip
        self._state[PHASE] = 0.0
        self._number += count
        self.impacts += int(found)
        joined = np.concatenate([self._tail, out[:, 1:]], axis=1) if self._tail.size else out[:, 1:].copy()
        kept = min(joined.shape[1], max(8, round(_BEHIND / self._step)))
        first = self._number - joined.shape[1] + 1
        self._tail = joined[:, -kept:].copy()
        return Motion(
            step=self._step, start=first * self._step, x1=joined[0], v1=joined[1], x2=joined[2], v2=joined[3],
            acc=joined[4], impacts=np.empty(0), end=self._state, parameters=self._p, quiet=np.empty(0, bool),
            swell=_NO_COURSE,
        )  # fmt: skip

    def _seen(self, row: ChannelRow, motion: Motion, t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the volts of a sensor, as its sensitivity makes them."""
        s, count = self.settings, len(t)
        stated = float(row.sensitivity)
        faulty = s.fault == "unit" and s.fault_channel == row.name
        if row.role.endswith("disp"):
            true = motion.base(t - s.laser_delay) if row.role == "base_disp" else position(motion, t - s.laser_delay)
            per_metre = stated * 1e3 / (25.4 if faulty else 1.0)
            noise = s.laser_noise * (FULL_SCALE / per_metre / 0.02)
            return (true + self._rng.normal(0.0, noise, count)) * per_metre
        per_g = stated * 1e-3 / (G if faulty else 1.0)
        if row.role == "base_acc":
            true = base_acceleration(s, motion, t)
        else:
            true = motion.acc[-count:] + s.acc_cross_axis * 0.1 * motion.v1[-count:] * self._p["omega"]
            if s.acc_high_pass:
                a = np.exp(-2 * np.pi * s.acc_high_pass * motion.step)
                true, self._filter = lfilter([0.5 * (1 + a), -0.5 * (1 + a)], [1.0, -a], true, zi=self._filter)
        return ((1 + s.acc_gain) * true + self._rng.normal(0.0, s.acc_noise, count)) * (per_g / G)


def _of_now(form: RunForm, s: RigSettings) -> RunForm:
    return msgspec.structs.replace(form, settle=s.settle)
