"""Do the channels of a run agree with each other? A swapped sign or a wrong unit shows where two saw one motion."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from vines.errors import RigError
from vines.rig.ingest._tone import Tone, find_tone
from vines.rig.recording import RunInfo, Sampled

__all__ = ["check_agreement"]

_RATIO = 0.25
"""Relative difference of two amplitudes of one motion that calibration, coupling and linearity can explain."""
_ANGLE = np.radians(35.0)
"""The same of their phases."""
_COMMAND = 5e-3
"""Relative difference of measured and commanded frequency that no generator has: a clock or the command is wrong."""
_WARMER = 3.0
"""[K] By how much springs, a sensor on them and a reading by hand may differ, and warm up in a run."""
_REACHED = (0.5, 1.5)
"""Measured over commanded base amplitude: shakers sag by a fifth, and don't overshoot by half."""


def check_agreement(run: RunInfo, channels: Sequence[Sampled], measured: Collection[str] = ()) -> tuple[str, ...]:
    """Compare displacement with acceleration and the base with its command; return what was compared, in words.

    Parameters
    ----------
    run : RunInfo
        With the command.
    channels : sequence of Sampled
        On the clock of the run.
    measured : collection of str
        Commands that were taken from the recording itself (f_cmd, E_cmd), which it cannot be laid beside.

    Raises
    ------
    RigError
        If two channels that saw one motion contradict each other, or the base its command.
    """
    said: list[str] = []
    base = _tones(channels, ("base_disp", "base_vel", "base_acc"), None)
    ringdown = run.protocol == "ringdown"
    frequency = next((tone.f for _, tone in base if tone.clear), None) if not ringdown else None
    if not ringdown:
        said += _check_command(replace(run, **dict.fromkeys(measured)), base)
    for pair in (base if not ringdown else [], _tones(channels, ("lo_disp", "lo_vel", "lo_acc"), frequency)):
        for k, (one, a) in enumerate(pair):
            for other, b in pair[k + 1 :]:
                said += _compare(one, a, other, b)
    return (*said, *_check_temperature(run, channels))


def _tones(channels: Sequence[Sampled], roles: tuple[str, ...], near: float | None) -> list[tuple[Sampled, Tone]]:
    found = []
    for channel in channels:
        if channel.role in roles:
            tone = find_tone(channel.values, channel.valid, channel.rate, channel.start, near)
            if tone is not None:
                found.append((channel, tone))
                near = near or (tone.f if tone.clear else None)
    return sorted(found, key=lambda each: roles.index(each[0].role))


def _check_command(run: RunInfo, base: list[tuple[Sampled, Tone]]) -> list[str]:
    for channel, tone in base:
        if not (tone.clear or tone.steady):
            raise RigError(
                f"{channel.where}: the base shows no clear forcing ({tone.amplitude:.3g} against {tone.noise:.3g} of "
                f"noise), but protocol is {run.protocol}; is the channel connected?"
            )
        if run.f_cmd is not None and abs(tone.f / run.f_cmd - 1) > _COMMAND:
            raise RigError(
                f"{channel.where}: the base moves at {tone.f:.6g} Hz, f_cmd is {run.f_cmd:.6g} Hz; a sampling rate or "
                "the command is wrong"
            )
        if run.E_cmd is not None:
            E = tone.amplitude / (2 * np.pi * tone.f) ** _derivative(channel)
            if not _REACHED[0] < E / run.E_cmd < _REACHED[1]:
                raise RigError(
                    f"{channel.where}: the base moves by {E:.3g} m, {E / run.E_cmd:.3g} times E_cmd = {run.E_cmd:.3g}: "
                    "a unit, a sensitivity or the command is wrong"
                )
    commands = [name for name in ("f_cmd", "E_cmd") if getattr(run, name) is not None]
    if not commands:
        return ["no command beside the base, for f_cmd and E_cmd were taken from the recording"] if base else []
    missing = "" if len(commands) == 2 else f" ({commands[0]} alone)"
    return [f"{channel.name} against the command{missing}" for channel, _ in base]


def _derivative(channel: Sampled) -> int:
    """Return how often a motion was differentiated in what a channel measures."""
    return ("disp", "vel", "acc").index(channel.role.rpartition("_")[2])


def _check_temperature(run: RunInfo, channels: Sequence[Sampled]) -> list[str]:
    """Compare what the sensor at the springs says in the first and last second with what is stated."""
    said = []
    for channel in channels:
        if channel.role != "temperature":
            continue
        count = max(1, round(channel.rate))
        for part, stated, when in zip(
            (channel.values[:count], channel.values[-count:]), run.temperature, ("before", "after"), strict=True
        ):
            off = float(np.median(part)) - stated
            if abs(off) > _WARMER:
                raise RigError(
                    f"{channel.where}: it says {stated + off:.4g} degC, temperature_{when} is {stated:.4g} degC; a "
                    "unit, a sensitivity, an offset or the statement is wrong, or it is not at the springs"
                )
            said.append(f"{channel.name} against temperature_{when}: {off:+.2f} K")
    return said


def _compare(one: Sampled, a: Tone, other: Sampled, b: Tone) -> list[str]:
    """Compare the fundamentals of two channels that saw one motion."""
    if not (a.clear and b.clear):
        return []
    times = _derivative(other) - _derivative(one)
    ratio = b.amplitude / a.amplitude / (2 * np.pi * a.f) ** times
    angle = b.phase - a.phase - 0.5 * np.pi * times
    angle = float((angle + np.pi) % (2 * np.pi) - np.pi)
    if abs(abs(angle) - np.pi) < _ANGLE:
        raise RigError(
            f"{one.where} and {other.where} saw one motion with opposite signs: one sign is wrong in channels.tsv"
        )
    if abs(ratio - 1) > _RATIO:
        raise RigError(
            f"{other.where} shows {ratio:.3g} times the motion that {one.where} shows; a unit or a sensitivity is wrong"
        )
    if abs(angle) > _ANGLE:
        raise RigError(
            f"{one.where} and {other.where} saw one motion {np.degrees(angle):+.0f} degrees apart; a clock, a delay "
            "or a high-pass is wrong"
        )
    return [f"{other.name} against {one.name}: {ratio:.4f} times, {np.degrees(angle):+.2f} deg"]
