"""The fundamental of a channel, block by block: what clocks are aligned and channels compared with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Tone", "find_tone"]

_DECIMATED = 1024.0
"""[Hz] Samples are averaged in groups down to about this rate; no fundamental of a rig is near half of it."""
_LOWEST, _HIGHEST = 0.5, 200.0
_PERIODS = 8
_SHORTEST = 0.5


_MANY = 5
_STEADY = 0.1
"""[rad] Blocks of noise alone scatter by ten times that."""


@dataclass(frozen=True, slots=True, eq=False)
class Tone:
    """A sine in a channel.

    Attributes
    ----------
    f : float
        Frequency [Hz] by the clock of the channel.
    amplitude : float
        In the unit of the channel.
    phase : float
        Of the sine at time 0 [rad].
    u_phase : float
        Its standard uncertainty from the scatter of the blocks.
    times, slips : ndarray of float64, shape (blocks,)
        Centres of the blocks and by how much the clock is early there [s].
    noise : float
        Root mean square of what is left of the channel, after the averaging.
    """

    f: float
    amplitude: float
    phase: float
    u_phase: float
    times: npt.NDArray[np.float64]
    slips: npt.NDArray[np.float64]
    noise: float

    @property
    def clear(self) -> bool:
        """Whether it stands out, so that its phase means something."""
        return self.amplitude > 0.5 * self.noise

    @property
    def steady(self) -> bool:
        """Whether it has one phase from block to block, as a sine has below whatever rings louder than it."""
        return len(self.slips) >= _MANY and float(np.std(self.slips)) * 2 * np.pi * self.f < _STEADY


def find_tone(
    values: npt.NDArray[np.float64], valid: npt.NDArray[np.bool_], rate: float, start: float, near: float | None = None
) -> Tone | None:
    """Return the strongest sine of a channel, or the one at a known frequency; ``None`` if the record is too short.

    Parameters
    ----------
    values, valid : ndarray, shape (n,)
        Samples, and which of them are good.
    rate, start : float
        Samples a second and time of the first [s].
    near : float, optional
        Frequency, where it is known to a part in a thousand [Hz].
    """
    if not valid.all():
        places = np.flatnonzero(valid)
        values = np.interp(np.arange(len(values)), places, values[places])
    group = max(1, int(rate // _DECIMATED))
    count = len(values) // group
    x = values[: count * group].reshape(count, group).mean(axis=1)
    x -= x.mean()
    fs = rate / group
    first = start + (group - 1) / (2 * rate)
    f = near if near is not None else _peak(x, fs)
    if f is None:
        return None
    length = round(max(_SHORTEST, _PERIODS / f) * fs)
    blocks = count // length
    if blocks < 2:
        return None
    window = np.hanning(length + 1)[:length]
    times = first + (np.arange(blocks) * length + 0.5 * length) / fs
    steps = np.arange(length) / fs
    cut = x[: blocks * length].reshape(blocks, length)
    turned = (cut * window) @ np.exp(-2j * np.pi * f * steps) * (2 / window.sum())
    starts = first + np.arange(blocks) * length / fs
    turned = turned * np.exp(-2j * np.pi * f * starts)
    phases = np.unwrap(np.angle(turned))
    weights = np.abs(turned) + 1e-300
    slope, phase = np.polyfit(times, phases, 1, w=weights) if blocks > 2 else (0.0, float(phases.mean()))
    rest = phases - (phase + slope * times)
    f = f + slope / (2 * np.pi)
    amplitude = float(np.abs(np.mean(turned * np.exp(-1j * (phase + slope * times))))) / float(
        np.sinc(f * group / rate)
    )
    t = first + np.arange(count) / fs
    noise = float(np.std(x - amplitude * np.cos(2 * np.pi * f * t + phase)))
    return Tone(
        f=float(f),
        amplitude=amplitude,
        phase=float((phase + np.pi / 2) % (2 * np.pi)),
        u_phase=float(np.std(rest)) / np.sqrt(blocks),
        times=np.asarray(times, np.float64),
        slips=rest / (2 * np.pi * f),
        noise=noise,
    )


def _peak(x: npt.NDArray[np.float64], fs: float) -> float | None:
    """Return the frequency of the strongest line between half a hertz and two hundred."""
    n = len(x)
    if n < 16:
        return None
    spectrum = np.abs(np.fft.rfft(x * np.hanning(n)))
    low, high = int(np.ceil(_LOWEST * n / fs)), min(int(_HIGHEST * n / fs), len(spectrum) - 2)
    low = max(low, 1)
    if high <= low or not spectrum[low:high].any():
        return None
    k = low + int(np.argmax(spectrum[low:high]))
    a, b, c = np.log(spectrum[k - 1 : k + 2] + 1e-300)
    bend = a - 2 * b + c
    return float((k + (0.5 * (a - c) / bend if bend < 0 else 0.0)) * fs / n)
