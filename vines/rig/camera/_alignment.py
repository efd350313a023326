"""The clock of the sensor that sees the ball, found from momentum: what the ball gains the oscillator loses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.camera._flights import Flights
from vines.rig.recording import Sampled

__all__ = ["REACH", "Alignment", "align"]

Floats = npt.NDArray[np.float64]

REACH = 2.0
"""How far the clocks may have been started apart at most [s]."""

_BAND = (1.6, 15.0)
"""Frequencies in which pushes are looked for, in those of the forcing, which is below them."""

_STEP = 5e-4
_MIDDLE = 12.0
"""Length of the stretch in which the lag is looked for [s]: no clock runs off by a push's width within it."""

_BLOCK = 4.0
_NEAR = 8e-3
"""By how much clocks may run off from one block to the next [s]."""

_LIKE = 0.5
"""Least correlation of the ball's turns with the oscillator's pushes: below it they are not of one ball."""

_SURE = 5.0
"""Standard deviations by which the best lag has to beat those a half or a whole period away."""


@dataclass(frozen=True, slots=True)
class Alignment:
    """How the clock and the axis of the ball's sensor lie to those of the run.

    Attributes
    ----------
    lag, pace : float
        An event at t by the sensor is at lag + pace t on the run's clock [s].
    u : float
        Standard uncertainty of times brought onto the run's clock [s].
    sign : int
        +1, or -1 if the ball turns to the right where the oscillator is pushed to the right, which momentum forbids.
    told : bool
        Whether impacts differ enough from each other to tell this lag from one a half or a whole period away.
    like : float
        Correlation of the ball's turns with the oscillator's pushes.
    """

    lag: float
    pace: float
    u: float
    sign: int
    told: bool
    like: float

    @property
    def fits(self) -> bool:
        """Whether both sensors see one ball."""
        return self.like > _LIKE

    def on_the_run(self, t: Floats) -> Floats:
        """Return times of the sensor on the clock of the run."""
        return self.lag + self.pace * t


def align(seen: Flights, channel: Sampled, s: complex, omega: float) -> Alignment | None:
    """Find lag, pace and sign of the ball's sensor; None if it saw fewer than eight impacts of the record.

    Parameters
    ----------
    seen : Flights
        The ball's impacts, on the clock of its sensor.
    channel : Sampled
        The oscillator's displacement, velocity or acceleration, on the clock of the run.
    s : complex
        Of the free oscillation [1/s].
    omega : float
        Of the forcing [rad/s].

    Notes
    -----
    Above the forcing, x1'' + lam omega0 x1' + omega0^2 x1 is a train of pushes, -mu times that of the ball's turns.
    Their correlation is largest at the lag. It repeats with the forcing, and with the other sign half a period away,
    but for what differs from impact to impact; so that is what tells them apart.
    """
    if len(seen) < 8:
        return None
    grid, push = _pushes(channel, s, omega)
    turn = seen.v_after - seen.v_before
    middle = 0.5 * float(seen.t[0] + seen.t[-1])
    near = np.abs(seen.t - middle) < _MIDDLE / 2
    lags = np.arange(-REACH, REACH, _STEP)
    shown = _correlation(grid, push, seen.t[near], turn[near], lags)
    # A lag that brings the stretch out of the record says nothing.
    inside = (seen.t[near][0] + lags > grid[0]) & (seen.t[near][-1] + lags < grid[-1])
    shown = np.where(inside, shown, 0.0)
    peaks = np.flatnonzero((np.abs(shown[1:-1]) >= np.abs(shown[:-2])) & (np.abs(shown[1:-1]) > np.abs(shown[2:]))) + 1
    if not len(peaks):
        return None
    rivals = peaks[np.argsort(-np.abs(shown[peaks]))[:24]]
    found = [_tracked(grid, push, seen.t, turn, middle, float(lags[k]), int(np.sign(-shown[k]))) for k in rivals]
    scores = np.array([one[3].mean() for one in found])
    best = int(np.argmax(scores))
    told = True
    for k, other in enumerate(found):
        if k == best or abs(other[0] - found[best][0]) < _NEAR:
            continue
        apart = found[best][3] - other[3]
        if apart.mean() < _SURE * apart.std() / np.sqrt(len(apart)):
            told = False
            # Nothing but what was stated decides: the clocks are those of one start, and the sign is as written.
            if (other[2] < 0, abs(other[0])) < (found[best][2] < 0, abs(found[best][0])):
                best = k
    lag, pace, sign, each, u = found[best]
    begin = lag - (pace - 1) * middle
    at = begin + pace * seen.t
    within = (at > grid[0]) & (at < grid[-1])
    strength = np.interp(at[within], grid, push)
    like = float(each.sum() / np.sqrt(np.sum(turn[within] ** 2) * np.sum(strength**2)))
    return Alignment(begin, pace, float(np.hypot(u, channel.u_time)), sign, told, like)


def _pushes(channel: Sampled, s: complex, omega: float) -> tuple[Floats, Floats]:
    """Return a grid of times and the pushes on it [m/s^2]."""
    values = channel.values
    if not channel.valid.all():
        place = np.arange(len(values))
        values = np.interp(place, place[channel.valid], values[channel.valid])
    n = len(values)
    ramp = min(n // 10, round(0.5 * channel.rate))
    taper = np.ones(n)
    taper[:ramp] = 0.5 - 0.5 * np.cos(np.pi * np.arange(ramp) / ramp)
    taper[n - ramp :] = taper[:ramp][::-1]
    spectrum = np.fft.rfft((values - values[channel.valid].mean()) * taper)
    low, high = (part * omega / (2 * np.pi) for part in _BAND)
    high = min(high, 0.4 * channel.rate)
    last = min(len(spectrum), int(2 * high * n / channel.rate) + 2)
    f = np.arange(last) * channel.rate / n
    turn = 2j * np.pi * f
    order = {"displacement": 0, "velocity": 1, "acceleration": 2}[_quantity(channel)]
    operator = np.zeros(last, complex)
    band = (f > low) & (f < high)
    operator[band] = (turn[band] ** 2 - 2 * s.real * turn[band] + abs(s) ** 2) / turn[band] ** order
    # Both ends of the band fall off softly, so that a push does not ring.
    edge = np.clip((f - low) / (0.4 * low), 0, 1) * np.clip((high - f) / (0.3 * high), 0, 1)
    weight = np.sin(0.5 * np.pi * edge) ** 2
    count = 2 * (last - 1)
    push = np.fft.irfft(spectrum[:last] * operator * weight, count) * count / n
    grid = channel.start + np.arange(count) * (n / channel.rate) / count
    return grid, push


def _quantity(channel: Sampled) -> str:
    return {"lo_disp": "displacement", "lo_vel": "velocity", "lo_acc": "acceleration"}[channel.role]


def _correlation(grid: Floats, push: Floats, t: Floats, turn: Floats, lags: Floats) -> Floats:
    """Return the sum of turns times pushes at each lag."""
    shown = np.interp(t[:, None] + lags[None, :], grid, push, 0.0, 0.0)
    return np.asarray(turn @ shown, dtype=np.float64)


def _tracked(
    grid: Floats, push: Floats, t: Floats, turn: Floats, middle: float, lag: float, sign: int
) -> tuple[float, float, int, Floats, float]:
    """Follow a lag from the middle of the record to its ends.

    Returns the lag in the middle, the pace, the sign, what each impact adds to the correlation, and the standard
    uncertainty of a time on the run's clock.
    """
    number = np.rint((t - middle) / _BLOCK).astype(int)
    fine = np.arange(-_NEAR, _NEAR + 1e-9, _STEP)
    at: dict[int, float] = {}
    for block in sorted(set(number.tolist()), key=abs):
        own = number == block
        if own.sum() < 4:
            continue
        before = at.get(block - int(np.sign(block)), lag) if at else lag
        shown = -sign * _correlation(grid, push, t[own], turn[own], before + fine)
        k = int(np.clip(np.argmax(shown), 1, len(fine) - 2))
        bend = shown[k - 1] - 2 * shown[k] + shown[k + 1]
        off = 0.5 * (shown[k - 1] - shown[k + 1]) / bend if bend < 0 else 0.0
        at[block] = before + float(fine[k] + np.clip(off, -1, 1) * _STEP)
    blocks, values = np.array(list(at)) * _BLOCK, np.array(list(at.values()))
    slope, here, u = 0.0, lag, _STEP
    if len(blocks) > 2:
        slope, here = (float(value) for value in np.polyfit(blocks, values, 1))
        u = float(np.std(values - np.polyval((slope, here), blocks)) * np.sqrt(len(blocks) / (len(blocks) - 2)))
    elif len(blocks):
        here = float(values.mean())
    moved = here + t + slope * (t - middle)
    within = (moved > grid[0]) & (moved < grid[-1])
    each = -sign * turn * np.interp(moved, grid, push) * within
    return here, 1 + slope, sign, each, u
