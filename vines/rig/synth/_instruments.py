"""What the instruments of a synthetic rig make of its motion: sensors, couplings, converters, clocks, their faults."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from vines.rig.synth._motion import LEAD, Motion
from vines.rig.synth._settings import RigSettings

__all__ = [
    "BITS",
    "FULL_SCALE",
    "LEAD",
    "SPARE",
    "STEP",
    "G",
    "Recorder",
    "Signal",
    "base_acceleration",
    "position",
    "recorders",
    "signals",
]

SPARE = 0.1
"""[s] Motion after the last sample."""
GAP = 0.012
"""[s] What the first recorder loses where its clock is planted to be faulty."""
FULL_SCALE = 10.0
BITS = 24
STEP = 2 * FULL_SCALE / 2**BITS
"""[V] One step of the converter."""
G = 9.80665
_DROPOUT = 2e-3
_HEADROOM = 0.9


@dataclass(frozen=True, slots=True)
class Recorder:
    """A recorder: when it takes its samples by the true clock.

    Attributes
    ----------
    name : str
        As in ``channels.tsv``.
    begin, pace : float
        Sample j is taken at begin + j * pace / rate [s], since the start of the motion.
    gap : int
        Samples that it loses.
    """

    name: str
    begin: float
    pace: float
    gap: int = 0

    def times(self, count: int, rate: float, late: float) -> npt.NDArray[np.float64]:
        """Return the true times of its samples, `late` samples after the nominal ones."""
        j = np.arange(count, dtype=np.float64)
        if self.gap:
            j[int(0.4 * count) :] += self.gap
        return self.begin + (j + late) * (self.pace / rate)


@dataclass(frozen=True, slots=True, eq=False)
class Signal:
    """A recorded channel: converter steps, and what the laboratory states of it.

    Attributes
    ----------
    name, role, quantity, dof, sensor : str
        As in ``channels.tsv``.
    recorder : str
        Which one.
    codes : ndarray of int32, shape (n,)
        Steps of the converter.
    sensitivity, unit : float, str
        As stated.
    u_sensitivity, group_delay, u_delay, high_pass : float
        As stated.
    late : float
        By how many samples it comes after the first channel of its recorder.
    """

    name: str
    role: Literal["base_disp", "base_acc", "lo_disp", "lo_acc"]
    quantity: Literal["displacement", "acceleration"]
    dof: str
    sensor: str
    recorder: str
    codes: npt.NDArray[np.int32]
    sensitivity: float
    unit: str
    u_sensitivity: float
    group_delay: float
    u_delay: float
    high_pass: float
    late: float


def recorders(s: RigSettings) -> tuple[Recorder, ...]:
    """Return the recorders of a rig."""
    gap = round(GAP * s.rate) if s.fault == "clock" else 0
    daq = Recorder("daq", LEAD, 1 + 1e-6 * s.ppm, gap)
    if s.recorders == 1:
        return (daq,)
    return daq, Recorder("vibrometer", LEAD + s.offset_second, 1 + 1e-6 * s.ppm_second)


def signals(s: RigSettings, motion: Motion, rng: np.random.Generator) -> tuple[Signal, ...]:
    """Return what is recorded of a motion."""
    boxes = list(recorders(s))
    wanted = [(name, boxes[-1] if name.endswith("disp") else boxes[0]) for name in s.channels]
    if len(boxes) > 1:
        wanted.append(("base_sync", boxes[1]))
    # The accelerometers' recorder comes first: its clock is that of the run.
    wanted.sort(key=lambda each: each[1] is not boxes[0])
    drawn = _Drawn.of(s, rng)
    found: list[Signal] = []
    for box in boxes:
        mine = [name for name, where in wanted if where is box]
        for place, name in enumerate(mine):
            late = s.skew * place / max(len(mine) - 1, 1)
            found.append(_signal(s, name, box, late, motion, drawn, rng))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class _Drawn:
    """Errors that are the same for all samples."""

    base_gain: float
    lo_gain: float
    delay_error: float
    corner_error: float

    @classmethod
    def of(cls, s: RigSettings, rng: np.random.Generator) -> _Drawn:
        return cls(s.acc_gain, -s.acc_gain * rng.uniform(-1, 1), rng.normal(0, 1e-6), rng.normal(0, 0.005))


def _signal(
    s: RigSettings, name: str, box: Recorder, late: float, motion: Motion, drawn: _Drawn, rng: np.random.Generator
) -> Signal:
    count = round(s.duration * s.rate)
    t = box.times(count, s.rate, late)
    if name.endswith("disp"):
        base = name.startswith("base")
        delayed = t - s.laser_delay
        true = motion.base(delayed) if base else position(motion, delayed)
        span = _span(float(np.abs(true).max()))
        noise = s.laser_noise * (span / 0.02)
        seen = true + s.laser_linearity * span * np.sin(2 * np.pi * true / span) / 2
        seen += rng.normal(0.0, noise, count)
        volts = seen * (FULL_SCALE / span)
        if not base:
            _drop(volts, s, rng)
        stated = FULL_SCALE / (span * 1e3)
        about = ("displacement", "V/mm", 0.002, s.laser_delay + drawn.delay_error, 2e-6, 0.0)
        sensor = f"laser triangulation, +-{1e3 * span:g} mm"
    else:
        base = name.startswith("base")
        gain = 1 + (drawn.base_gain if base else drawn.lo_gain)
        true = base_acceleration(s, motion, t) if base else _lo_acceleration(s, motion, t, rng)
        seen = gain * true + rng.normal(0.0, s.acc_noise, count)
        per_g = _volts_per_g(float(np.abs(seen).max()), base)
        volts = seen * (per_g / G)
        stated = 1e3 * per_g
        # The converter integrates over its sample time.
        delay = 0.0 if base else 0.5 / s.rate
        about = ("acceleration", "mV/g", 0.01, delay, 1e-6, s.acc_high_pass * (1 + drawn.corner_error))
        sensor = f"IEPE accelerometer, {stated:g} mV/g"
    if s.fault == "unit" and s.fault_channel == name:
        stated *= 25.4 if name.endswith("disp") else G
    if s.fault == "sign" and s.fault_channel == name:
        volts = -volts
    volts += rng.normal(0.0, 2 * FULL_SCALE / 2**s.enob / np.sqrt(12), count)
    codes = np.clip(np.rint(volts / STEP), -(2 ** (BITS - 1)), 2 ** (BITS - 1) - 1).astype(np.int32)
    role: Any = "base_acc" if name == "base_sync" else name
    return Signal(
        name=name, role=role, quantity=about[0], dof="e" if base else "x1", sensor=sensor, recorder=box.name,
        codes=codes, sensitivity=stated, unit=about[1], u_sensitivity=about[2], group_delay=about[3], u_delay=about[4],
        high_pass=about[5], late=late,
    )  # fmt: skip


def position(motion: Motion, t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return x1 at any times, by cubic Hermite interpolation."""
    place = t / motion.step
    i = np.clip(place.astype(np.intp), 0, len(motion.x1) - 2)
    u = place - i
    a, b = motion.x1[i], motion.x1[i + 1]
    da, db = motion.v1[i] * motion.step, motion.v1[i + 1] * motion.step
    return a + u * (da + u * (3 * (b - a) - 2 * da - db + u * (da + db - 2 * (b - a))))


def base_acceleration(s: RigSettings, motion: Motion, t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the acceleration of the base after the high-pass, which a sine passes with a gain and an advance."""
    if not s.acc_high_pass:
        return motion.base(t, 2)
    p = motion.parameters
    total = np.zeros_like(t)
    for n, part, shift in ((1, 1.0, 0.0), (2, p["h2"], p["phi2"]), (3, p["h3"], p["phi3"])):
        omega = n * p["omega"]
        ratio = 2 * np.pi * s.acc_high_pass / omega
        size = -p["E"] * part * omega**2 / np.hypot(1.0, ratio)
        if size:
            total += size * np.sin(omega * (t + motion.start) + n * p["phi"] + shift + np.arctan(ratio))
    return total * motion.swollen(t)


def _lo_acceleration(
    s: RigSettings, motion: Motion, t: npt.NDArray[np.float64], rng: np.random.Generator
) -> npt.NDArray[np.float64]:
    """Return what the oscillator's accelerometer gives: missed impacts, knocks, cross-axis motion, and its coupling."""
    acc = motion.acc.copy()
    h = motion.step
    for k in np.flatnonzero(motion.quiet):
        i, j = int(motion.impacts["t"][k] / h), int(np.nan_to_num(motion.impacts["t_end"][k], nan=0.0) / h) + 2
        if 0 < i < j < len(acc):
            acc[i : j + 1] = np.linspace(acc[i], acc[j], j - i + 1)
    knocks = rng.poisson(s.false * len(motion.impacts))
    typical = np.median(np.abs(motion.impacts["w_dot"])) * (1 + s.r) * s.m / (s.M + s.m) if len(motion.impacts) else 0.0
    for begin in rng.uniform(0.0, len(acc) * h, knocks):
        i = int(begin / h) + 1
        n = min(round(0.02 / h), len(acc) - i)
        tau = np.arange(n) * h + (i * h - begin)
        size = typical * rng.uniform(0.3, 1.0) * rng.choice([-1.0, 1.0])
        for f, z, gain in s.modes:
            omega = 2 * np.pi * f
            acc[i : i + n] += size * gain * omega * np.exp(-z * omega * tau) * np.sin(omega * np.sqrt(1 - z * z) * tau)
    if s.acc_cross_axis:
        # Across the axis the frame sways by a tenth, a quarter period late.
        acc += s.acc_cross_axis * 0.1 * motion.v1 * motion.parameters["omega"]
    if s.acc_high_pass:
        a = np.exp(-2 * np.pi * s.acc_high_pass * h)
        acc = np.asarray(lfilter([0.5 * (1 + a), -0.5 * (1 + a)], [1.0, -a], acc))
    place = t / h
    i = np.clip(place.astype(np.intp), 0, len(acc) - 2)
    u = place - i
    return acc[i] * (1 - u) + acc[i + 1] * u


def _drop(volts: npt.NDArray[np.float64], s: RigSettings, rng: np.random.Generator) -> None:
    """Let the laser lose its target now and then: its output goes to the end of its range."""
    for begin in rng.uniform(0.0, s.duration, rng.poisson(s.dropouts * s.duration / 60)):
        i = int(begin * s.rate)
        volts[i : i + max(1, round(_DROPOUT * s.rate))] = 1.05 * FULL_SCALE


def _span(largest: float) -> float:
    """Return the range of the laser that a laboratory would choose [m]."""
    return next((span for span in (1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1) if largest < _HEADROOM * span), 0.2)


def _volts_per_g(largest: float, base: bool) -> float:
    """Return the sensitivity of the accelerometer that a laboratory would choose [V/g]."""
    choices = (1.0, 0.1, 0.01, 0.001) if base else (0.1, 0.01, 0.001)
    return next((each for each in choices if largest * each / G < _HEADROOM * FULL_SCALE), 0.001)
