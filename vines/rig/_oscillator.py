"""The oscillator's motion and its velocity jumps from its channels: detect, fit, add what is missed, prune, refine."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig._bins import Bins, bins_of
from vines.rig._impacts import Pulses, find_pulses, pulses_of
from vines.rig._jumps import JumpFit, fit_jumps
from vines.rig._linearity import bends, straightened
from vines.rig._recording import Recording, Sampled
from vines.rig._sine_fit import sine_fit
from vines.rig._split import split_flights

__all__ = ["Response", "measure_response"]

Floats = npt.NDArray[np.float64]

U_PULSE = 6e-6
"""Standard uncertainty of an impact time from a pulse of the acceleration [s]."""

_LOOSE = 1e-4
"""The same before the delay between the two sensors is known, and for times from a displacement [s]."""

_SIGMAS = 8.0
_KEEP = 5.0
_LEAST = 2e-4
"""No smaller jump is believed [m/s]."""

_EVERY = 6.25e-4
"""Distance of the values of a smoothed acceleration that the fit uses [s]: about the width of the smoothing."""

_TWIN = 8e-3
"""Impacts nearer than this, with opposite jumps, may be one and a false one beside it [s]."""

_EXPLAINS = 0.998
"""Most that is left of the residual, without noise taken off, where the sensor's linearity is believed."""

_HARMONICS = 1e-5
"""Standard uncertainty of the forced harmonics by the base's own, relative to the motion."""

_STEADY = 1.5e-6
"""Standard uncertainty, at least, of a change of the delay between two sensors [s]."""

_MOVES = 3
_AT_REST = 1e-5

_U_AREA = 0.03
"""Relative standard uncertainty of a jump by the area of its pulse: for what ringing adds."""

_U_SIDEWAYS = 3e-3
"""Sway across the axis, relative to the motion: a tenth of it, seen by a cross-axis sensitivity of some per cent."""

_EDGE = 3e-3
"""Nothing is sought so near to the ends of the record [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """The oscillator's motion with its velocity jumps.

    Attributes
    ----------
    channel : Sampled
        What was fitted.
    order : int
        0 if it is a displacement, 2 an acceleration.
    bins : Bins
        Its block means.
    fit : JumpFit
        On the clock of `channel`.
    pulse : ndarray, shape (K,)
        Velocity jumps by the pulses of the acceleration, scaled to those of the fit [m/s].
    gain : complex or None
        Accelerometer relative to the second derivative of the displacement at the forcing frequency.
    late, u_late : float
        By how much `channel` is late on the run's clock [s]: the two sensors see the same impacts, and each is
        trusted by the uncertainty of its alignment.
    drift : float
        Change of that from the first to the second half, in standard uncertainties.
    candidates, pruned : int
        Pulses looked at, and those without a velocity jump.
    """

    channel: Sampled
    order: int
    bins: Bins
    fit: JumpFit
    pulse: Floats
    gain: complex | None
    late: float
    u_late: float
    drift: float
    candidates: int
    pruned: int


def measure_response(
    recording: Recording,
    s: complex,
    omega: float,
    forced: tuple[npt.NDArray[np.complex128], Floats] | None = None,
    *,
    friction: float = 0.0,
    u_natural: tuple[float, float] = (1e-5, 1e-3),
) -> Response:
    """Find the impacts and fit the oscillator's motion.

    Parameters
    ----------
    recording : Recording
    s : complex
        -lam omega0/2 + i gamma of the free oscillation [1/s].
    omega : float
        Angular frequency of the forcing, measured [rad/s].
    forced : tuple of ndarray, optional
        As of `fit_jumps`.
    friction : float
        Acceleration of the oscillator by the ball's friction, mu times the ball's deceleration [m/s^2].
    u_natural : tuple of float
        Relative standard uncertainties of omega0 and lam.

    Raises
    ------
    RigError
        If no channel measures the oscillator.
    """
    displacement, accelerometer = recording.role("lo_disp"), recording.role("lo_acc")
    channel = displacement or accelerometer
    if channel is None:
        raise RigError(f"run {recording.run.run_id!r} has no channel on the oscillator (lo_disp or lo_acc)")
    order = 0 if displacement is not None else 2
    bins = bins_of(channel) if order == 0 else _quiet(channel)
    gain = None
    if displacement is not None and accelerometer is not None:
        gain = _gain(bins, accelerometer, omega)
    sensor = accelerometer if accelerometer is not None else channel
    both = sensor is not channel
    pulses = pulses_of(sensor, 2 if accelerometer is not None else 0)
    if gain is not None:
        pulses = replace(pulses, values=pulses.values / (abs(gain) * np.sign(gain.real)))
    corners = pulses_of(channel, 0) if order == 0 and both else pulses
    times, dv = _first_look(pulses, bins, s, omega, order)
    u = np.full(len(times), U_PULSE if accelerometer is not None else _LOOSE)
    if both:
        times, dv, u = _crosschecked(times, dv, u, corners, bins, s, omega)
    delay = 0.0
    fitter = _Fitter(bins, s, omega, order, forced)
    times, dv, u = _inside(bins, times, dv, u)
    fit = fitter.fit(times + delay, np.maximum(u, _LOOSE if both else 0.0), dv)
    # What the alignment of the two sensors leaves open; the impacts that both see may say more.
    known = float(np.hypot(np.hypot(channel.u_time, sensor.u_time), 2e-6))
    if both:
        delay = _shrunk(_mean_shift(fit), known)[0]
    elif order == 0:
        times = _ascending(fit.jumps.t)
    left = pulses.less(_smooth(fit, pulses, gain, omega, delay))
    if order == 2:
        # Beside a missed impact the fitted motion is off, slowly.
        left = left.sparse()
    times, dv, u = _with_soft_ones(left, times, dv, u, U_PULSE if accelerometer is not None else _LOOSE)
    times, dv, u = _inside(bins, times, dv, u)
    if order == 0:
        times, dv, u = _with_unheard(corners, fitter, times, dv, u, delay)
    fit = fitter.fit(times + delay, u, dv)
    heard = u <= U_PULSE
    scale = _slope(dv[heard], fit.jumps.dv[heard]) if accelerometer is not None else 1.0
    dv = np.where(heard, dv * scale, fit.jumps.dv)
    real = _real(fit, dv, heard)
    candidates = len(times)
    times, dv, u = times[real], dv[real], u[real]
    times, dv, u = _with_silent(fitter, times, dv, u, delay)
    drift = u_delay = 0.0
    if both and len(times) > 5:
        again = fitter.fit(times + delay, np.maximum(u, _LOOSE), dv)
        u = np.where(_misheard(again, dv), 3 * _LOOSE, u)
        seen = _mean_shift(again)
        drift = seen[2]
        shift, u_delay = _shrunk((delay + seen[0], seen[1]), known)
        times = np.where(u > U_PULSE, again.jumps.t - shift, times)
        delay = shift
    times = _settled(fitter, times, dv, u, delay)
    ahead = np.argsort(times, kind="stable")
    times, dv, u = _inside(bins, times[ahead], dv[ahead], u[ahead])
    keep = _credible(fitter.fit(times + delay, u, dv), u)
    times, dv, u = times[keep], dv[keep], u[keep]
    steps = pushed(-np.sign(dv), friction / abs(s) ** 2)
    if order == 0:
        fitter = _linear(fitter, times + delay, u, dv, steps, u_natural)
        bins = fitter.bins
    fit = fitter.fit(times + delay, u, dv, draws=32, steps=steps)
    late, u_late = _share(delay, u_delay, channel.u_time, sensor.u_time) if both else (0.0, channel.u_time)
    return Response(channel, order, bins, fit, dv, gain, late, u_late, drift, candidates, candidates - len(times))


@dataclass(frozen=True, slots=True, eq=False)
class _Fitter:
    """What all fits of a run share."""

    bins: Bins
    s: complex
    omega: float
    order: int
    forced: tuple[npt.NDArray[np.complex128], Floats] | None

    def fit(
        self,
        times: Floats,
        u: Floats,
        dv: Floats,
        draws: int = 8,
        steps: Floats | None = None,
        extra: tuple[Floats, Floats] | None = None,
    ) -> JumpFit:
        def once(expected: tuple[Floats, Floats] | None, more: tuple[Floats, Floats] | None, draws: int) -> JumpFit:
            return fit_jumps(
                self.bins, self.s, self.omega, times, u, dv, order=self.order, draws=draws, forced=self.forced,
                steps=steps, extra=more, expected=expected,
            )  # fmt: skip

        if self.order == 0:
            return once(None, extra, draws)
        # Alone, an acceleration hardly tells a train of equal jumps from a forced response; the areas of the pulses do.
        spread = _U_AREA * np.abs(dv) + _LEAST / 2
        first = once((dv, spread), None, 0)
        knocks = np.abs(first.jumps.dv - dv) > _KEEP * spread
        sideways = (self.omega * first.motion.at(self.bins.t, 1)[None, :], np.array([_U_SIDEWAYS]))
        return once((dv, np.where(knocks, np.abs(dv), spread)), sideways, draws)


def pushed(side: Floats, size: float) -> Floats:
    """Return the static displacement of each flight by friction: to the right after an impact on the left end."""
    steps = np.zeros(len(side) + 1)
    if len(side) > 1:
        steps[1:-1] = np.where(side[:-1] != side[1:], side[:-1] * size, 0.0)
    return steps


def _threshold(pulses: Pulses) -> float:
    return max(_SIGMAS * pulses.noise, _LEAST / (pulses.smooth * 2.5))


def _ascending(times: Floats) -> Floats:
    """Return times in order, none twice."""
    times = np.sort(times)
    return times + 1e-9 * np.arange(len(times))


def _crosschecked(
    times: Floats, dv: Floats, u: Floats, pulses: Pulses, bins: Bins, s: complex, omega: float
) -> tuple[Floats, Floats, Floats]:
    """Add impacts that only the displacement shows, and drop knocks, whose jump it should show and does not."""
    sparse = _bare(pulses, bins, s, omega)
    seen, jumps = find_pulses(sparse, _threshold(sparse))
    least = 3 * _threshold(sparse) * pulses.smooth * 2.5
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
    found, jumps = find_pulses(left, _threshold(left), times=times[heard], dv=dv[heard])
    times = np.concatenate([found, times[~heard]])
    dv = np.concatenate([jumps, dv[~heard]])
    u = np.concatenate([np.full(len(found), u_new), u[~heard]])
    ahead = np.argsort(times, kind="stable")
    return times[ahead], dv[ahead], u[ahead]


def _with_unheard(
    pulses: Pulses, fitter: _Fitter, times: Floats, dv: Floats, u: Floats, delay: float
) -> tuple[Floats, Floats, Floats]:
    """Add impacts that still show as corners in what the fit leaves of the displacement."""
    t = pulses.t
    for _ in range(2):
        fit = fitter.fit(times + delay, u, dv)
        smooth = fit.motion.combination(t, {2: 1.0, 4: 0.5 * pulses.smooth**2})
        left = replace(pulses, values=pulses.values - smooth - pulses.shape(fit.jumps.t, fit.jumps.dv))
        found, jumps = find_pulses(left, 1.5 * _threshold(left))
        away = np.array([np.min(np.abs(times + delay - one), initial=np.inf) for one in found])
        new = away > 3 * pulses.smooth
        if not new.any():
            break
        times = np.concatenate([times, found[new] - delay])
        dv = np.concatenate([dv, jumps[new]])
        u = np.concatenate([u, np.full(int(new.sum()), 3 * _LOOSE)])
        ahead = np.argsort(times, kind="stable")
        times, dv, u = _inside(fitter.bins, times[ahead], dv[ahead], u[ahead])
    return times, dv, u


def _with_silent(fitter: _Fitter, times: Floats, dv: Floats, u: Floats, delay: float) -> tuple[Floats, Floats, Floats]:
    """Add impacts that only the motion shows."""
    found, jumps = split_flights(fitter.bins, fitter.fit(times + delay, u, dv, draws=0), fitter.order)
    times = np.concatenate([times, found - delay])
    dv = np.concatenate([dv, jumps])
    u = np.concatenate([u, np.full(len(found), 5 * _LOOSE)])
    ahead = np.argsort(times, kind="stable")
    return _inside(fitter.bins, times[ahead], dv[ahead], u[ahead])


def _quiet(accelerometer: Sampled) -> Bins:
    """Return an acceleration as the fit can use it: smoothed, for structural ringing is many times the motion."""
    pulses = pulses_of(accelerometer)
    stride = max(1, round(_EVERY / pulses.step))
    t = pulses.t[::stride]
    bad = accelerometer.start + np.flatnonzero(~accelerometer.valid) / accelerometer.rate
    place = np.searchsorted(bad, t)
    apart = np.full(len(t), np.inf)
    if len(bad):
        apart = np.minimum(np.abs(bad[np.maximum(place - 1, 0)] - t), np.abs(bad[np.minimum(place, len(bad) - 1)] - t))
    fair = apart > 5 * pulses.smooth
    return Bins(t[fair], pulses.values[::stride][fair], 0.0, pulses.smooth)


def _gain(bins: Bins, accelerometer: Sampled, omega: float) -> complex:
    near = omega / (2 * np.pi)
    of_x, of_a = sine_fit(bins, near=near, harmonics=3), sine_fit(bins_of(accelerometer), near=near, harmonics=3)
    return complex(of_a.harmonics[0] / (-(of_x.omega**2) * of_x.harmonics[0]))


def _first_look(pulses: Pulses, bins: Bins, s: complex, omega: float, order: int) -> tuple[Floats, Floats]:
    sparse = _bare(pulses, bins, s, omega) if order == 0 else pulses.sparse()
    return find_pulses(sparse, _threshold(sparse))


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
        near = np.abs(rest) < 3 * np.median(np.abs(rest)) / 0.6745
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


def _inside(bins: Bins, times: Floats, dv: Floats, u: Floats) -> tuple[Floats, Floats, Floats]:
    keep = (times > bins.t[0] + _EDGE) & (times < bins.t[-1] - _EDGE)
    keep[1:] &= np.diff(times) > 1e-6
    return times[keep], dv[keep], u[keep]


def _credible(fit: JumpFit, u: Floats) -> npt.NDArray[np.bool_]:
    """Say which impacts to keep: of two in one place, with jumps that cancel, not the one that was heard less well."""
    dv, t = fit.jumps.dv, fit.motion.starts[1:]
    keep = (np.abs(dv) > _KEEP * fit.u_dv) | (u <= U_PULSE)
    near = np.flatnonzero((np.diff(t) < _TWIN) & (dv[:-1] * dv[1:] < 0))
    worse = np.where(u[near] > u[near + 1], near, near + 1)
    keep[worse[(u[worse] > U_PULSE)]] = False
    return keep


def _linear(
    fitter: _Fitter, times: Floats, u: Floats, dv: Floats, steps: Floats, u_natural: tuple[float, float]
) -> _Fitter:
    """Return the fitter with the displacement less what its sensor adds, if that explains a part of what is left.

    Harmonics that the base does not have are the sensor's then: without that, they and jumps that repeat would say the
    same.
    """
    fit = fitter.fit(times, u, dv, steps=steps)
    columns, sizes = bends(fitter.bins, fit.motion, *u_natural)
    strict = fitter
    if fitter.forced is not None:
        c, u_c = fitter.forced
        known = 0.03 * np.abs(c) + _HARMONICS * float(np.abs(fitter.bins.mean).max())
        strict = replace(fitter, forced=(c, np.minimum(u_c, known)))
    bent = strict.fit(times, u, dv, steps=steps, extra=(columns, sizes))
    if bent.residual > _EXPLAINS * fit.residual:
        return fitter
    return replace(strict, bins=straightened(fitter.bins, columns, bent.extra))


def _misheard(fit: JumpFit, pulse: Floats) -> npt.NDArray[np.bool_]:
    """Say which pulses are not those of their impacts but of what rings after one that the sensor missed."""
    middle = float(np.median(fit.shift))
    u_shift = np.hypot(fit.draws.t.std(axis=0), U_PULSE)
    late = np.abs(fit.shift - middle) > _KEEP * u_shift
    dv = np.abs(fit.jumps.dv)
    other = np.abs(fit.jumps.dv - pulse) > 0.3 * dv + _KEEP * fit.u_dv
    return (late | other) & (dv > _KEEP * fit.u_dv)


def _settled(fitter: _Fitter, times: Floats, dv: Floats, u: Floats, delay: float) -> Floats:
    """Move the impacts that only the displacement shows until they come to rest: a far step is not a small one."""
    unheard = u > U_PULSE
    for _ in range(_MOVES):
        if not unheard.any() or np.any(np.diff(times) <= 0):
            break
        shift = fitter.fit(times + delay, u, dv).shift
        times = np.where(unheard, times + shift, times)
        if np.max(np.abs(shift[unheard])) < _AT_REST:
            break
    return times


def _mean_shift(fit: JumpFit) -> tuple[float, float, float]:
    """Return the mean shift of the times, its standard uncertainty, and its change over the record in units of that."""
    weight = fit.jumps.dv**2 * (np.abs(fit.jumps.dv) > _KEEP * fit.u_dv)
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
    dv = np.abs(fit.jumps.dv)
    alike = np.abs(fit.jumps.dv - pulse) < 0.5 * dv + _KEEP * fit.u_dv
    seen = (dv > _KEEP * fit.u_dv) & (dv > _LEAST) & (alike | (dv > 30 * fit.u_dv))
    # Beside a large jump a small one may be the misfit of its pulse: where the fit can't say, only a fair size counts.
    blind = fit.u_dv > 0.2 * np.maximum(np.abs(pulse), 0.25 * np.median(np.abs(pulse)))
    return seen | (blind & heard & (np.abs(fit.jumps.dv - pulse) < _KEEP * fit.u_dv))


def _share(delay: float, u_delay: float, u_channel: float, u_sensor: float) -> tuple[float, float]:
    """Return how late the fitted channel is itself, of the delay between both, and the uncertainty of that."""
    own, other = max(u_channel, 1e-7), max(u_sensor, 1e-7)
    share = own**2 / (own**2 + other**2)
    return share * delay, float(np.hypot(share * u_delay, own * other / np.hypot(own, other)))
