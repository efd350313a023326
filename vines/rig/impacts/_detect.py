"""Impacts from what the channels show: pulses, corners, knocks that are none, flights that are two."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.rig.fit import KEEP, LEAST, Bins, Fitter, JumpFit, bins_of, sine_fit, straight
from vines.rig.impacts._pulses import Pulses, find_pulses, pulses_of, refine_pulses
from vines.rig.impacts._split import split_flights
from vines.rig.recording import Sampled
from vines.rig.spread import spread_about

__all__ = ["SIGMAS", "U_PULSE", "Detected", "detect", "inside", "threshold"]

Floats = npt.NDArray[np.float64]

U_PULSE = 6e-6
"""Standard uncertainty of an impact time from a pulse of the acceleration [s]."""

_LOOSE = 1e-4
"""The same before the delay between the two sensors is known, and for times from a displacement [s]."""

_FAR_OFF = 1e-3
"""Standard uncertainty of the times beside a flight that is not one [s]."""

_ALIKE = 0.05
"""By how much, in parts of a jump, a pulse may differ that has nothing beside it: more moves it by 50 us and more."""

_WARMS = 3e-5
"""Relative standard uncertainty of omega0 at any time of the record: a fifth of a kelvin."""

_PASSES = 2

SIGMAS = 8.0
"""What stands out of noise."""

_STEADY = 1.5e-6
"""Standard uncertainty, at least, of a change of the delay between two sensors [s]."""

_MOVES = 3

_AT_REST = 1e-5

_EDGE = 3e-3
"""Nothing is sought so near to the ends of the record [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Detected:
    """Impacts as candidates for the fit.

    Attributes
    ----------
    t, dv, u : ndarray, shape (K,)
        Times on the clock of the sensor that heard them [s], velocity jumps [m/s], standard uncertainties of the times.
    candidates : int
        Pulses looked at.
    delay, u_delay : float
        By how much the fitted channel is later than that sensor, and its standard uncertainty [s].
    drift : float
        Change of that over the record, in standard uncertainties.
    gain : complex or None
        Accelerometer relative to the second derivative of the displacement at the forcing frequency.
    """

    t: Floats
    dv: Floats
    u: Floats
    candidates: int
    delay: float = 0.0
    u_delay: float = 0.0
    drift: float = 0.0
    gain: complex | None = None


def detect(fitter: Fitter, channel: Sampled, sensor: Sampled) -> Detected:
    """Find the impacts where the displacement is measured.

    Parameters
    ----------
    fitter : Fitter
        Of the displacement.
    channel, sensor : Sampled
        That channel, and the one that hears impacts best: an accelerometer if there is one.
    """
    bins, omega = fitter.bins, fitter.omega
    both, heard_well = sensor is not channel, sensor.role == "lo_acc"
    gain = _gain(bins, sensor, omega) if both else None
    pulses = pulses_of(sensor, 2 if heard_well else 0)
    if gain is not None:
        pulses = replace(pulses, values=pulses.values / (abs(gain) * np.sign(gain.real)))
    corners = pulses_of(channel, 0) if both else pulses
    times, dv = _first_look(pulses, bins, fitter.s, omega)
    u = np.full(len(times), U_PULSE if heard_well else _LOOSE)
    if both:
        times, dv, u = _crosschecked(times, dv, u, corners, bins, fitter.s, omega)
    delay = 0.0
    times, dv, u = inside(bins, times, dv, u)
    fit = fitter.fit(times + delay, np.maximum(u, _LOOSE if both else 0.0), dv)
    # What the alignment of the two sensors leaves open; the impacts that both see may say more.
    known = float(np.hypot(np.hypot(channel.u_time, sensor.u_time), 2e-6))
    if both:
        delay = _shrunk(_mean_shift(fit), known)[0]
    else:
        times = _ascending(fit.jumps.t)
    left = pulses.less(_smooth(fit, pulses, gain, omega, delay))
    times, dv, u = _with_soft_ones(left, times, dv, u, U_PULSE if heard_well else _LOOSE)
    times, dv, u = inside(bins, times, dv, u)
    times, dv, u = _with_unheard(corners, fitter, times, dv, u, delay)
    # What is an impact is judged by its jump, and what the sensor adds to the motion can hide the jumps of a train.
    fitter = straight(fitter, times + delay, u, dv)
    fit = fitter.fit(times + delay, u, dv)
    heard = u <= U_PULSE
    scale = _slope(dv[heard], fit.jumps.dv[heard]) if heard_well else 1.0
    dv = np.where(heard, dv * scale, fit.jumps.dv)
    real = _real(fit, dv, heard)
    candidates = len(times)
    times, dv, u = times[real], dv[real], u[real]
    drift = u_delay = 0.0
    for _ in range(_PASSES):
        if both and len(times) > 5:
            times, dv, u, seen = _checked(fitter, times, dv, u, delay)
            drift = seen[2]
            shift, u_delay = _shrunk((delay + seen[0], seen[1]), known)
            times = np.where(u > U_PULSE, times + delay - shift, times)
            delay = shift
            ahead = np.argsort(times, kind="stable")
            times, dv, u = inside(bins, times[ahead], dv[ahead], u[ahead])
        count = len(times)
        times, dv, u = _with_silent(fitter, times, dv, u, delay)
        if len(times) == count:
            break
    times = _settled(fitter, times, dv, u, delay)
    ahead = np.argsort(times, kind="stable")
    times, dv, u = inside(bins, times[ahead], dv[ahead], u[ahead])
    return Detected(times, dv, u, candidates, delay, u_delay, drift, gain)


def threshold(pulses: Pulses) -> float:
    """Return the least height of the pulse of an impact [m/s^2]."""
    return max(SIGMAS * pulses.noise, LEAST / (pulses.smooth * 2.5))


def _ascending(times: Floats) -> Floats:
    """Return times in order, none twice."""
    times = np.sort(times)
    return times + 1e-9 * np.arange(len(times))


def _crosschecked(
    times: Floats, dv: Floats, u: Floats, pulses: Pulses, bins: Bins, s: complex, omega: float
) -> tuple[Floats, Floats, Floats]:
    """Add impacts that only the displacement shows, and drop knocks, whose jump it should show and does not."""
    sparse = _bare(pulses, bins, s, omega)
    seen, jumps = find_pulses(sparse, threshold(sparse))
    least = 3 * threshold(sparse) * pulses.smooth * 2.5
    reach = 1.5 * pulses.smooth
    gap = np.abs(times[:, None] - seen[None, :]) if len(seen) else np.full((len(times), 1), np.inf)
    sign = np.sign(dv)[:, None] == np.sign(jumps)[None, :] if len(seen) else np.zeros((len(times), 1), bool)
    met = (gap < reach) & sign
    knock = ~met.any(axis=1) & (np.abs(dv) > least)
    unheard = ~met[~knock].any(axis=0) if len(seen) else np.zeros(0, bool)
    times = np.concatenate([times[~knock], seen[unheard]])
    dv = np.concatenate([dv[~knock], jumps[unheard]])
    u = np.concatenate([u[~knock], np.full(int(unheard.sum()), 3 * _LOOSE)])
    ahead = np.argsort(times, kind="stable")
    return times[ahead], dv[ahead], u[ahead]


def _with_soft_ones(left: Pulses, times: Floats, dv: Floats, u: Floats, u_new: float) -> tuple[Floats, Floats, Floats]:
    """Refine the pulses, now that the motion is known, and add those too small to be seen before."""
    heard = u <= u_new
    found, jumps = find_pulses(left, threshold(left), times=times[heard], dv=dv[heard])
    if not left.echo:
        found, jumps = refine_pulses(left, found, jumps, level=True)
    times = np.concatenate([found, times[~heard]])
    dv = np.concatenate([jumps, dv[~heard]])
    u = np.concatenate([np.full(len(found), u_new), u[~heard]])
    ahead = np.argsort(times, kind="stable")
    return times[ahead], dv[ahead], u[ahead]


def _with_unheard(
    pulses: Pulses, fitter: Fitter, times: Floats, dv: Floats, u: Floats, delay: float
) -> tuple[Floats, Floats, Floats]:
    """Add impacts that still show as corners in what the fit leaves of the displacement."""
    t = pulses.t
    for _ in range(2):
        fit = fitter.fit(times + delay, u, dv)
        smooth = fit.motion.combination(t, {2: 1.0, 4: 0.5 * pulses.smooth**2})
        left = replace(pulses, values=pulses.values - smooth - pulses.shape(fit.jumps.t, fit.jumps.dv))
        found, jumps = find_pulses(left, 1.5 * threshold(left))
        away = np.array([np.min(np.abs(times + delay - one), initial=np.inf) for one in found])
        new = away > 3 * pulses.smooth
        if not new.any():
            break
        times = np.concatenate([times, found[new] - delay])
        dv = np.concatenate([dv, jumps[new]])
        u = np.concatenate([u, np.full(int(new.sum()), 3 * _LOOSE)])
        ahead = np.argsort(times, kind="stable")
        times, dv, u = inside(fitter.bins, times[ahead], dv[ahead], u[ahead])
    return times, dv, u


def _with_silent(fitter: Fitter, times: Floats, dv: Floats, u: Floats, delay: float) -> tuple[Floats, Floats, Floats]:
    """Add impacts that only the motion shows."""
    fit, pushed = fitter.fit_rubbed(times + delay, u, dv, 0)
    found, jumps = split_flights(fitter.bins, fit, fitter.order, pushed)
    times = np.concatenate([times, found - delay])
    dv = np.concatenate([dv, jumps])
    u = np.concatenate([u, np.full(len(found), 5 * _LOOSE)])
    ahead = np.argsort(times, kind="stable")
    return inside(fitter.bins, times[ahead], dv[ahead], u[ahead])


def _gain(bins: Bins, accelerometer: Sampled, omega: float) -> complex:
    near = omega / (2 * np.pi)
    of_x, of_a = sine_fit(bins, near=near, harmonics=3), sine_fit(bins_of(accelerometer), near=near, harmonics=3)
    return complex(of_a.harmonics[0] / (-(of_x.omega**2) * of_x.harmonics[0]))


def _first_look(pulses: Pulses, bins: Bins, s: complex, omega: float) -> tuple[Floats, Floats]:
    sparse = _bare(pulses, bins, s, omega)
    return find_pulses(sparse, threshold(sparse))


def _bare(pulses: Pulses, bins: Bins, s: complex, omega: float) -> Pulses:
    """Return x1'' + omega0^2 x1 less the forcing: between impacts nothing is left of that."""
    t = pulses.t
    values = pulses.values + abs(s) ** 2 * np.interp(t, bins.t, bins.mean)
    span = slice(None, None, 8)
    turn = np.exp(1j * omega * t)
    second = turn * turn
    columns = np.stack(
        [np.ones(len(t)), *(f(power) for power in (turn, second, second * turn) for f in (np.real, np.imag))]
    )
    some, part = values[span], columns[:, span]
    near = np.ones(len(some), bool)
    linear = np.zeros(7)
    for _ in range(3):
        linear = np.linalg.lstsq(part[:, near].T, some[near], rcond=None)[0]
        rest = some - linear @ part
        near = np.abs(rest) < 3 * spread_about(0.0, rest)
    values = values - linear @ columns
    return replace(pulses, values=values)


def _smooth(fit: JumpFit, pulses: Pulses, gain: complex | None, omega: float, delay: float) -> Floats:
    """Return the fitted acceleration on the grid of the pulses, as the accelerometer would show it, smoothed alike."""
    t = pulses.t + delay
    weights = {2: 1.0, 4: 0.5 * pulses.smooth**2}
    if gain is not None:
        turn = gain / (abs(gain) * np.sign(gain.real))
        weights = {2: turn.real, 4: turn.real * weights[4], 3: turn.imag / omega}
    return fit.motion.combination(t, weights)


def inside(bins: Bins, times: Floats, dv: Floats, u: Floats) -> tuple[Floats, Floats, Floats]:
    keep = (times > bins.t[0] + _EDGE) & (times < bins.t[-1] - _EDGE)
    keep[1:] &= np.diff(times) > 1e-6
    return times[keep], dv[keep], u[keep]


def _checked(
    fitter: Fitter, times: Floats, dv: Floats, u: Floats, delay: float
) -> tuple[Floats, Floats, Floats, tuple[float, float, float]]:
    """Let go of the times that pulses got wrong, and return the mean shift of the others as of `_mean_shift`."""
    loose = np.maximum(u, _LOOSE)
    fit, pushed = fitter.fit_rubbed(times + delay, loose, dv)
    lost = ~(fit.fair[:-1] & fit.fair[1:])
    if lost.any():
        # A knock beside an impact makes one pulse of both, as far off as a millisecond.
        fit = fitter.fit(times + delay, np.where(lost, _FAR_OFF, loose), _sized(dv, lost), pushed=pushed)
    u = np.where(_misheard(fit, dv), 3 * _LOOSE, u)
    free = u > U_PULSE
    times, dv = np.where(free, fit.jumps.t - delay, times), np.where(free, fit.jumps.dv, dv)
    return times, dv, u, _mean_shift(fit)


def _misheard(fit: JumpFit, pulse: Floats) -> npt.NDArray[np.bool_]:
    """Say which pulses are not those of their impacts but of what rings after one that the sensor missed, or of both.

    Not more is asked of a flight than omega0 is known to within the record, which bends long ones.
    """
    middle = float(np.median(fit.shift))
    motion, dv = fit.motion, np.abs(fit.jumps.dv)
    length = np.diff(np.append(motion.starts, motion.stop))
    bent = _WARMS * abs(motion.s) * length * np.abs(motion.z)
    u_gap = np.hypot(bent[:-1], bent[1:])
    u_shift = np.sqrt(fit.draws.t.var(axis=0) + U_PULSE**2 + (u_gap / np.maximum(dv, 1e-6)) ** 2)
    late = np.abs(fit.shift - middle) > KEEP * u_shift
    other = np.abs(fit.jumps.dv - pulse) > _ALIKE * dv + KEEP * fit.u_dv
    return (late | other) & (dv > KEEP * fit.u_dv)


def _sized(dv: Floats, unsure: npt.NDArray[np.bool_]) -> Floats:
    """Return sizes of jumps by which their times may move, where pulses are not sure no smaller than usual."""
    return np.where(unsure, np.maximum(np.abs(dv), np.median(np.abs(dv))), dv)


def _settled(fitter: Fitter, times: Floats, dv: Floats, u: Floats, delay: float) -> Floats:
    """Move the impacts that only the displacement shows until they come to rest: a far step is not a small one."""
    unheard = u > U_PULSE
    if not unheard.any():
        return times
    _, pushed = fitter.fit_rubbed(times + delay, u, dv, 0)
    for _ in range(_MOVES):
        if np.any(np.diff(times) <= 0):
            break
        shift = fitter.fit(times + delay, u, dv, draws=0, pushed=pushed).shift
        times = np.where(unheard, times + shift, times)
        if np.max(np.abs(shift[unheard])) < _AT_REST:
            break
    return times


def _mean_shift(fit: JumpFit) -> tuple[float, float, float]:
    """Return the mean shift of the times, its standard uncertainty, and its change over the record in units of that."""
    weight = fit.jumps.dv**2 * (np.abs(fit.jumps.dv) > KEEP * fit.u_dv)
    if np.count_nonzero(weight) < 8:
        return 0.0, _LOOSE, 0.0

    def mean(part: slice) -> tuple[float, float]:
        w, shift = weight[part], fit.shift[part]
        centre = float(np.sum(w * shift) / np.sum(w))
        return centre, float(np.sqrt(np.sum(w**2 * (shift - centre) ** 2)) / np.sum(w))

    half = len(weight) // 2
    (early, u_early), (later, u_later) = mean(slice(0, half)), mean(slice(half, None))
    return *mean(slice(None)), (later - early) / max(float(np.hypot(u_early, u_later)), _STEADY)


def _shrunk(seen: tuple[float, ...], known: float) -> tuple[float, float]:
    """Return the delay between two sensors and its uncertainty: what the impacts say and the alignment, weighted."""
    weight = known**2 / (known**2 + seen[1] ** 2)
    return weight * seen[0], known * seen[1] / float(np.hypot(known, seen[1]))


def _slope(pulse: Floats, dv: Floats) -> float:
    """Return the factor from areas of pulses to velocity jumps: a median, weighted by size."""
    big = np.abs(pulse) >= np.median(np.abs(pulse)) if len(pulse) else np.zeros(0, bool)
    ratio = dv[big] / pulse[big]
    return float(np.median(ratio)) if len(ratio) and np.median(ratio) > 0.2 else 1.0


def _real(fit: JumpFit, pulse: Floats, heard: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Say which candidates are impacts: the momentum of the oscillator changed, and, if soft, by what the pulse says.

    Where the displacement can't say (a neighbouring flight holds a missed impact), what was heard counts.
    """
    if not len(pulse):  # nothing has a usual size then
        return np.zeros(0, dtype=bool)
    dv = np.abs(fit.jumps.dv)
    alike = np.abs(fit.jumps.dv - pulse) < 0.5 * dv + KEEP * fit.u_dv
    seen = (dv > KEEP * fit.u_dv) & (dv > LEAST) & (alike | (dv > 30 * fit.u_dv))
    # Beside a large jump a small one may be the misfit of its pulse: where the fit can't say, only a fair size counts.
    blind = fit.u_dv > 0.2 * np.maximum(np.abs(pulse), 0.25 * np.median(np.abs(pulse)))
    return seen | (blind & heard & (np.abs(fit.jumps.dv - pulse) < KEEP * fit.u_dv))
