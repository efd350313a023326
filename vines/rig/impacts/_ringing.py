"""Modes of the frame that impacts ring: found in the stretches between impacts, modelled beside the motion, taken off.

A mode adds the same decaying sine, times the velocity jump, after each impact. Where it rings in the displacement it
hides the corners that impacts make: then a first train of impacts comes from what cannot be predicted from before, for
damped sines of whatever frequency can.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Bins, Fitter, JumpFit, JumpModel, Train, bins_of
from vines.rig.impacts._pulses import pulses_of
from vines.rig.impacts._resonances import resonances
from vines.rig.recording import ROLES, Sampled
from vines.rig.uncertainty import robust_deviation

__all__ = ["Mode", "less_modes", "mean_ringing", "modes_felt", "modes_heard", "modes_seen", "rung", "unpredicted"]

Floats = npt.NDArray[np.float64]

_LOWEST, _HIGHEST = 15.0, 700.0
"""[Hz] Above the motion and its harmonics; below what smoothing takes away."""
_DAMPED = 0.2
"""Largest damping ratio: what dies out faster is no ringing."""
_LONGEST = 0.1
"""[s] So much after an impact is looked at, at most."""
_MOST_DAMPED = 0.06
"""Damping ratio of a frame's mode, at most."""
_USUAL = 0.03
"""Damping ratio from which the search for a pole begins, at most."""
_TURNS = 16
_STRETCH = 15.0
"""[s] So much of a record gives the poles."""
_EDGE = 3e-3
_BESIDE = 0.12
"""Nearer poles, relative to their size, are one."""
_MOST = 6
_SHARE = 0.02
"""Least part of the mean response after impacts that a mode explains."""
_BETTER = 0.9
"""Most that is left of a residual where modes are believed."""
_HEARD = 30.0
"""[1/s] Least size of a mode in an acceleration relative to the jump: 5 % of the pulse of an impact."""
_SLOW = (20.0, 25.0, 31.0, 38.0, 47.0, 58.0, 72.0)
"""[Hz]"""
_CLEAN = 1.2
"""What a fit without modes leaves at most, relative to the noise."""
_LAGS = 64
"""Samples from which the next one is predicted: 20 ms."""
_STANDS_OUT = 6.0
_APART = 4e-3
"""[s]"""
_LOOSE = 1.5e-4
"""[s] Standard uncertainty of the times that prediction gives."""
_UNDAMPED = 3e-3
"""Damping ratio below which a sine may be a harmonic of the forcing, or hum."""
_HARMONIC = 0.02
"""How near to one, in parts of the forcing's frequency."""
_HARMONICS = 24
"""Of the forcing, in a channel of the base."""
_SEEN = 0.2
"""Least size of a mode after the usual impact, relative to the noise."""
_BEFORE = 10.0
"""So many usual jumps at once ring a mode as much as all that came before a record, at most."""


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode that rings in a channel after impacts.

    Attributes
    ----------
    role, name : str
        Of the channel.
    frequency, damping : float
        [Hz] and damping ratio.
    s, size : complex
        After an impact with velocity jump dv the channel has Re(size dv exp(s t)) more.
    since, before : float and complex
        What rings on of impacts before the record is Re(before exp(s (t - since))).
    usual : float
        |size| times the usual |dv|, in the unit of the channel.
    """

    role: str
    name: str
    frequency: float
    damping: float
    s: complex
    size: complex
    since: float
    before: complex
    usual: float

    def signal(self, t: Floats, times: Floats, dv: Floats) -> Floats:
        """Return what the channel has more at times on its clock, with impacts on that clock."""
        own = times > self.since + _EDGE
        return (
            self.size * rung(t, times[own], dv[own], self.s)[0] + self.before * np.exp(self.s * (t - self.since))
        ).real

    @property
    def text(self) -> str:
        """What it is, in a few words."""
        return (
            f"{self.frequency:.4g} Hz (damping {self.damping:.2g}) in {self.name}, {self.usual:.2g} "
            f"{ROLES[self.role][1]} after an impact"
        )


def modes_seen(fitter: Fitter, channel: Sampled, train: Train, known: tuple[Mode, ...] = ()) -> tuple[Mode, ...]:
    """Return the modes that ring in a displacement, by least squares beside its motion; none if they explain little.

    Parameters
    ----------
    fitter : Fitter
        Of the displacement.
    channel : Sampled
        That channel.
    train : Train
        Impacts on its clock.
    known : tuple of Mode
        Found before, with other impacts.
    """
    model = replace(fitter.model, bins=_stretch(fitter.bins))
    part = train.between(float(model.bins.t[0]) + _EDGE, float(model.bins.t[-1]) - _EDGE)
    if len(part) < 6:
        return ()
    plain = fit = model.fit(part, draws=0)
    poles = [mode.s for mode in known if mode.name == channel.name]
    if poles:
        poles, fit = _tuned(model, part, fit, poles)
    free = [] if poles else _free(model, part.t)
    for _ in range(3):
        if fit.residual < _CLEAN * fit.noise:
            break
        new = _poles(fit.left_t, fit.left, fit.jumps.t, fit.jumps.dv, model.bins.width)
        new = _apart([*poles, *new])[len(poles) : _MOST]
        # A slow mode is half taken up by the flights, so that what they leave does not tell its pole.
        slow = [[_begun(2 * np.pi * f * complex(-_USUAL, 1.0))] for f in _SLOW]
        starts = [free] if free else [new, *slow] if poles else [new, *([*new, *one] for one in slow)]
        free = []
        begun = [_apart([*poles, *start]) for start in starts if start]
        fits = [_with_modes(model, part, fit.jumps.dv, start) for start in begun if len(start) > len(poles)]
        if not fits:
            break
        best = int(np.argmin([each.residual for each in fits]))
        tried, again = _tuned(model, part, fit, [start for start in begun if len(start) > len(poles)][best])
        if again.residual > _BETTER * fit.residual:
            break
        poles, fit = tried, again
    if not poles or fit.residual > _BETTER * plain.residual:
        return ()
    # The whole record tells the sizes, and what rings at its begin.
    whole = fitter.model
    since = float(whole.bins.t[0])
    part = train.between(since + _EDGE, float(whole.bins.t[-1]) - _EDGE)
    fit = _with_modes(whole, part, part.dv, poles)
    sizes = np.abs(_complex(fit.extra)[: len(poles)]) * np.median(np.abs(part.dv))
    if np.any(sizes < _SEEN * fit.noise):
        poles = [s for s, size in zip(poles, sizes, strict=True) if size >= _SEEN * fit.noise]
        fit = _with_modes(whole, part, part.dv, poles)
    bare = [each / whole.bins.response(s) for s, each in zip([*poles, *poles], _complex(fit.extra), strict=True)]
    return _told(channel, fit.jumps.dv, poles, bare, since)


def _free(model: JumpModel, times: Floats) -> list[complex]:
    """Return poles by what the flights are made of: those that are neither the motion, its harmonics nor hum."""
    own = []
    for s in resonances(model.bins, times):
        ratio, beside = -s.real / abs(s), abs(s) / model.omega - round(abs(s) / model.omega)
        undamped = ratio < _UNDAMPED and (abs(beside) < _HARMONIC or _of_mains(abs(s) / (2 * np.pi)))
        if 2 * np.pi * _LOWEST < abs(s) < 2 * np.pi * _HIGHEST and -_UNDAMPED < ratio < _MOST_DAMPED and not undamped:
            own.append(_nearby(complex(s), 0j))
    return _apart(own)[:_MOST]


def _of_mains(frequency: float) -> bool:
    return min(abs(frequency / f - round(frequency / f)) for f in (50.0, 60.0)) < 0.01


def _stretch(bins: Bins) -> Bins:
    """Return as much of the middle of a record as poles need."""
    middle = 0.5 * (bins.t[0] + bins.t[-1])
    use = np.abs(bins.t - middle) < 0.5 * _STRETCH
    return replace(bins, t=bins.t[use], mean=bins.mean[use])


def _with_modes(model: JumpModel, train: Train, dv: Floats, poles: list[complex], moved: bool = False) -> JumpFit:
    """Fit the motion with modes beside it, and with their derivatives by the poles where these are to be moved.

    Sizes of what rings on from before the record come last.
    """
    t = model.bins.t
    waves = [rung(t, train.t, dv, s) for s in poles]
    columns = [_pair(each) for both in waves for each in (both if moved else both[:1])]
    columns += [_pair(np.exp(s * (t - t[0]))) for s in poles]
    u = [_widths(s, moved) for s in poles]
    u += [np.full(2, _BEFORE * float(np.median(np.abs(dv))) / abs(s)) for s in poles]
    return replace(model, extra=(np.vstack(columns), np.concatenate(u))).fit(train, draws=0)


def _tuned(model: JumpModel, train: Train, fit: JumpFit, poles: list[complex]) -> tuple[list[complex], JumpFit]:
    """Return poles that leave the least, by steps that are held back until they better the fit, and that fit.

    Sizes of the derivatives by the poles, fitted beside, give the steps.
    """
    dv = fit.jumps.dv
    best = _with_modes(model, train, dv, poles)
    for _ in range(_TURNS):
        sizes = _complex(_with_modes(model, train, dv, poles, moved=True).extra)
        for part in (1.0, 0.4, 0.15):
            moved = [_nearby(s, part * _step(sizes, k)) for k, s in enumerate(poles)]
            moved = _apart(moved)
            if len(moved) < len(poles):
                return poles, best
            dv = best.jumps.dv
            again = _with_modes(model, train, dv, moved)
            if again.residual < best.residual:
                break
        else:
            break
        done = again.residual > 0.999 * best.residual
        poles, best = moved, again
        if done:
            break
    return poles, best


def modes_heard(
    fit: JumpFit, late: float, channel: Sampled, gain: complex, known: tuple[Mode, ...] = ()
) -> tuple[Mode, ...]:
    """Return the modes that ring in an accelerometer, beside the motion that was fitted to another channel.

    Parameters
    ----------
    fit : JumpFit
        Of the displacement.
    late : float
        By how much that is later than the accelerometer [s].
    channel : Sampled
        The accelerometer.
    gain : complex
        Of it, relative to the second derivative of the displacement.
    known : tuple of Mode
        Of the displacement, which may ring here, too.
    """
    pulses = pulses_of(channel)
    stride = max(1, round(1 / 3200 / pulses.step))
    t, y = pulses.t[::stride], pulses.values[::stride]
    times, dv = fit.jumps.t - late, fit.jumps.dv
    flight = np.searchsorted(times, t, side="right") - 1
    near = np.minimum(
        np.abs(t - times[np.maximum(flight, 0)]), np.abs(times[np.minimum(flight + 1, len(times) - 1)] - t)
    )
    smooth = {2: gain.real, 4: 0.5 * gain.real * pulses.smooth**2, 3: gain.imag / fit.motion.omega}
    left = y - fit.motion.combination(t + late, smooth)
    free = near > 5 * pulses.smooth
    t, left = t[free], left[free]
    # The gain is known to a per cent or two, which of the motion is more than modes are.
    own = np.stack([fit.motion.combination(t + late, smooth), fit.motion.at(t + late, 3), np.ones(len(t))])
    left = left - np.linalg.lstsq(own.T, left, rcond=None)[0] @ own
    poles = _poles(t, left, times, dv, pulses.step * stride)
    poles = _apart([*(mode.s for mode in known), *poles])[:_MOST]
    if not poles:
        return ()
    before = float(np.std(left))

    def tried(poles: list[complex], moved: bool) -> tuple[npt.NDArray[np.complex128], float]:
        waves = [rung(t, times, dv, s) for s in poles]
        parts = [_pair(each) for both in waves for each in (both if moved else both[:1])]
        columns = np.vstack([*parts, *(_pair(np.exp(s * (t - t[0]))) for s in poles), own])
        scale = np.linalg.norm(columns, axis=1)
        linear = np.linalg.lstsq((columns / scale[:, None]).T, left, rcond=1e-10)[0] / scale
        return _complex(linear[: -len(own)]), float(np.std(left - linear @ columns))

    sizes, size = tried(poles, False)
    for _ in range(_TURNS):
        steps, _ = tried(poles, True)
        for part in (1.0, 0.4, 0.15):
            moved = _apart([_nearby(s, part * _step(steps, k)) for k, s in enumerate(poles)])
            again = tried(moved, False)
            if len(moved) == len(poles) and again[1] < size:
                break
        else:
            break
        done = again[1] > 0.9999 * size
        poles, (sizes, size) = moved, again
        if done:
            break
    if size > _BETTER * before:
        return ()
    bare = [each / np.exp(0.5 * (s * pulses.smooth) ** 2) for s, each in zip([*poles, *poles], sizes, strict=True)]
    kept = [k for k in range(len(poles)) if abs(bare[k]) > _HEARD]
    bare = [bare[k] for k in (*kept, *(len(poles) + k for k in kept))]
    return _told(channel, dv, [poles[k] for k in kept], bare, float(t[0]))


def modes_felt(channel: Sampled, omega: float, poles: Sequence[complex], times: Floats, dv: Floats) -> tuple[Mode, ...]:
    """Return the modes that ring in a channel of the base, beside harmonics of the forcing; none if they are little.

    Parameters
    ----------
    channel : Sampled
        On the base.
    omega : float
        Of the forcing [rad/s].
    poles : sequence of complex
        Of the modes, as the oscillator's channels tell them.
    times, dv : ndarray, shape (n,)
        Impacts on the channel's clock.
    """
    bins = bins_of(channel)
    t = bins.t
    turn = np.exp(1j * omega * t)
    own = np.vstack([np.ones(len(t)), *(_pair(turn**n) for n in range(1, _HARMONICS + 1))])
    waves = np.vstack(
        [*(_pair(rung(t, times, dv, s)[0]) for s in poles), *(_pair(np.exp(s * (t - t[0]))) for s in poles)]
    )

    def left(columns: Floats) -> tuple[Floats, float]:
        scale = np.linalg.norm(columns, axis=1)
        columns = columns / scale[:, None]
        linear = np.linalg.solve(columns @ columns.T, columns @ bins.mean)
        return linear / scale, float(np.std(bins.mean - linear @ columns))

    linear, size = left(np.vstack([waves, own]))
    if size > _BETTER * left(own)[1]:
        return ()
    sizes = _complex(linear[: len(waves)])
    bare = [each / bins.response(s) for s, each in zip([*poles, *poles], sizes, strict=True)]
    return _told(channel, dv, list(poles), bare, float(t[0]))


def less_modes(channel: Sampled, modes: tuple[Mode, ...], times: Floats, dv: Floats) -> Sampled:
    """Return a channel without what its modes ring after given impacts on its clock."""
    values = channel.values.copy()
    t = channel.times
    for mode in modes:
        if mode.name == channel.name:
            values -= mode.signal(t, times, dv)
    return replace(channel, values=values)


def unpredicted(bins: Bins) -> Train:
    """Return the impacts in a displacement that stand out of what its past predicts.

    Parameters
    ----------
    bins : Bins
        Of the displacement.

    Notes
    -----
    Motion in flight, hum and modes that ring are damped sines, so that a sample is a sum of those before; the weights
    are those of least squares, with samples that fit badly counting less. At an impact the displacement bends, and the
    error of prediction is that of a ramp, by which it is found.
    """
    t = np.arange(bins.t[0], bins.t[-1] + 0.5 * bins.width, bins.width)
    y = np.interp(t, bins.t, bins.mean)
    size = float(np.std(y))
    y = (y - y.mean()) / size
    if len(y) < 8 * _LAGS:
        return Train.alike(np.zeros(0), np.zeros(0), _LOOSE)
    past = np.lib.stride_tricks.sliding_window_view(y[:-1], _LAGS)[:, ::-1]
    now = y[_LAGS:]
    weight = np.ones(len(now))
    linear, left, scale = np.zeros(_LAGS), now, 1.0
    for _ in range(6):
        weighed = past * weight[:, None]
        normal = weighed.T @ past
        normal[np.diag_indices(_LAGS)] += 1e-13 * np.trace(normal) / _LAGS
        linear = np.linalg.solve(normal, weighed.T @ now)
        left = now - past @ linear
        scale = max(robust_deviation(left), 1e-300)
        weight = 1 / (1 + (left / (2 * scale)) ** 2)
    ramp = np.convolve(np.concatenate([[1.0], -linear]), np.arange(_LAGS + 1.0))[: _LAGS + 1]
    height = np.correlate(left, ramp, "valid") / float(ramp @ ramp)
    out = np.abs(height) / max(robust_deviation(height), 1e-300)
    apart, blocked, chosen = round(_APART / bins.width), np.zeros(len(out), bool), []
    for k in np.argsort(-out, kind="stable"):
        if out[k] < _STANDS_OUT:
            break
        if not blocked[k]:
            chosen.append(int(k))
            blocked[max(0, k - apart) : k + apart + 1] = True
    which = np.array(sorted(chosen), dtype=np.intp)
    return Train.alike(t[_LAGS + which], height[which] * size / bins.width, _LOOSE)


def _told(channel: Sampled, dv: Floats, poles: list[complex], sizes: list[complex], since: float) -> tuple[Mode, ...]:
    """Return modes by their poles; their sizes come first, then what rings on from before the record."""
    usual = float(np.median(np.abs(dv))) if len(dv) else 0.0
    own, before = sizes[: len(poles)], sizes[len(poles) :]
    return tuple(
        Mode(
            channel.role, channel.name, abs(s) / (2 * np.pi), -s.real / abs(s), s, complex(size), since, complex(first),
            abs(size) * usual,
        )
        for s, size, first in sorted(zip(poles, own, before, strict=True), key=lambda each: abs(each[0]))
    )  # fmt: skip


def mean_ringing(fit: JumpFit, width: float) -> tuple[float, tuple[float, ...]]:
    """Return the root mean square of what a fit leaves after the usual impact, on the mean, and its frequencies [Hz].

    Parameters
    ----------
    fit : JumpFit
        Of a displacement.
    width : float
        Of its samples [s].
    """
    times, dv = fit.jumps.t, fit.jumps.dv
    mean = _mean_response(fit.left_t, fit.left, times, dv, width)
    if not len(mean):
        return 0.0, ()
    poles = _poles(fit.left_t, fit.left, times, dv, width)
    return float(np.std(mean) * np.median(np.abs(dv))), tuple(sorted(abs(s) / (2 * np.pi) for s in poles))


def _mean_response(t: Floats, left: Floats, times: Floats, dv: Floats, step: float) -> Floats:
    """Return the mean response after impacts, by least squares; empty where they are too few or too dense."""
    nothing = np.zeros(0)
    if len(times) < 6:
        return nothing
    usual = float(np.quantile(np.diff(times), 0.25))
    n = int(min(usual, _LONGEST) / step)
    if n < 40:
        return nothing
    flight = np.searchsorted(times, t, side="right") - 1
    lag = np.rint((t - times[np.maximum(flight, 0)]) / step).astype(np.intp)
    use = (flight >= 0) & (lag < n)
    weight = dv[flight[use]]
    total = np.bincount(lag[use], weight * left[use], n)
    count = np.bincount(lag[use], weight**2, n)
    first = int(np.argmax(count > 0.5 * np.median(count)))
    mean = (total / np.maximum(count, 1e-300))[first:]
    return mean if np.all(count[first:] > 0) and len(mean) >= 40 else nothing


def _poles(t: Floats, left: Floats, times: Floats, dv: Floats, step: float) -> list[complex]:
    """Return the poles of the mean response after impacts, by the matrix pencil."""
    mean = _mean_response(t, left, times, dv, step)
    if not len(mean):
        return []
    half = len(mean) // 2
    hankel = np.lib.stride_tricks.sliding_window_view(mean, half)
    _, sizes, right = np.linalg.svd(hankel, full_matrices=False)
    order = min(int(np.count_nonzero(sizes > 0.05 * sizes[0])), 2 * _MOST, half - 1)
    span = right[:order].T
    roots = np.linalg.eigvals(np.linalg.pinv(span[:-1]) @ span[1:])
    s = np.asarray(np.log(roots[np.abs(roots) > 1e-9]) / step, dtype=np.complex128)
    s = s[s.imag > 0]
    powers: npt.NDArray[np.complex128] = np.exp(np.outer(step * np.arange(len(mean)), s))
    columns = np.hstack([powers.real, -powers.imag])
    linear = np.linalg.lstsq(columns, mean, rcond=1e-10)[0]
    parts = np.asarray(powers * (linear[: len(s)] + 1j * linear[len(s) :]))
    energy = np.sum(parts.real**2, axis=0) / float(np.sum(mean**2))
    ratio = -s.real / np.abs(s)
    kept = (np.abs(s) > 2 * np.pi * _LOWEST) & (np.abs(s) < 2 * np.pi * _HIGHEST) & (ratio < _DAMPED)
    kept &= (ratio > -0.02) & (energy > _SHARE)
    order_of = np.argsort(-energy[kept], kind="stable")
    return [_begun(complex(each)) for each in s[kept][order_of][:_MOST]]


def _begun(s: complex) -> complex:
    """Return where the search for a pole begins: what flights take up of a slow mode looks like damping."""
    ratio = min(max(-s.real / abs(s), 1e-3), _USUAL)
    return abs(s) * complex(-ratio, np.sqrt(1 - ratio**2))


def _step(sizes: npt.NDArray[np.complex128], k: int) -> complex:
    """Return the step of a pole that the size of the derivative by it asks for, beside that of its mode."""
    return complex(sizes[2 * k + 1] / sizes[2 * k]) if sizes[2 * k] else 0j


def _apart(poles: list[complex]) -> list[complex]:
    """Return poles without those beside one before."""
    kept: list[complex] = []
    for s in poles:
        if all(abs(s - other) > _BESIDE * abs(other) for other in kept):
            kept.append(s)
    return kept


def _nearby(s: complex, step: complex) -> complex:
    """Return a pole after a step that is held back, still decaying."""
    most = 0.1 * abs(s)
    s += step if abs(step) < most else step * most / abs(step)
    ratio = min(max(-s.real / abs(s), 1e-3), _MOST_DAMPED)
    return abs(s) * complex(-ratio, np.sqrt(1 - ratio**2))


def rung(t: Floats, times: Floats, dv: Floats, s: complex) -> tuple[npt.NDArray[np.complex128], ...]:
    """Return sum dv_k exp(s (t - t_k)) over the impacts before each time, and its derivative by s."""
    z, w = np.zeros(len(times) + 1, complex), np.zeros(len(times) + 1, complex)
    for k in range(len(times)):
        gap = float(times[k] - times[k - 1]) if k else 0.0
        decay = np.exp(s * gap)
        w[k + 1] = (w[k] + z[k] * gap) * decay
        z[k + 1] = z[k] * decay + dv[k]
    flight = np.searchsorted(times, t, side="right")
    since = np.where(flight > 0, t - times[np.maximum(flight - 1, 0)], 0.0)
    decay = np.exp(s * since)
    return z[flight] * decay, (w[flight] + z[flight] * since) * decay


def _pair(column: npt.NDArray[np.complex128]) -> Floats:
    return np.stack([column.real, -column.imag])


def _complex(pairs: Floats) -> npt.NDArray[np.complex128]:
    return pairs[0::2] + 1j * pairs[1::2]


def _widths(s: complex, moved: bool) -> Floats:
    """Return how large the sizes of a mode, and its steps, may be: a velocity as large as the jump itself."""
    own = 1 / abs(s)
    return np.array([own, own, 0.05, 0.05] if moved else [own, own])
