"""Impacts where an acceleration is all that is known of the oscillator.

A pulse says when the ball hit and about how hard, but knocks have pulses, too, and some impacts have none. Whether the
velocity jumped, and by how much, is said by the flights on both sides: with the impacts at their times they give jumps
to some parts in a thousand without any area of a pulse.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import numpy.typing as npt

from vines.rig.fit import KEEP, LEAST, TAIL, Bins, Fitter
from vines.rig.impacts._detect import SIGMAS, U_PULSE, Detected, threshold
from vines.rig.impacts._pulses import SMOOTH, Pulses, find_pulses, pulses_of, refine_pulses
from vines.rig.impacts._split import split_flights
from vines.rig.impacts._unravel import unclear, unravel
from vines.rig.recording import Sampled

__all__ = ["detect_alone"]

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

_ROUNDS = 5

_MOVES = 6

_AT_REST = 1e-6

_U_SILENT = 5e-4
"""Standard uncertainty of the time of an impact that only the motion shows [s]: half of the grid of its search."""

_ONE = 0.012
"""Impacts that only the motion shows, nearer than this and of one sign, are one [s]: less tells them hardly apart."""

_EDGE = 0.012
"""Nothing is sought so near to the ends of the record [s]: a jump needs samples on either side."""

_CLOSE = 8e-3
"""Flights shorter than this hold few samples or none [s]."""

_MANY = 6
"""More pulses in one place are kept as they are."""

_UNLIKE = 6.0
"""A choice of pulses that is farther from what the flights see than so many standard deviations is none."""

_TWICE = 1e-5

_SAME = 1e-4
"""A pulse nearer than this to an impact that the motion shows is its pulse [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Train:
    """Impacts: times [s], velocity jumps [m/s] by pulse or motion, standard uncertainties of the times [s]."""

    t: Floats
    dv: Floats
    u: Floats

    @property
    def heard(self) -> Flags:
        return self.u <= U_PULSE

    def only(self, which: Flags | npt.NDArray[np.intp]) -> _Train:
        return _Train(self.t[which], self.dv[which], self.u[which])

    def joined(self, other: _Train) -> _Train:
        """Return both in order."""
        t = np.concatenate([self.t, other.t])
        ahead = np.argsort(t, kind="stable")
        return _Train(t[ahead], np.concatenate([self.dv, other.dv])[ahead], np.concatenate([self.u, other.u])[ahead])

    def merged(self) -> _Train:
        """Return a train in order in which silent impacts that stand for one are one, and none is beside a pulse."""
        train = self.only(np.argsort(self.t, kind="stable"))
        t, dv, u = train.t.copy(), train.dv.copy(), train.u
        keep = np.ones(len(t), bool)
        for k in range(1, len(t)):
            silent = u[k - 1] > U_PULSE, u[k] > U_PULSE
            if all(silent) and t[k] - t[k - 1] < _ONE and dv[k] * dv[k - 1] > 0:
                total = dv[k] + dv[k - 1]
                t[k], dv[k] = (dv[k] * t[k] + dv[k - 1] * t[k - 1]) / total, total
                keep[k - 1] = False
            elif any(silent) and t[k] - t[k - 1] < 2 * SMOOTH:
                keep[k if silent[1] else k - 1] = False
        return _Train(t, dv, u).only(keep)


def detect_alone(fitter: Fitter, channel: Sampled) -> tuple[Detected, Fitter]:
    """Find the impacts in an acceleration, and what of it can be fitted.

    Parameters
    ----------
    fitter : Fitter
        Of the channel.
    channel : Sampled
        The accelerometer on the oscillator.

    Returns
    -------
    Detected
    Fitter
        Without the samples beside knocks.
    """
    pulses = pulses_of(channel)
    sparse = pulses.sparse()
    t, dv = find_pulses(sparse, threshold(sparse))
    fitter = replace(fitter, bins=_trimmed(fitter.bins, t))
    train = _within(fitter.bins, _Train(t, dv, np.full(len(t), U_PULSE)))
    knocks, now = np.zeros(0), fitter
    for turn in range(_ROUNDS):
        before = train
        train, bumps = _heard(now, pulses, train)
        cleared = fitter.bins.without(bumps, TAIL * pulses.smooth)
        heard = train.only(train.heard)
        train, knocks = _judged(replace(fitter, bins=cleared), train)
        now = replace(fitter, bins=cleared.without(knocks, TAIL * pulses.smooth))
        train = _with_silent(now, train)
        train, knocks = _unravelled(now, train, heard)
        now = replace(fitter, bins=cleared.without(knocks, TAIL * pulses.smooth))
        if turn and len(train.t) == len(before.t) and np.all(np.abs(train.t - before.t) < _SAME):
            break
    size = np.abs(now.fit(train.t, train.u, train.dv, draws=0).jumps.dv)
    none = size < np.maximum(LEAST, 0.1 * np.abs(train.dv))
    now = replace(now, bins=now.bins.without(train.only(none & train.heard).t, TAIL * now.bins.smooth))
    candidates = len(train.t) + len(knocks)
    train = train.only(~none)
    return Detected(train.t, train.dv, train.u, candidates), now


def _trimmed(bins: Bins, t: Floats) -> Bins:
    """Return the samples from after the last pulse near the start of the record to before the first near its end."""
    early, late = t[t < bins.t[0] + _EDGE], t[t > bins.t[-1] - _EDGE]
    reach = TAIL * bins.smooth
    span = (bins.t > early.max(initial=-np.inf) + reach) & (bins.t < late.min(initial=np.inf) - reach)
    return replace(bins, t=bins.t[span], mean=bins.mean[span])


def _within(bins: Bins, train: _Train) -> _Train:
    """Return a train without what is twice or beside the ends of the record."""
    train = train.only(np.append(True, np.diff(train.t) > _TWICE))
    return train.only((train.t > bins.t[0] + _EDGE / 2) & (train.t < bins.t[-1] - _EDGE / 2))


def _heard(fitter: Fitter, pulses: Pulses, train: _Train) -> tuple[_Train, Floats]:
    """Refine the pulses, now that the motion is known, and add those too small to be seen before.

    What else stands out, such as the end of a knock's ringing, is too small for an impact; its times are returned, too.
    """
    motion = fitter.fit(train.t, train.u, train.dv, draws=0).motion
    left = pulses.less(motion.combination(pulses.t, {2: 1.0, 4: 0.5 * pulses.smooth**2}))
    heard, silent = train.only(train.heard), train.only(~train.heard)
    # In a flight with an impact that is missing the motion is off, slowly.
    t, dv = refine_pulses(left.sparse(), heard.t, heard.dv)
    left = _with_ringing(left, t, dv)
    sparse = left.sparse()
    t, dv = find_pulses(sparse, threshold(sparse), times=t, dv=dv)
    t, dv = refine_pulses(left, t, dv)
    # A pulse beside an impact that only the motion shows is its own, or that of a knock that hides it.
    apart = np.abs(t[:, None] - silent.t[None, :])
    silent = silent.only(np.min(apart, axis=0, initial=np.inf) > _SAME)
    alone = np.min(np.abs(t[:, None] - silent.t[None, :]), axis=1, initial=np.inf) > 2 * pulses.smooth
    alone &= np.abs(dv) > LEAST
    heard = _Train(t[alone], dv[alone], np.full(int(alone.sum()), U_PULSE))
    rest = sparse.values - sparse.shape(t, dv)
    return _within(fitter.bins, heard.joined(silent)), pulses.t[np.abs(rest) > 2 * SIGMAS * sparse.noise]


def _with_ringing(left: Pulses, t: Floats, dv: Floats) -> Pulses:
    """Return the pulses with what ringing does to their shape, the same for all, by least squares."""
    plain, wide = replace(left, ring=0.0), replace(left, ring=left.smooth**2)
    one = plain.shape(t, dv)
    two = wide.shape(t, dv) - one
    near = np.abs(one) > 0
    columns = np.stack([one[near], two[near]])
    size = np.linalg.solve(columns @ columns.T, columns @ left.values[near])
    return replace(left, ring=float(size[1] / size[0]) * left.smooth**2)


def _judged(fitter: Fitter, train: _Train) -> tuple[_Train, Floats]:
    """Return the impacts, and the times of pulses that are not those of impacts."""
    train = _within(fitter.bins, train)
    fit = fitter.fit(train.t, train.u, train.dv)
    size, u_dv = np.abs(fit.jumps.dv), fit.u_dv
    jumped = (size > KEEP * u_dv) & (size > LEAST)
    own = jumped & (np.abs(fit.jumps.dv - train.dv) < 0.3 * size + KEEP * u_dv)
    # Beside a flight with an impact that is missing what was heard counts, unless there is hardly a jump.
    unknown = train.heard & ~(fit.fair[:-1] & fit.fair[1:]) & (size > 0.1 * np.abs(train.dv))
    keep = own | unknown
    instead = []
    for few in np.split(np.arange(len(size)), np.flatnonzero(np.diff(train.t) > _CLOSE) + 1):
        if keep[few].all():
            continue
        heard = few[train.heard[few]]
        keep[few] = False
        chosen = None
        if len(heard) <= _MANY:
            total = float(fit.jumps.dv[few].sum())
            moment = float(fit.jumps.dv[few] @ (train.t[few] - train.t[few[0]]))
            u = KEEP * float(np.hypot.reduce(u_dv[few]))
            chosen = _explains(train.t[heard] - train.t[few[0]], train.dv[heard], total, moment, u)
            if chosen is None:
                instead.append((train.t[few[0]] + moment / total, total, _U_SILENT))
                continue
        keep[heard if chosen is None else heard[chosen]] = True
    t, dv, u_t = np.array(instead, dtype=np.float64).reshape(-1, 3).T
    silent = _Train(t, dv, u_t)
    return train.only(keep).joined(silent), train.t[~keep & train.heard]


def _explains(t: Floats, area: Floats, total: float, moment: float, u: float) -> npt.NDArray[np.intp] | None:
    """Return which of some pulses close together are impacts; None if rather one impact that has none of the pulses.

    The flights around see the sum of the jumps and its first moment; between pulses so close there are no samples.
    """
    large = float(np.max(np.abs(area), initial=abs(total)))
    near = len(t) > 1 and float(np.min(np.diff(t))) < 5 * SMOOTH
    u_total, u_moment = np.hypot((0.1 if near else 0.05) * large, u), np.hypot(large * _SAME, u * _CLOSE)
    best, chosen = _UNLIKE, None
    for n in range(len(t) + 1):
        for some in combinations(range(len(t)), n):
            one = np.array(some, np.intp)
            apart = np.hypot((area[one].sum() - total) / u_total, (area[one] @ t[one] - moment) / u_moment)
            if apart + n < best:
                best, chosen = float(apart + n), one
    return chosen if chosen is not None or abs(total) > max(LEAST, u) else np.zeros(0, np.intp)


def _unravelled(fitter: Fitter, train: _Train, heard: _Train) -> tuple[_Train, Floats]:
    """Decide by trying what is unclear yet; return all impacts, and the times of pulses that are none."""
    train = _within(fitter.bins, train)
    fit = fitter.fit(train.t, train.u, train.dv, draws=0)
    edges = np.append(fit.motion.starts, fit.motion.stop)
    for stretch in unclear(fit):
        low, high = edges[stretch[0]], edges[min(stretch[1] + 3, len(edges) - 1)]
        few = heard.only((heard.t > low + _TWICE) & (heard.t < high - _TWICE))
        found = unravel(fitter.bins, fit, stretch, few.t, few.dv, fitter.order)
        if found is not None:
            chosen, silent = few.only(found[0]), found[1]
            new = _Train(silent, np.full(len(silent), np.median(np.abs(train.dv))), np.full(len(silent), _U_SILENT))
            outside = train.only((train.t < low + _TWICE) | (train.t > high - _TWICE))
            train = outside.joined(chosen).joined(new)
    train = _settled(fitter, train)
    apart = np.abs(heard.t[:, None] - train.t[None, :])
    return train, heard.t[np.min(apart, axis=1, initial=np.inf) > _TWICE]


def _with_silent(fitter: Fitter, train: _Train) -> _Train:
    """Add impacts that only the motion shows."""
    train = _within(fitter.bins, train)
    fit = fitter.fit(train.t, train.u, train.dv, draws=0)
    found, jumps = split_flights(fitter.bins, fit, fitter.order)
    return _settled(fitter, train.joined(_Train(found, jumps, np.full(len(found), _U_SILENT))))


def _settled(fitter: Fitter, train: _Train) -> _Train:
    """Move impacts that only the motion shows until they come to rest."""
    train = _within(fitter.bins, train.merged())
    for _ in range(_MOVES):
        silent = ~train.heard
        if not silent.any():
            break
        fit = fitter.fit(train.t, train.u, train.dv, draws=0)
        moved = np.where(silent, train.t + fit.shift, train.t)
        train = _within(fitter.bins, _Train(moved, np.where(silent, fit.jumps.dv, train.dv), train.u).merged())
        if np.max(np.abs(fit.shift[silent])) < _AT_REST:
            break
    return _within(fitter.bins, train)
