"""Hum of the mains in the channels of a run: found as lines that the motion does not have, and taken off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.fit import Bins, bins_of, noise_of, sinhc
from vines.rig.recording import ROLES, Recording, Sampled

__all__ = ["Hum", "without_hum"]

Floats = npt.NDArray[np.float64]

_MAINS = (50.0, 60.0)
_OFF = 0.2
"""How far the mains may be from their frequency [Hz]: grids keep within a tenth in ordinary operation."""
_TELLING = (1, 2, 3)
"""Harmonics by which hum is found; the others follow."""
_HIGHEST = 800.0
"""[Hz] Above that nothing of it reaches what is fitted."""
_FALSE = 1e-4
"""Chance to see hum in one channel that has none, all its lines together, in a floor of noise."""
_BETA = 18.0
"""Of the Kaiser window: side lobes of 1e-7, for the motion is 1e4 times the noise."""
_LOBE = 6.0
"""Half width of its main lobe, in units of 1/duration."""
_AROUND = 2.0
"""[Hz] Where the floor beside a line is read."""
_LEAST_SHOWN = 0.1
"""Least amplitude relative to the noise of a channel's means, in one of them: what is smaller moves nothing."""
_LEAST_CYCLES = 100
_BLOCK = 3.0
"""[s] In stretches of this length the phase of the mains is read."""
_STEADY = 0.02
"""[rad] So little may the phase wander before it is followed."""
_LONGEST = 6
"""Most periods that a motion repeats after: its lines are multiples of f over so many."""


@dataclass(frozen=True, slots=True)
class Hum:
    """Hum that was taken off.

    Attributes
    ----------
    frequency : float
        Of the mains, mean over the record [Hz].
    lines : mapping
        By the name of a channel, amplitudes in its unit by the number of the harmonic.
    shown : mapping of str to float
        Amplitude of all lines of a channel together, relative to the noise of its means over .3 ms.
    units : mapping of str to str
        Of the channels.
    """

    frequency: float
    lines: Mapping[str, Mapping[int, float]]
    shown: Mapping[str, float]
    units: Mapping[str, str]

    @property
    def text(self) -> str:
        """What was found, in one line."""
        told = []
        for name, lines in self.lines.items():
            number, size = max(lines.items(), key=lambda each: each[1])
            others = ", ".join(str(n) for n in sorted(set(lines) - {number}))
            more = f", and harmonics {others}" if others else ""
            told.append(
                f"{name} {size:.2g} {self.units[name]} at {number * self.frequency:.2f} Hz{more}, "
                f"{self.shown[name]:.2g} times its noise"
            )
        return f"hum of the mains was taken off, {self.frequency:.3f} Hz; {'; '.join(told)}"


def without_hum(recording: Recording, f: float | None) -> tuple[Recording, Hum | None]:
    """Return a recording whose channels have no hum, and what was taken off; the same one where there is none.

    Parameters
    ----------
    recording : Recording
    f : float or None
        Frequency of the forcing [Hz], whose multiples and fractions are the motion's own; None for a free decay.

    Notes
    -----
    A line is found where the power of a tapered Fourier transform stands out of the floor beside it by more than noise
    does with a chance of 1e-4 a channel, unless the motion has lines of its own there. Its phase may wander, as the
    mains do: where it does it is followed in stretches of 3 s, alike for all channels and harmonics. Amplitudes are
    those of the whole record.
    """
    seen = {}
    for channel in recording.channels.values():
        if channel.role.endswith(("disp", "vel", "acc")):
            try:
                bins = bins_of(channel)
            except RigError:
                continue  # what is too short is said where it is used
            if _MAINS[0] * float(bins.t[-1] - bins.t[0]) > _LEAST_CYCLES:
                seen[channel.name] = _even(bins)
    found = [(name, *line) for name, bins in seen.items() if (line := _strongest(bins, f)) is not None]
    if not found:
        return recording, None
    name, mains, number, _ = max(found, key=lambda each: each[3])
    phase = _phase(seen[name], mains, number)
    lines: dict[str, dict[int, float]] = {}
    shown: dict[str, float] = {}
    channels = dict(recording.channels)
    for name, bins in seen.items():
        sizes = _sizes(bins, phase, mains, f)
        if sizes:
            channels[name] = _less(channels[name], phase, sizes)
            lines[name] = {n: abs(size) for n, size in sizes.items()}
            shown[name] = float(np.sqrt(sum(abs(size) ** 2 for size in sizes.values()))) / max(noise_of(bins), 1e-300)
    if max(shown.values(), default=0.0) < _LEAST_SHOWN:
        return recording, None
    ends = seen[next(iter(lines))].t[[0, -1]]
    mean = float(np.diff(phase(ends))[0] / np.diff(ends)[0])
    units = {name: ROLES[channels[name].role][1] for name in lines}
    return replace(recording, channels=channels), Hum(mean / (2 * np.pi), lines, shown, units)


def _even(bins: Bins) -> Bins:
    """Return means without gaps: straight lines over those that are lost."""
    t = np.arange(bins.t[0], bins.t[-1] + 0.5 * bins.width, bins.width)
    return bins if len(t) == len(bins.t) else replace(bins, t=t, mean=np.interp(t, bins.t, bins.mean))


def _spectrum(bins: Bins) -> tuple[Floats, float]:
    """Return the power of the tapered transform, and the distance of its values [Hz]."""
    window = np.kaiser(len(bins.t), _BETA)
    size = np.abs(np.fft.rfft((bins.mean - bins.mean.mean()) * window)) * (2 / window.sum())
    return size**2, 1 / (len(bins.t) * bins.width)


def _strongest(bins: Bins, f: float | None) -> tuple[float, int, float] | None:
    """Return the frequency of the mains by the line that stands out most, its number, and by how much it does."""
    power, step = _spectrum(bins)
    best: tuple[float, int, float] | None = None
    for mains in _MAINS:
        for number in _TELLING:
            line = _line(power, step, (number * mains, number * _OFF), f)
            if line is not None and (best is None or line[1] > best[2]):
                best = (line[0] / number, number, line[1])
    return best


def _line(power: Floats, step: float, where: tuple[float, float], f: float | None) -> tuple[float, float] | None:
    """Return the frequency of the largest line within a band and by how much it stands out; None if that is chance."""
    centre, off = where
    lobe = _LOBE * step
    low, high = int((centre - off) / step), int(np.ceil((centre + off) / step)) + 1
    if high + int((_AROUND + lobe) / step) >= len(power):
        return None
    k = low + int(np.argmax(power[low:high]))
    near, far = int(np.ceil(lobe / step)), int(np.ceil((lobe + _AROUND) / step))
    beside = np.concatenate([power[k - far : k - near], power[k + near + 1 : k + far + 1]])
    # Of an exponential distribution the median is ln 2; a floor with lines of the motion in it is higher.
    floor = float(np.median(beside)) / np.log(2)
    out = float(power[k]) / max(floor, 1e-300)
    looks = len(_MAINS) * len(_TELLING) * (high - low)
    if out < np.log(looks / _FALSE) or not power[k] >= max(power[k - 1], power[k + 1]):
        return None
    here, left, right = np.log(np.maximum(power[[k, k - 1, k + 1]], 1e-300))
    frequency = (k + 0.5 * (left - right) / min(left - 2 * here + right, -1e-12)) * step
    return None if f is not None and _own(power, step, frequency, f) else (float(frequency), out)


def _own(power: Floats, step: float, frequency: float, f: float) -> bool:
    """Say whether a line is the motion's: at a multiple of f, or at one of a fraction of f with others beside it."""
    for part in range(1, _LONGEST + 1):
        apart = f / part
        n = round(frequency / apart)
        if abs(frequency - n * apart) > 1.5 * step:
            continue
        if part == 1:
            return True

        def at(n: int, apart: float = apart) -> float:
            k = round(n * apart / step)
            return float(power[max(k - 1, 0) : k + 2].max(initial=0.0))

        if max(at(n - 1), at(n + 1)) > 0.05 * at(n):
            return True
    return False


class _Phase:
    """Phase of the mains over time: straight, with what was read beside that in between."""

    def __init__(self, omega: float, t: Floats, away: Floats) -> None:
        self.omega, self.t, self.away = omega, t, away

    def __call__(self, t: Floats) -> Floats:
        phase = self.omega * t
        if len(self.t):
            inside = np.interp(t, self.t, self.away)
            first = (self.away[1] - self.away[0]) / (self.t[1] - self.t[0])
            last = (self.away[-1] - self.away[-2]) / (self.t[-1] - self.t[-2])
            inside += first * np.minimum(t - self.t[0], 0.0) + last * np.maximum(t - self.t[-1], 0.0)
            phase = phase + inside
        return phase


def _phase(bins: Bins, mains: float, number: int) -> _Phase:
    """Return the phase of the mains by their strongest line."""
    omega = 2 * np.pi * mains
    turned = bins.mean * np.exp(-1j * number * omega * bins.t)
    size = round(_BLOCK / bins.width)
    begin = np.arange(0, len(turned) - size + 1, size // 4)
    window = np.kaiser(size, 0.6 * _BETA)
    read = np.array([window @ turned[i : i + size] for i in begin])
    t = bins.t[begin] + 0.5 * (size - 1) * bins.width
    if len(t) < 4:
        return _Phase(omega, np.zeros(0), np.zeros(0))
    away = np.unwrap(np.angle(read)) / number
    slope, level = np.polynomial.polynomial.polyfit(t, away, 1)[::-1]
    away = away - level - slope * t
    still = float(np.std(away) * number) < _STEADY
    return _Phase(omega + float(slope), *((np.zeros(0), np.zeros(0)) if still else (t, away)))


def _sizes(bins: Bins, phase: _Phase, mains: float, f: float | None) -> dict[int, complex]:
    """Return the complex amplitudes of the lines that stand out once the mains' phase is known."""
    window = np.kaiser(len(bins.t), _BETA)
    window *= 2 / window.sum()
    turn = np.exp(-1j * phase(bins.t))
    steady = np.fft.fftfreq(len(bins.t), bins.width)
    found: dict[int, complex] = {}
    power = np.ones_like(turn)
    mean = bins.mean - bins.mean.mean()
    step = 1 / (len(bins.t) * bins.width)
    plain, _ = _spectrum(bins)
    near, far = int(np.ceil(_LOBE)), int(np.ceil(_LOBE + _AROUND / step))
    for number in range(1, int(_HIGHEST / mains) + 1):
        power = power * turn
        if f is not None and _own(plain, step, number * mains, f):
            continue
        spectrum = np.fft.fft(mean * window * power)
        beside = np.abs(np.concatenate([spectrum[near:far], spectrum[-far + 1 : -near + 1]])) ** 2
        size = complex(spectrum[0])
        looks = _HIGHEST / _MAINS[0]
        if abs(size) ** 2 > np.log(looks / _FALSE) * float(np.median(beside)) / np.log(2) and len(steady) > 2 * far:
            found[number] = size / sinhc(1j * np.pi * number * mains * bins.width)
    return found


def _less(channel: Sampled, phase: _Phase, sizes: Mapping[int, complex]) -> Sampled:
    """Return a channel without its lines."""
    turn = np.exp(1j * phase(channel.times))
    values, power, last = channel.values.copy(), np.ones_like(turn), 0
    for number, size in sorted(sizes.items()):
        power = power * turn ** (number - last)
        last = number
        values -= (size * power).real
    return replace(channel, values=values)
