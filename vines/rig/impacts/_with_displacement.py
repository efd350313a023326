"""Impacts where the displacement is measured: pulses, corners, knocks that are none, flights that are two."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.rig.fit import KEEP, LEAST, U_PULSE, Bins, Fitter, JumpFit, Train, bins_of, sine_fit, straight
from vines.rig.impacts._delay import mean_shift, shrunk
from vines.rig.impacts._pulses import Pulses, find_pulses, pulses_of, refine_pulses
from vines.rig.impacts._search import LOOSE, Policy, Search, inside, search, threshold, with_silent
from vines.rig.recording import Sampled
from vines.rig.uncertainty import robust_deviation

__all__ = ["search_displacement"]

Floats = npt.NDArray[np.float64]

_FAR_OFF = 1e-3
"""Standard uncertainty of the times beside a flight that is not one [s]."""

_ALIKE = 0.05
"""By how much, in parts of a jump, a pulse may differ that has nothing beside it: more moves it by 50 us and more."""

_WARMS = 3e-5
"""Relative standard uncertainty of omega0 at any time of the record: a fifth of a kelvin."""

_MOVES = 3

_AT_REST = 1e-5


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Displaced(Search):
    """State of a search with a displacement.

    Attributes
    ----------
    pulses : Pulses
        Of the sensor that hears impacts best.
    corners : Pulses
        Second derivative of the displacement.
    u_pulse : float
        Standard uncertainty of the times of `pulses` [s].
    known : float
        Standard uncertainty of the delay by the alignment of the sensors [s].
    """

    pulses: Pulses
    corners: Pulses
    u_pulse: float
    known: float


def search_displacement(
    fitter: Fitter, channel: Sampled, accelerometer: Sampled | None, gain: complex | None = None
) -> Search:
    """Find the impacts where the displacement is measured.

    Parameters
    ----------
    fitter : Fitter
        Of the displacement.
    channel : Sampled
        That channel.
    accelerometer : Sampled or None
        On the oscillator, which hears impacts better.
    gain : complex, optional
        Of it, relative to the second derivative of the displacement, where that is known.
    """
    corners = pulses_of(channel, 0)
    if accelerometer is None:
        return search(_LASER_ALONE, _begun(fitter, corners, corners, LOOSE, 0.0, None))
    gain = gain or _gain(fitter.bins, accelerometer, fitter.model.omega)
    pulses = pulses_of(accelerometer)
    pulses = replace(pulses, values=pulses.values / (abs(gain) * np.sign(gain.real)))
    # What the alignment of the two sensors leaves open; the impacts that both see may say more.
    known = float(np.hypot(np.hypot(channel.u_time, accelerometer.u_time), 2e-6))
    return search(_LASER_AND_ACCELEROMETER, _begun(fitter, pulses, corners, U_PULSE, known, gain))


def _begun(
    fitter: Fitter, pulses: Pulses, corners: Pulses, u_pulse: float, known: float, gain: complex | None
) -> _Displaced:
    """Return the state after a first look at the pulses."""
    sparse = _bare(pulses, fitter)
    train = find_pulses(sparse, threshold(sparse), u=u_pulse)
    return _Displaced(fitter, train, gain=gain, pulses=pulses, corners=corners, u_pulse=u_pulse, known=known)


def _with(found: _Displaced, train: Train) -> _Displaced:
    return replace(found, train=inside(found.fitter.bins, train))


def _crosschecked(found: _Displaced) -> _Displaced:
    """Add impacts that only the displacement shows, and drop knocks, whose jump it should show and does not."""
    train, sparse = found.train, _bare(found.corners, found.fitter)
    seen = find_pulses(sparse, threshold(sparse), u=3 * LOOSE)
    least = 3 * threshold(sparse) * found.corners.smooth * 2.5
    near = np.abs(train.t[:, None] - seen.t[None, :]) < 1.5 * found.corners.smooth
    met = near & (np.sign(train.dv)[:, None] == np.sign(seen.dv)[None, :])
    knock = ~met.any(axis=1) & (np.abs(train.dv) > least)
    return replace(found, train=train.without(knock).merged(seen.without(met[~knock].any(axis=0))))


def _aligned(found: _Displaced) -> _Displaced:
    """Measure the delay between the sensors by a first fit, then look for what is too small to be seen before."""
    found = _with(found, found.train)
    train = found.train
    fit = found.fitter.fit(Train(train.t, train.dv, np.maximum(train.u, LOOSE)))
    return _with_soft_ones(replace(found, delay=shrunk(mean_shift(fit), found.known)[0]), fit)


def _retimed(found: _Displaced) -> _Displaced:
    """Take the times of a first fit, then look for what is too small to be seen before."""
    found = _with(found, found.train)
    fit = found.fitter.fit(found.train)
    # In order, none twice.
    times = np.sort(fit.jumps.t) + 1e-9 * np.arange(len(fit.jumps.t))
    return _with_soft_ones(replace(found, train=Train(times, found.train.dv, found.train.u)), fit)


def _with_soft_ones(found: _Displaced, fit: JumpFit) -> _Displaced:
    """Refine the pulses, now that the motion is known, and add those too small to be seen before."""
    left = found.pulses.less(_smooth(found, fit))
    heard = found.train.u <= found.u_pulse
    refined = find_pulses(left, threshold(left), found.train.only(heard), u=found.u_pulse)
    return _with(found, refine_pulses(left, refined, level=True).merged(found.train.without(heard)))


def _with_unheard(found: _Displaced) -> _Displaced:
    """Add impacts that still show as corners in what the fit leaves of the displacement."""
    pulses = found.corners
    t = pulses.t
    for _ in range(2):
        train = found.train.later(found.delay)
        fit = found.fitter.fit(train, 0)
        smooth = fit.motion.combination(t, {2: 1.0, 4: 0.5 * pulses.smooth**2})
        left = replace(pulses, values=pulses.values - smooth - pulses.shape(fit.jumps.t, fit.jumps.dv))
        seen = find_pulses(left, 1.5 * threshold(left), u=3 * LOOSE)
        new = train.distance(seen.t) > 3 * pulses.smooth
        if not new.any():
            break
        found = _with(found, found.train.merged(seen.only(new).later(-found.delay)))
    return found


def _judged(found: _Displaced) -> _Displaced:
    """Keep what is an impact, by its jump; what the sensor adds to the motion, which can hide jumps, is taken off."""
    train = found.train
    fitter = straight(found.fitter, train.later(found.delay))
    fit = fitter.fit(train.later(found.delay))
    heard = train.heard
    scale = _slope(train.dv[heard], fit.jumps.dv[heard])
    train = Train(train.t, np.where(heard, train.dv * scale, fit.jumps.dv), train.u)
    kept = train.only(_real(fit, train.dv, heard))
    return replace(found, fitter=fitter, train=kept, candidates=len(train))


def _checked(found: _Displaced) -> _Displaced:
    """Let go of the times that pulses got wrong, and measure the delay again by the others."""
    train, delay = found.train, found.delay
    if len(train) <= 5:
        return found
    loose = Train(train.t, train.dv, np.maximum(train.u, LOOSE)).later(delay)
    fit, pushed = found.fitter.fit_rubbed(loose)
    lost = ~(fit.fair[:-1] & fit.fair[1:])
    if lost.any():
        # A knock beside an impact makes one pulse of both, as far off as a millisecond.
        unsure = Train(loose.t, _sized(train.dv, lost), np.where(lost, _FAR_OFF, loose.u))
        fit = found.fitter.fit(unsure, pushed=pushed)
    u = np.where(_misheard(fit, train.dv), 3 * LOOSE, train.u)
    free = u > U_PULSE
    late, u_late, drift = mean_shift(fit)
    shift, u_delay = shrunk((delay + late, u_late), found.known)
    times = np.where(free, fit.jumps.t - delay + delay - shift, train.t)
    train = Train(times, np.where(free, fit.jumps.dv, train.dv), u)
    return _with(replace(found, delay=shift, u_delay=u_delay, drift=drift), train)


def _silent(found: _Displaced) -> _Displaced:
    """Add impacts that only the motion shows."""
    more = _with(found, with_silent(found.fitter, found.train, found.delay))
    return replace(more, complete=len(more.train) == len(found.train))


def _settled(found: _Displaced) -> _Displaced:
    """Move the impacts that only the displacement shows until they come to rest: a far step is not a small one."""
    train = found.train
    unheard = ~train.heard
    if unheard.any():
        _, pushed = found.fitter.fit_rubbed(train.later(found.delay), 0)
        for _ in range(_MOVES):
            shift = found.fitter.fit(train.later(found.delay), 0, pushed).shift
            times = np.where(unheard, train.t + shift, train.t)
            train = Train(times, train.dv, train.u)
            if np.max(np.abs(shift[unheard])) < _AT_REST or np.any(np.diff(times) <= 0):
                break
    return _with(found, train)


_LASER_AND_ACCELEROMETER = Policy(
    first=(_crosschecked, _aligned, _with_unheard, _judged),
    turn=(_checked, _silent),
    last=(_settled,),
    turns=(1, 2),
    at_rest=lambda before, after: after.complete,
)

_LASER_ALONE = Policy(
    first=(_retimed, _with_unheard, _judged),
    turn=(_silent,),
    last=(_settled,),
    turns=(1, 2),
    at_rest=lambda before, after: after.complete,
)


def _gain(bins: Bins, accelerometer: Sampled, omega: float) -> complex:
    near = omega / (2 * np.pi)
    of_x, of_a = sine_fit(bins, near=near, harmonics=3), sine_fit(bins_of(accelerometer), near=near, harmonics=3)
    return complex(of_a.harmonics[0] / (-(of_x.omega**2) * of_x.harmonics[0]))


def _bare(pulses: Pulses, fitter: Fitter) -> Pulses:
    """Return x1'' + omega0^2 x1 less the forcing: between impacts nothing is left of that."""
    t, bins, s, omega = pulses.t, fitter.bins, fitter.model.s, fitter.model.omega
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
        near = np.abs(rest) < 3 * robust_deviation(rest)
    values = values - linear @ columns
    return replace(pulses, values=values)


def _smooth(found: _Displaced, fit: JumpFit) -> Floats:
    """Return the fitted acceleration on the grid of the pulses, as the accelerometer would show it, smoothed alike."""
    gain, omega = found.gain, found.fitter.model.omega
    weights = {2: 1.0, 4: 0.5 * found.pulses.smooth**2}
    if gain is not None:
        turn = gain / (abs(gain) * np.sign(gain.real))
        weights = {2: turn.real, 4: turn.real * weights[4], 3: turn.imag / omega}
    return fit.motion.combination(found.pulses.t + found.delay, weights)


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
