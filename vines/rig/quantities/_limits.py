"""What a rig does that the model does not, measured; a run where it matters is not accepted, with that cause.

A spring that stiffens, a contact that lasts, a base that gives way, a ball that rolls.

docs/rig.md, "What a rig does that the model doesn't", has statistics and limits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.signal import csd

from vines.rig.ball import FRICTION, ROLLS, Rebounds, stated
from vines.rig.fit import bins_of
from vines.rig.impacts import Mode, Response, pulses_of, rung
from vines.rig.quantities._forcing import Base, Tuning
from vines.rig.quantities._reconstruction import Finding
from vines.rig.quantities._ring_down import RingDown
from vines.rig.recording import Recording, Uncertain
from vines.rig.uncertainty import robust_deviation

__all__ = ["STIFFENS", "Ringing", "contact_time", "limits", "reaction", "stiffened"]

Floats = npt.NDArray[np.float64]

STIFFENS = 2e-4
"""Most that the frequency may change by the amplitude of a run: .1 % moves max|x1| by a tenth."""

_LASTS = 6e-4
"""Longest contact that passes for an impact [s]: the oscillator turns by 2 degrees in it."""

_LASTS_HEARD = 1.3e-3
"""The same by an acceleration, in which structural modes near a kilohertz look like a contact of a millisecond [s].

So does what is left in a displacement of modes of the frame.
"""

_GIVES = 1e-3
"""Most that the base may follow the oscillator: it shifts the free oscillation by half of it."""

_TURNS_ROUND = 0.3
"""A base that moves more than that beside the oscillator drives it: floor and fan, no reaction."""

_EVEN = 0.05
"""Most that a ball may slide more one way than the other where momentum tells its friction whether it spins or not."""

_SURE = 3.5
"""Standard deviations by which a limit must be passed."""

_APART = 8e-3
"""Impacts with others nearer than that tell no contact [s]."""

_HALF_SINE = float(np.sqrt(0.25 - 2 / np.pi**2))
"""Standard deviation of a half-sine, relative to its length."""

_INNER, _OUTER = 2.5e-3, 5e-3
"""Around an impact: where a contact shows, and where the motion without it is read [s]."""

_SEGMENT = 2.0
"""Of the spectra [s]."""

_NEAR = 1.5
"""Lines nearer than that to a harmonic of the forcing are left out [Hz]."""

_BESIDE = 0.15
"""The same for modes of the frame, relative to their frequency."""


def limits(
    recording: Recording,
    base: Base,
    response: Response,
    tuning: Tuning,
    ball: Rebounds,
    ringdowns: Sequence[RingDown],
    modes: Sequence[Mode] = (),
) -> tuple[Finding, ...]:
    """Return what is found of each thing that the model does not have.

    Parameters
    ----------
    recording, base, response, tuning, ball
        What was reconstructed.
    ringdowns : sequence of RingDown
        That gave omega0 and lam.
    modes : sequence of Mode
        Of the frame, that were taken off the oscillator's channels; the base's sensors feel them, too.
    """
    bend = stiffened(ringdowns, response)
    lasts = contact_time(recording, response)
    # What modes that were taken off leave in the first milliseconds looks like a contact of a millisecond, too.
    longest = _LASTS if response.order == 0 and not modes else _LASTS_HEARD
    gives = reaction(recording, base, _ringing(modes, response))
    found = [
        Finding(
            "linear_spring", _within(bend, STIFFENS),
            f"by the ring-down the frequency shifts by {100 * abs(bend.value):.2g} % at the amplitude of the run, "
            f"allowed is {100 * STIFFENS:.2g} %: the spring is not linear, it "
            + ("stiffens" if bend.value > 0 else "softens"),
        ),
        Finding(
            "short_contact", lasts is None or _within(lasts, longest),
            "too few impacts are alone to tell how long a contact lasts" if lasts is None else
            f"a contact lasts {1e3 * lasts.value:.2g} ms, allowed are {1e3 * longest:.2g} ms: the contact is soft, and "
            "the model's impacts take no time",
        ),
        Finding(
            "base_reacts", gives is None or not gives.value < _TURNS_ROUND or _within(gives, _GIVES),
            "no pair of channels tells whether the base follows the oscillator" if gives is None else
            f"the base follows the oscillator by {100 * gives.value:.2g} % between the harmonics, allowed is "
            f"{100 * _GIVES:.2g} %: the base gives way (shaker or frame), and the model's moves as it is told",
        ),
    ]  # fmt: skip
    moved = max((one.base for one in ringdowns), default=0.0)
    if moved:
        found.append(
            Finding(
                "base_in_ring_down", True,
                f"the base moved in the ring-down by {100 * moved:.2g} % of the oscillator's motion, which omega0 and "
                "lam allow for",
            )
        )  # fmt: skip
    # What else acts on the oscillator would pass for friction.
    if all(one.passed for one in found):
        rubs = ball.rubbing
        most = ROLLS
        given = recording.run.more.get("friction")
        if given is not None:
            known = stated(given, FRICTION)
            most = max(most, known.value + _SURE * known.u)
        asked = tuning.rubbing
        if given is None and _one_way(ball) > _EVEN and asked.value - asked.u > ROLLS:
            return (
                *found,
                Finding(
                    "sliding_ball",
                    False,
                    f"the forced response asks for {asked.value:.2g} +- {asked.u:.2g} m/s^2 of friction on the ball, "
                    "and momentum cannot deny it where flights are unequal, for a ball that rolls spins: state it by "
                    "a roll-down test (more.friction in run.json)",
                ),
            )
        found.append(
            Finding(
                "sliding_ball", _within(rubs, most) or tuning.unexplained > _SURE,
                f"momentum and the forced response ask for {rubs.value:.2g} m/s^2 of friction on the ball, allowed are "
                f"{most:.2g}: it rolls and, after each impact, slips; the model's ball flies",
            )
        )  # fmt: skip
    return tuple(found)


def _one_way(ball: Rebounds) -> float:
    """Return by how much more the ball slides one way than the other, in parts of the time."""
    return float(abs(np.sum(ball.course.slowed + ball.course.driven)) / np.ptp(ball.jumps.t))


def _within(found: Uncertain, most: float) -> bool:
    return abs(found.value) - _SURE * found.u <= most


def stiffened(ringdowns: Sequence[RingDown], response: Response) -> Uncertain:
    """Return the relative change of the frequency by the amplitude of a run, as ring-downs tell it."""
    amplitude = float(np.sqrt(2) * np.std(response.fit.motion.at(response.bins.t)))
    told = [one.stiffening for one in ringdowns if one.stiffening.u > 0]
    if not told:
        return Uncertain(0.0, 0.0)
    weights = np.array([1 / one.u**2 for one in told])
    values = np.array([one.value for one in told])
    mean = float(np.average(values, weights=weights))
    u = float(np.hypot(1 / np.sqrt(weights.sum()), np.ptp(values) / 2))
    return Uncertain(mean * amplitude**2, u * amplitude**2)


def contact_time(recording: Recording, response: Response) -> Uncertain | None:
    """Return how long a contact lasts, as a half-sine of the same width [s]; None where too few impacts tell.

    Notes
    -----
    A displacement with a contact of force p(t), of standard deviation sigma, is above the corner of an instantaneous
    impact by dv g(t), the integral of g being sigma^2/2; of an acceleration that was smoothed, sigma widens the pulse.
    Least squares over all impacts that are alone within 8 ms.
    """
    t, dv = response.fit.motion.starts[1:], response.fit.jumps.dv
    gaps = np.diff(t, prepend=-np.inf, append=np.inf)
    alone = (gaps[:-1] > _APART) & (gaps[1:] > _APART) & (np.abs(dv) > 0.3 * np.median(np.abs(dv)))
    if np.count_nonzero(alone) < _FEW:
        return None
    told = _corner if response.order == 0 else _width
    part, weight = told(recording, response, t[alone], dv[alone])
    good = np.isfinite(part)
    for _ in range(_TURNS):
        # An impact that is missing beside one makes a bend that no contact has.
        square = float(part[good] @ weight[good] / (weight[good] @ weight[good]))
        left = part - square * weight
        good = np.isfinite(part) & (np.abs(left) <= _STRAY * max(robust_deviation(left[good]), 1e-300))
    part, weight = part[good], weight[good]
    square = float(part @ weight / (weight @ weight))
    u = float(np.sqrt(np.sum((weight * (part - square * weight)) ** 2)) / (weight @ weight))
    # Of the length, whose square that is; of contacts too short to be seen, at most so much.
    longest = np.sqrt(max(square, 0.0) + u) / _HALF_SINE
    length = np.sqrt(max(square, 0.0)) / _HALF_SINE
    return Uncertain(float(length), float(longest - length))


_FEW = 8
_TURNS = 4
_STRAY = 4.0
"""Robust standard deviations beyond which what an impact says of its contact is left out."""


def _corner(recording: Recording, response: Response, t: Floats, dv: Floats) -> tuple[Floats, Floats]:
    """Return, for each impact, dv sigma^2 by the displacement, and dv."""
    fit, bins = response.fit, response.bins
    predicted = fit.motion.combination(bins.t, {0: 1.0, 2: bins.width**2 / 24}) + fit.offset
    if response.pushed is not None:
        predicted = predicted + response.pushed.signal
    left = bins.mean - predicted
    reach = round(_OUTER / bins.width)
    near = np.searchsorted(bins.t, t)[:, None] + np.arange(-reach, reach + 1)
    whole = (near[:, 0] >= 0) & (near[:, -1] < len(left))
    near = np.clip(near, 0, len(left) - 1)
    away = np.abs(bins.t[near] - t[:, None])
    inside, outside = away < _INNER, (away >= _INNER) & (away < _OUTER)
    level = np.sum(left[near] * outside, axis=1) / np.maximum(np.sum(outside, axis=1), 1)
    area = np.sum((left[near] - level[:, None]) * inside, axis=1) * bins.width
    return np.where(whole, 2 * area, np.nan), dv


def _width(recording: Recording, response: Response, t: Floats, dv: Floats) -> tuple[Floats, Floats]:
    """Return, for each impact, its jump times sigma^2 by the pulse of the acceleration, and its jump."""
    channel = recording.role("lo_acc")
    assert channel is not None
    pulses = pulses_of(channel)
    smooth = pulses.smooth
    values = pulses.values - response.fit.motion.combination(pulses.t, {2: 1.0, 4: 0.5 * smooth**2})
    reach = round(_OUTER / pulses.step)
    near = np.rint((t - pulses.start) / pulses.step).astype(np.intp)[:, None] + np.arange(-reach, reach + 1)
    whole = (near[:, 0] >= 0) & (near[:, -1] < len(values))
    near = np.clip(near, 0, len(values) - 1)
    u = (pulses.start + pulses.step * near - t[:, None]) / smooth
    bell = np.exp(-0.5 * u**2) / (smooth * np.sqrt(2 * np.pi))
    # Height, place and width of the pulse, on a straight line of its own; all impacts at nearly one grid.
    parts = np.full(len(t), np.nan)
    sizes = np.full(len(t), np.nan)
    for k in np.flatnonzero(whole):
        wider = bell[k] * (u[k] ** 2 - 1) / (2 * smooth**2)
        columns = np.stack([bell[k], bell[k] * u[k] / smooth, wider, np.ones(len(u[k])), u[k]])
        height, _, wide, *_ = np.linalg.lstsq(columns.T, values[near[k]], rcond=None)[0]
        parts[k], sizes[k] = wide, height
    return parts * np.sign(sizes), np.abs(sizes)


@dataclass(frozen=True, slots=True, eq=False)
class Ringing:
    """Modes of the frame that the base's sensor may feel.

    Attributes
    ----------
    s : tuple of complex
        Their exponents [1/s].
    t, dv : ndarray, shape (n,)
        Impacts on the run's clock [s], and velocity jumps that ring them.
    """

    s: tuple[complex, ...]
    t: Floats
    dv: Floats

    def waves(self, t: Floats) -> Floats:
        """Return the two phases of each mode, its derivative by the exponent and what rings on at first, one a row."""
        waves = [wave for s in self.s for wave in (*rung(t, self.t, self.dv, s), np.exp(s * (t - t[0])))]
        return np.array([part for wave in waves for part in (wave.real, wave.imag)]).reshape(-1, len(t))

    def away(self, f: Floats) -> npt.NDArray[np.bool_]:
        """Return which frequencies [Hz] are away from all of them: near them errors of the exponents remain."""
        away = np.ones(len(f), bool)
        for s in self.s:
            own = abs(s) / (2 * np.pi)
            away &= np.abs(f - own) > max(_NEAR, _BESIDE * own)
        return away


def _ringing(modes: Sequence[Mode], response: Response) -> Ringing | None:
    own = tuple(mode.s for mode in modes if mode.name == response.channel.name)
    return Ringing(own, response.fit.jumps.t - response.late, response.fit.jumps.dv) if own else None


def reaction(recording: Recording, base: Base, ringing: Ringing | None = None) -> Uncertain | None:
    """Return by how much the base follows the oscillator between the forcing's harmonics; None if it can't be seen.

    Parameters
    ----------
    recording : Recording
    base : Base
    ringing : Ringing, optional
        What modes of the frame ring in the base's sensor, of any size, is taken off.

    Notes
    -----
    From 1.5 to 8 times the forcing's frequency the oscillator moves by what impacts scatter, and hardly by the base.
    The part of the base's spectrum that is coherent with it, as a ratio of amplitudes: a reaction. Of n segments 1/n of
    the power is coherent by chance; that is taken off.
    """
    pairs = [tuple(recording.role(f"{body}_{kind}") for body in ("base", "lo")) for kind in ("disp", "acc")]
    both_seen = [(bins_of(a), bins_of(b)) for a, b in pairs if a is not None and b is not None]
    if not both_seen:
        return None
    of_base, of_body = both_seen[0]
    width = of_base.width
    t = np.arange(max(of_base.t[0], of_body.t[0]), min(of_base.t[-1], of_body.t[-1]), width)
    if len(t) * width < _LEAST * _SEGMENT:
        return None
    more = np.zeros((0, len(t))) if ringing is None else ringing.waves(t)
    e = _without_harmonics(np.interp(t, of_base.t, of_base.mean), t, base.fit.omega, more)
    x = _without_harmonics(np.interp(t, of_body.t, of_body.mean), t, base.fit.omega)
    size = round(_SEGMENT / width)
    f, both = csd(e, x, fs=1 / width, nperseg=size)
    of_e, of_x = (np.abs(csd(each, each, fs=1 / width, nperseg=size)[1]) for each in (e, x))
    f0 = base.fit.f
    used = (f > 1.5 * f0) & (f < 8 * f0) & (np.abs(f / f0 - np.round(f / f0)) * f0 > _NEAR)
    if ringing is not None:
        used &= ringing.away(f)
    # Hann windows that overlap by half hold as much as 1.9 of three of them would that do not.
    count = 1.9 * (len(t) / size) * 0.95
    by_chance = 1 / count
    coherent = float(np.sum(np.abs(both[used]) ** 2 / of_x[used]))
    power, own = float(np.sum(of_e[used])), float(np.sum(of_x[used]))
    square = (coherent - by_chance * power) / ((1 - by_chance) * own)
    lines = max(np.count_nonzero(used) / 1.5, 1.0)
    u = by_chance * power / own / np.sqrt(lines) + abs(square) / np.sqrt(lines * count)
    value = np.sqrt(max(square, 0.0))
    return Uncertain(float(value), float(np.sqrt(max(square, 0.0) + u) - value))


_LEAST = 6


def _without_harmonics(values: Floats, t: Floats, omega: float, more: Floats | None = None) -> Floats:
    """Return a signal less its mean, 24 harmonics of the forcing and, by least squares, further signals."""
    turn = np.exp(1j * omega * t)
    columns: list[Floats] = [np.ones(len(t))]
    power: Any = np.ones_like(turn)
    for _ in range(24):
        power = power * turn
        columns += [power.real, power.imag]
    matrix = np.stack(columns if more is None else [*columns, *more])
    matrix /= np.linalg.norm(matrix, axis=1)[:, None]
    return values - np.linalg.solve(matrix @ matrix.T, matrix @ values) @ matrix
