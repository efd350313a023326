"""What real rigs add to recorded channels: mains hum, modes of the frame, a laser that loses its target.

It works on raw runs, whoever made them: on the steps of the converter, from the times and velocity jumps of the impacts
that the truth tells.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from vines.errors import ParameterError
from vines.rig.formats import RawChannel
from vines.rig.ingest import ChannelRow
from vines.rig.synth._make import RawRun
from vines.rig.units import volts_per_unit

__all__ = ["Burst", "Disturbances", "Hum", "Ringing", "disturbed"]

Floats = npt.NDArray[np.float64]

_GRID = 0.02
"""Steps in which the phase of the mains wanders [s]."""
_BITS = 24


@dataclass(frozen=True, slots=True)
class Hum:
    """A line of the mains in all channels, each with a phase of its own.

    Attributes
    ----------
    frequency : float
        [Hz]
    volts : float
        Amplitude where the recorder sees it [V].
    wander : float
        Standard deviation of the frequency of the mains [Hz], which forgets within ten seconds.
    roles : tuple of str
        Channels that have it; empty for all.
    """

    frequency: float
    volts: float
    wander: float = 0.0
    roles: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Ringing:
    """A mode of the frame in one channel: rung by the impacts, or by whatever happens around the rig.

    Attributes
    ----------
    role : str
        A channel of displacement or acceleration.
    frequency, damping : float
        [Hz] and damping ratio.
    share : float
        Velocity of the mode after an impact, relative to the velocity jump of the oscillator.
    around : float
        Root mean square of what the surroundings make of it, in the unit of the role.
    """

    role: str
    frequency: float
    damping: float
    share: float = 0.0
    around: float = 0.0


@dataclass(frozen=True, slots=True)
class Burst:
    """Stretches in which a laser is lost.

    Attributes
    ----------
    role : str
        Which channel.
    kind : str
        ``dropout``: at the end of its range; ``spike``: single wild samples, half a millisecond apart; ``held``: the
        last value stays.
    begin, length : float
        From the first sample on [s].
    """

    role: str
    kind: Literal["dropout", "spike", "held"]
    begin: float
    length: float


@dataclass(frozen=True, slots=True)
class Disturbances:
    """What is added to the channels of a run."""

    hum: tuple[Hum, ...] = ()
    ringing: tuple[Ringing, ...] = ()
    bursts: tuple[Burst, ...] = ()


def disturbed(run: RawRun, what: Disturbances, seed: int) -> RawRun:
    """Return a raw run with disturbances added to its channels.

    Parameters
    ----------
    run : RawRun
        With the impacts in its truth.
    what : Disturbances
        They are told in ``truth["disturbances"]``.
    seed : int
        Of phases and of what the surroundings do.

    Raises
    ------
    ParameterError
        If a disturbance is of a role that the run does not have.
    """
    roles = {row.role for row in run.rows}
    for role in (*(role for each in what.hum for role in each.roles), *(e.role for e in (*what.ringing, *what.bursts))):
        if role not in roles:
            raise ParameterError(f"disturbances: no channel of role {role!r}; there are {', '.join(sorted(roles))}")
    rng = np.random.default_rng(np.random.SeedSequence([seed, 50]))
    longest = max(_begin_and_rate(c)[0] + len(c.values) / _begin_and_rate(c)[1] for c in _channels(run))
    turns = [_mains(each, longest + 1.0, rng) for each in what.hum]
    impacts = run.truth["impacts"]
    t = np.asarray(impacts["t"], np.float64)
    share = run.truth["parameters"]["m"] / (run.truth["parameters"]["M"] + run.truth["parameters"]["m"])
    dv = share * (np.asarray(impacts["w_dot_after"], np.float64) - np.asarray(impacts["w_dot"], np.float64))
    files = dict(run.files)
    for row in run.rows:
        file = files[row.file]
        place = next(k for k, each in enumerate(file.channels) if each.name == row.field)
        channel = file.channels[place]
        added = np.zeros(len(channel.values))
        begin, rate = _begin_and_rate(channel)
        clock = begin + np.arange(len(added)) / rate
        for each, turn in zip(what.hum, turns, strict=True):
            if not each.roles or row.role in each.roles:
                added += each.volts * np.sin(np.interp(clock, *turn) + rng.uniform(0, 2 * np.pi))
        for each in what.ringing:
            if each.role == row.role:
                added += _ring(each, row, channel, (t, dv), rng) * _volts(row)
        if added.any() or any(each.role == row.role for each in what.bursts):
            changed = _recorded(channel, added, [each for each in what.bursts if each.role == row.role], rng)
            channels = (*file.channels[:place], changed, *file.channels[place + 1 :])
            files[row.file] = replace(file, channels=channels)
    told = [repr(each) for each in (*what.hum, *what.ringing, *what.bursts)]
    return replace(run, files=files, truth={**run.truth, "disturbances": told})


def _channels(run: RawRun) -> list[RawChannel]:
    return [channel for file in run.files.values() for channel in file.channels]


def _begin_and_rate(channel: RawChannel) -> tuple[float, float]:
    """Return the time of the first sample [s] and samples a second."""
    return float(channel.start or 0.0), float(channel.rate or 1.0)


def _mains(hum: Hum, duration: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return times [s] and the phase of the mains at them [rad]."""
    t = np.arange(-1.0, duration + _GRID, _GRID)
    away = np.zeros(len(t))
    if hum.wander:
        keep = np.exp(-_GRID / 10)
        kicks = rng.normal(0.0, hum.wander * np.sqrt(1 - keep**2), len(t))
        for k in range(1, len(t)):
            away[k] = keep * away[k - 1] + kicks[k]
    return t, 2 * np.pi * (hum.frequency * t + np.cumsum(away) * _GRID)


def _ring(
    mode: Ringing, row: ChannelRow, channel: RawChannel, impacts: tuple[Floats, Floats], rng: np.random.Generator
) -> Floats:
    """Return what a mode adds to a channel, in the SI unit of its role."""
    (begin, rate), count = _begin_and_rate(channel), len(channel.values)
    omega = 2 * np.pi * mode.frequency
    s = omega * complex(-mode.damping, np.sqrt(1 - mode.damping**2))
    total = np.zeros(count)
    t = np.asarray(impacts[0]) + row.group_delay - begin
    # Velocity dv cos: displacement Im(exp(s t))/Im s, acceleration its second derivative without the jump itself.
    scale = 1 / s.imag if row.role.endswith("disp") else s**2 / s.imag
    last = int(np.ceil(12 / -s.real * rate))
    for when, jump in zip(t, impacts[1], strict=True):
        i = max(int(np.ceil(when * rate)), 0)
        n = min(last, count - i)
        if n > 0 and np.isfinite(jump):
            total[i : i + n] += mode.share * jump * np.imag(scale * np.exp(s * ((i + np.arange(n)) / rate - when)))
    if mode.around:
        spectrum = np.fft.rfft(rng.normal(size=count))
        at = 2j * np.pi * np.fft.rfftfreq(count, 1 / rate)
        noise = np.fft.irfft(spectrum / (at**2 - 2 * s.real * at + abs(s) ** 2), count)
        total += mode.around * noise / noise.std()
    return total


def _volts(row: ChannelRow) -> float:
    """Return the volts of one SI unit of a channel."""
    assert isinstance(row.sensitivity, float)
    return volts_per_unit(row.sensitivity, row.sensitivity_unit)[1] * float(row.sign)


def _recorded(channel: RawChannel, added: Floats, bursts: list[Burst], rng: np.random.Generator) -> RawChannel:
    """Return a channel with volts added and its bursts, as steps of the converter again."""
    step, (begin, rate) = float(channel.about["slope"]), _begin_and_rate(channel)
    full = 2 ** (_BITS - 1) - 1
    codes = np.asarray(channel.values, np.float64) + added / step
    for burst in bursts:
        i = max(round((burst.begin - begin) * rate), 1)
        part = slice(i, i + max(1, round(burst.length * rate)))
        if burst.kind == "dropout":
            codes[part] = full
        elif burst.kind == "held":
            codes[part] = codes[i - 1]
        else:
            places = np.arange(part.start, min(part.stop, len(codes)), max(1, round(5e-4 * rate)))
            codes[places] += rng.choice([-1.0, 1.0], len(places)) * rng.uniform(0.05, 0.4, len(places)) * full
    return replace(channel, values=np.clip(np.rint(codes), -full - 1, full).astype(np.int32))
