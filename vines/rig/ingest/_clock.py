"""Clocks: those of separate recorders are brought onto that of the first through a motion that both saw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vines.errors import RigError
from vines.rig.ingest._calibrate import Calibrated
from vines.rig.ingest._tone import Tone, find_tone

__all__ = ["Clock", "align_clocks"]

_DIFFER = 300e-6
"""Relative difference of two sample clocks beyond which one of them is not what it says: quartz is within 100 ppm."""
_SLIP = 2e-4
"""[s] Jump of a clock from one block to the next that means lost samples."""
_OTHER = 1.5
"""A sine so many times as fast as the motion is none of it."""

_BY_IMPACTS = "its own; the ball's impacts bring it onto the clock of the run when that is reconstructed"
_PAIRS = (
    ("base_acc", "base_acc"),
    ("base_vel", "base_vel"),
    ("base_disp", "base_disp"),
    ("base_disp", "base_acc"),
    ("base_acc", "base_disp"),
    ("lo_vel", "lo_vel"),
    ("lo_disp", "lo_disp"),
    ("lo_acc", "lo_acc"),
    ("lo_disp", "lo_acc"),
    ("lo_acc", "lo_disp"),
)
"""What two recorders may share, best first: the same signal wired to both before two sensors of one motion."""


@dataclass(frozen=True, slots=True)
class Clock:
    """How the clock of a recorder runs against that of the run: t = offset + pace * (its own time).

    Attributes
    ----------
    offset : float
        [s]
    pace : float
        Close to 1.
    u : float
        Standard uncertainty of times brought onto the clock of the run [s].
    how : str
        What it was found from.
    """

    offset: float
    pace: float
    u: float
    how: str


def align_clocks(channels: Sequence[Calibrated], *, max_offset: float, ringdown: bool) -> dict[str, Clock]:
    """Return the clock of each recorder; that of the first channel is the clock of the run.

    The phases of a common sine, seen by both, give offset and pace. The offset is known up to a period of the sine, so
    `max_offset` must be below half of one.

    Parameters
    ----------
    channels : sequence of Calibrated
        All channels of the run.
    max_offset : float
        How far apart the recorders may have been started at most [s].
    ringdown : bool
        Whether the base is at rest; the oscillator is compared then. A recorder that saw the ball alone shares no sine
        with others: its times stay its own, uncertain by `max_offset`.

    Raises
    ------
    RigError
        If a clock jumps, or two can't be aligned.
    """
    by_recorder: dict[str, list[Calibrated]] = {}
    for channel in channels:
        by_recorder.setdefault(channel.row.recorder, []).append(channel)
    tones = _tones([channel for channel in channels if channel.row.role.startswith("lo" if ringdown else "base")])
    if not ringdown:
        _check_jumps(channels, tones)
    first, *others = by_recorder
    clocks = {first: Clock(0.0, 1.0, 0.0, "the clock of the run")}
    for name in others:
        if all(channel.row.role == "ball_cam" for channel in by_recorder[name]):
            clocks[name] = Clock(0.0, 1.0, max_offset, _BY_IMPACTS)
            continue
        clocks[name] = _align(by_recorder[first], by_recorder[name], tones, max_offset, (first, name))
    return clocks


def _tones(channels: Sequence[Calibrated]) -> dict[str, Tone | None]:
    """Return the tone of each channel; an acceleration in which a mode of the frame is louder has the motion's."""
    tones = {one.row.name: find_tone(one.values, one.valid, one.rate, one.start) for one in channels}
    moves = (tones[one.row.name] for one in channels if not one.row.role.endswith("_acc"))
    known = next((tone.f for tone in moves if tone is not None and tone.clear), None)
    for one in channels:
        tone = tones[one.row.name]
        if known is not None and tone is not None and tone.f > _OTHER * known:
            tones[one.row.name] = find_tone(one.values, one.valid, one.rate, one.start, near=known)
    return tones


def _check_jumps(channels: Sequence[Calibrated], tones: dict[str, Tone | None]) -> None:
    for channel in channels:
        found = tones.get(channel.row.name)
        if found is None or not found.clear:
            continue
        noise = float(np.median(np.abs(np.diff(found.slips))))
        jumps = np.abs(np.diff(found.slips))
        if jumps.max() > max(_SLIP, 12 * noise):
            place = int(jumps.argmax())
            when = 0.5 * (found.times[place] + found.times[place + 1])
            raise RigError(
                f"{channel.row.where}: the clock of recorder {channel.row.recorder!r} jumps by about "
                f"{1e3 * float(np.ptp(found.slips)):.2g} ms near {when:.3g} s: "
                "samples were lost; clocks can't be aligned across the gap"
            )


def _align(
    ours: Sequence[Calibrated],
    theirs: Sequence[Calibrated],
    tones: dict[str, Tone | None],
    max_offset: float,
    names: tuple[str, str],
) -> Clock:
    """Return the clock of another recorder."""
    between = f"recorders {names[0]!r} and {names[1]!r} can't be aligned"
    pair = _shared(ours, theirs, tones)
    if pair is None:
        raise RigError(
            f"{between}: they share no moving signal; wire the base accelerometer (or the drive) to both recorders"
        )
    here, there = pair
    a, b = tones[here.row.name], tones[there.row.name]
    assert a is not None
    assert b is not None
    pace = b.f / a.f
    if abs(pace - 1) > _DIFFER:
        raise RigError(
            f"{between}: {here.row.where} has {a.f:.6g} Hz, {there.row.where} {b.f:.6g} Hz, "
            f"{1e6 * (pace - 1):+.0f} ppm apart, allowed are {1e6 * _DIFFER:.0f}; one sampling rate is wrong"
        )
    if not max_offset < 0.5 / a.f:
        raise RigError(
            f"{between}: max_offset is {max_offset:g} s, but the shared signal tells offsets apart only below half its "
            f"period, {0.5 / a.f:.4g} s; start the recorders closer together and write so in run.json"
        )
    phase_b = b.phase + (np.pi if here.row.quantity != there.row.quantity else 0.0)
    # Equal phases: 2 pi f_a t_a + phase_a = 2 pi f_b t_b + phase_b.
    offset = float((phase_b - a.phase + np.pi) % (2 * np.pi) - np.pi) / (2 * np.pi * a.f)
    if abs(offset) > max_offset:
        raise RigError(
            f"{between}: {there.row.where} is {1e3 * offset:.4g} ms off {here.row.where}, allowed are "
            f"{1e3 * max_offset:.4g} ms (max_offset in run.json); or one of their signs is wrong"
        )
    u = float(np.hypot(a.u_phase, b.u_phase)) / (2 * np.pi * a.f)
    u = float(np.hypot(u, np.hypot(here.row.u_delay, there.row.u_delay)))
    how = f"{there.row.name} against {here.row.name}: {1e3 * offset:.4f} ms, {1e6 * (pace - 1):+.2f} ppm"
    return Clock(offset, pace, u, how)


def _shared(
    ours: Sequence[Calibrated], theirs: Sequence[Calibrated], tones: dict[str, Tone | None]
) -> tuple[Calibrated, Calibrated] | None:
    """Return the best pair of channels that saw one motion."""
    for role, other in _PAIRS:
        for here in ours:
            for there in theirs:
                if (here.row.role, there.row.role) != (role, other):
                    continue
                a, b = tones.get(here.row.name), tones.get(there.row.name)
                if a is not None and b is not None and a.clear and b.clear:
                    return here, there
    return None
