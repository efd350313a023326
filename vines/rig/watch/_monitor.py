"""What is known of a run while it goes on: cheap, in a window that rolls, added to as samples come."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.fit import Bins, SineFit, sine_fit
from vines.rig.ingest import clipped_samples, flat_ends
from vines.rig.quantities import Pattern, cut_into_periods, find_pattern
from vines.rig.watch._channel import Channel
from vines.rig.watch._hearing import Hearing
from vines.rig.watch._means import Means
from vines.rig.watch._rebounds import rebounds
from vines.rig.watch._report import Level, Report
from vines.rig.watch._settling import settling, slope
from vines.rig.watch._stream import Block

__all__ = ["PERIODS", "Monitor"]

Floats = npt.NDArray[np.float64]

PERIODS = 64
"""Forcing periods over which the pattern is taken."""
_FITTED = 4.0
"""Seconds over which the base is fitted."""
_STEP = 1.0
"""Seconds of a step of the response, about: as many whole periods as it holds."""
_SLOW, _FAST = 800.0, 3200.0
"""Means a second of a motion, and of a displacement by which the ball's flights are told."""
_SPAN = 15.0
"""Seconds of means that are kept."""
_CHANGED, _DETUNED = 0.03, 2e-3
"""Relative change of the base's amplitude and frequency that is another point."""
_KEPT = 600
"""Steps that are kept: ten minutes."""
_DRIFTS = 20
"""Steps from which on a drift is looked for."""
_SIGMAS = 4.0
_LITTLE = 0.003
"""Part of its range below which a channel is said to use little of it."""
_ORDERS = {"base_disp": 0, "base_vel": 1, "base_acc": 2, "lo_disp": 0, "lo_vel": 1, "lo_acc": 2}
_REBOUNDS = 60
"""Impacts whose median restitution is told."""
_LEAST_REBOUNDS = 5
_TOLD = 8
"""Periods from which on a pattern is told."""


class Monitor:
    """Watches the channels of one stream.

    Parameters
    ----------
    channels : sequence of Channel
        In the order of the values.
    rate : float
        Samples a second.
    b : float, optional
        Half length of the cavity less the ball's radius [m]; with a displacement it gives r.
    memory : float, optional
        2/lam in time units of the rig [s]; without it the decay that is seen.
    """

    def __init__(
        self, channels: Sequence[Channel], rate: float, *, b: float | None = None, memory: float | None = None
    ):
        self.channels, self.rate = tuple(channels), rate
        self.b, self.memory = b, memory
        self._place = {each.role: place for place, each in reversed(list(enumerate(channels))) if each.calibrated}
        self._base = next((role for role in ("base_disp", "base_vel", "base_acc") if role in self._place), None)
        self._motion = next((role for role in ("lo_disp", "lo_vel", "lo_acc") if role in self._place), None)
        heard = next((role for role in ("lo_acc", "lo_disp") if role in self._place), None)
        self._hearing = None if heard is None else Hearing(channels[self._place[heard]], rate)
        self._heard = -1 if heard is None else self._place[heard]
        self._means = {
            role: Means(rate, _FAST if role == "lo_disp" else _SLOW, _SPAN, channels[self._place[role]].delay)
            for role in (self._base, self._motion)
            if role is not None
        }
        self._new: list[npt.NDArray[np.float64]] = []
        self._next = self.lost = 0
        self._begun = False
        self._clipped = [0] * len(channels)
        self._impacts: deque[tuple[float, float]] = deque(maxlen=4096)
        self.impacts = 0
        self._fit: SineFit | None = None
        self._steps: deque[tuple[float, float, float, complex]] = deque(maxlen=_KEPT)
        self._r: deque[tuple[float, float]] = deque(maxlen=20 * _KEPT)
        self.since = 0.0
        self._odd = 0
        self._pattern = ("", 0.0)

    def take(self, block: Block) -> npt.NDArray[np.float64]:
        """Add samples; return them in SI units, shape (channels, n)."""
        if block.values.shape[0] != len(self.channels):
            raise RigError(f"a block has {block.values.shape[0]} channels, {len(self.channels)} are described")
        values = np.asarray(block.values, np.float64)
        bad = ~np.isfinite(values)
        if bad.any():
            self.lost += int(bad.any(axis=0).sum())
            values = np.where(bad, 0.0, values)
        if self._begun:
            self.lost += max(0, block.first - self._next)
        self._begun = True
        self._next = block.first + values.shape[1]
        self._new.append(values)
        factor = np.array([[each.factor] for each in self.channels])
        offset = np.array([[each.offset] for each in self.channels])
        si = values * factor + offset
        for role, means in self._means.items():
            means.add(block.first, si[self._place[role]])
        if self._hearing is not None:
            self._hearing.add(block.first, si[self._heard])
        return si

    @property
    def time(self) -> float:
        """Seconds from the first sample of the run to the last one."""
        return self._next / self.rate

    def report(self) -> Report:
        """Return what is known by now; levels are those since the report before."""
        levels = self._levels()
        self._listen()
        self._forced()
        self._respond()
        pattern, periods, rate = self._repeating()
        bounced = self._bounced()
        found = self._steps_since()
        t, ratio = found[:, 0].real, found[:, 3]
        rest = settling(t - self.since, ratio, self.memory)
        settled, why, wait = rest.settled, rest.why, rest.wait
        if pattern is not None and pattern.name != self._pattern[0]:
            self._pattern = (pattern.name, self.time)
        if settled and pattern is not None and self.time - self._pattern[1] < 5 * _STEP and self.time > 8 * _STEP:
            wait = 5 * _STEP - (self.time - self._pattern[1])
            settled, why = False, f"the pattern is {pattern.name} for {self.time - self._pattern[1]:.0f} s only"
        if self._fit is None:
            settled, why = False, "the base does not move" if self._base else "no channel measures the base"
        last = self._steps[-1] if self._fit is not None and self._steps else None
        x1 = self._means["lo_disp"].last(_STEP).mean if "lo_disp" in self._means else np.empty(0)
        return Report(
            t=self.time,
            lost=self.lost,
            levels=levels,
            E=last[1] if last else None,
            f=self._fit.f if self._fit else None,
            u_f=self._fit.u_f if self._fit else None,
            response=abs(last[3]) * last[1] if last else None,
            max_abs_x1=float(np.abs(x1 - x1.mean()).max()) if len(x1) else None,
            impacts=self.impacts,
            rate=rate,
            pattern="" if pattern is None else pattern.name,
            share=None if pattern is None else pattern.fraction,
            periods=periods,
            phases=self._phases(),
            r=bounced,
            settled=settled,
            wait=None if settled or self._fit is None else wait,
            why=why,
            since=self.since,
            drift=self._drift(settled),
            remarks=self._remarks(levels),
        )

    def recent(self, seconds: float) -> tuple[Floats, Floats, Floats]:
        """Return times, sides (+1 L, -1 R) and phases of the base [rad] of the impacts of the last seconds."""
        kept = [each for each in self._impacts if each[0] > self.time - seconds]
        t, dv = np.array([each[0] for each in kept]), np.array([each[1] for each in kept])
        phase = np.full(len(t), np.nan) if self._fit is None else np.mod(self._phase_of(t), 2 * np.pi)
        # The ball drives the oscillator away from the end that it hits: to the left on the left one.
        return t, -np.sign(dv), phase

    def _levels(self) -> dict[str, Level]:
        values = np.concatenate(self._new, axis=1) if self._new else np.empty((len(self.channels), 0))
        self._new = []
        found = {}
        for place, (channel, numbers) in enumerate(zip(self.channels, values, strict=True)):
            if not len(numbers):
                continue
            lost = flat_ends(numbers) if channel.range is None else clipped_samples(numbers, channel.range)
            self._clipped[place] += int(lost.sum())
            mean = float(numbers.mean())
            away = numbers - mean
            scale = abs(channel.factor)
            largest = float(np.abs(numbers).max())
            found[channel.name] = Level(
                unit=channel.si,
                rms=scale * float(np.sqrt(away @ away / len(away))),
                peak=scale * float(np.abs(away).max()),
                mean=channel.factor * mean + channel.offset,
                full=largest / channel.range if channel.range else None,
                clipped=float(lost.mean()),
                clipped_since=self._clipped[place],
            )
        return found

    def _listen(self) -> None:
        if self._hearing is not None:
            t, dv = self._hearing.take()
            self.impacts += len(t)
            self._impacts.extend(zip(t.tolist(), dv.tolist(), strict=True))

    def _forced(self) -> None:
        """Fit the base over the last seconds."""
        if self._base is None:
            return
        bins = self._means[self._base].last(_FITTED)
        before, self._fit = self._fit, None
        if len(bins.t) * bins.width < 1.0 or not np.ptp(bins.mean) > 0:
            return
        for near in dict.fromkeys((before.f if before else None, None)):
            try:
                fit = sine_fit(bins, harmonics=1, near=near)
            except (RigError, np.linalg.LinAlgError):
                continue
            # As a line that is not clear is none: half of what is left beside it.
            if abs(fit.harmonics[0]) > 0.5 * fit.residual and fit.f > 0:
                self._fit = fit
                return

    def _respond(self) -> None:
        """Add a step: the base and the oscillator over the last whole periods, at the frequency of the base."""
        if self._fit is None or self._base is None or self._motion is None:
            return
        seconds = max(1, int(_STEP * self._fit.f)) / self._fit.f
        e = self._amplitude(self._base, seconds)
        x = self._amplitude(self._motion, seconds)
        if e is None or x is None or not abs(e) > 0:
            return
        step = (self.time, abs(e), self._fit.f, x / e)
        usual = self._steps_since()
        if len(usual) >= 3:
            E, f = np.median(np.abs(usual[-10:, 1])), np.median(np.abs(usual[-10:, 2]))
            other = abs(step[1] / E - 1) > _CHANGED or abs(step[2] / f - 1) > _DETUNED
            self._odd = self._odd + 1 if other else 0
            # The first odd step is half of one and half of the other.
            if self._odd == 2:
                self.since, self._odd = self.time - 2 * _STEP, 0
                self._r.clear()
        self._steps.append(step)

    def _amplitude(self, role: str, seconds: float) -> complex | None:
        """Return the complex amplitude of the displacement by a channel over the last seconds [m]."""
        assert self._fit is not None
        bins: Bins = self._means[role].last(seconds)
        if len(bins.t) < 8:
            return None
        omega = self._fit.omega
        angle = omega * bins.t
        columns = np.stack([np.cos(angle), -np.sin(angle), np.ones(len(angle))], axis=1)
        a, b = np.linalg.lstsq(columns, bins.mean, rcond=None)[0][:2].tolist()
        channel = self.channels[self._place[role]]
        c = complex(a, b) / bins.response(1j * omega)
        return c / (1j * omega) ** _ORDERS[role] * (1 + channel.high_pass / (1j * self._fit.f))

    def _steps_since(self) -> npt.NDArray[np.complex128]:
        """Return time, amplitude, frequency and response of the steps since the forcing changed, a row each."""
        kept = [each for each in self._steps if each[0] > self.since + 0.5 * _STEP]
        return np.array(kept, np.complex128).reshape(-1, 4)

    def _phase_of(self, t: Floats) -> Floats:
        """Return the phase of the base's displacement E sin at times, not reduced [rad]."""
        assert self._fit is not None
        assert self._base is not None
        c = self._fit.harmonics[0] / (1j * self._fit.omega) ** _ORDERS[self._base]
        c *= 1 + self.channels[self._place[self._base]].high_pass / (1j * self._fit.f)
        return self._fit.omega * t + float(np.angle(c)) + 0.5 * np.pi

    def _repeating(self) -> tuple[Pattern | None, int, float | None]:
        """Return the pattern of the last periods, how many they are, and how many impacts one has."""
        if self._fit is None or self._hearing is None:
            return None, 0, None
        begin = max(0.0, self.time - PERIODS / self._fit.f, self.since)
        t, dv = np.array([each for each in self._impacts if each[0] >= begin]).reshape(-1, 2).T
        unwrapped = self._phase_of(t)
        span = self._phase_of(np.array([begin, self.time - 0.1]))
        periods = cut_into_periods(unwrapped, -np.sign(dv), (float(span[0]), float(span[1])))
        count = len(periods.words)
        rate = sum(map(len, periods.words)) / count if count else None
        return find_pattern(periods, unwrapped) if count >= _TOLD else None, count, rate

    def _phases(self) -> dict[str, float]:
        t, side, phase = self.recent(_STEP)
        found = {}
        for letter, sign in (("L", 1.0), ("R", -1.0)):
            here = phase[(side == sign) & np.isfinite(phase)]
            if len(here):
                found[letter] = float(np.angle(np.mean(np.exp(1j * here))) % (2 * np.pi))
        del t
        return found

    def _bounced(self) -> float | None:
        """Return the median restitution of the last impacts."""
        if self.b is None or "lo_disp" not in self._means or self._fit is None:
            return None
        t, side, _ = self.recent(3.0)
        t, r = rebounds(self._means["lo_disp"].last(4.0), t, side, self.b, self._fit.omega)
        new = t > (self._r[-1][0] if self._r else 0.0)
        self._r.extend(zip(t[new].tolist(), r[new].tolist(), strict=True))
        last = [value for _, value in self._r][-_REBOUNDS:]
        return float(np.median(last)) if len(last) >= _LEAST_REBOUNDS else None

    def _drift(self, settled: bool) -> dict[str, float]:
        """Return what changes a minute, where that stands out."""
        if not settled:
            return {}
        steps = self._steps_since()
        steps = steps[min(_DRIFTS // 2, max(0, len(steps) - _DRIFTS)) :]
        series = {}
        if len(steps) >= _DRIFTS:
            t = steps[:, 0].real
            for name, column in (
                ("E", np.abs(steps[:, 1])),
                ("f", np.abs(steps[:, 2])),
                ("response", np.abs(steps[:, 3])),
            ):
                series[name] = (t, column / column.mean())
        if len(self._r) >= 10 * _DRIFTS:
            told = np.array(self._r)
            series["r"] = (told[:, 0], told[:, 1])
        found = {}
        for name, (t, values) in series.items():
            rate, u = slope(t, values)
            if abs(rate) > _SIGMAS * u and abs(rate) * (t[-1] - t[0]) > _NOTED[name]:
                found[name] = 60 * rate
        return found

    def _remarks(self, levels: dict[str, Level]) -> list[str]:
        found = [f"{name} clipped: {each.clipped:.2%} of its samples" for name, each in levels.items() if each.clipped]
        found += [
            f"{name} uses {each.full:.1%} of its range"
            for name, each in levels.items()
            if each.full is not None and each.full < _LITTLE and not name.startswith(("temperature", "sound"))
        ]
        if self.lost:
            found.append(f"{self.lost} samples lost")
        return found


_NOTED = {"E": 2e-3, "f": 2e-5, "response": 5e-3, "r": 5e-3}
"""Change over what was watched from which on a drift is told."""
