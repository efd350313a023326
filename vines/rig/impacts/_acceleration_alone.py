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

from vines.rig.fit import KEEP, LEAST, TAIL, Bins, Fitter, Train
from vines.rig.impacts._pulses import SMOOTH, Pulses, find_pulses, pulses_of, refine_pulses
from vines.rig.impacts._search import SIGMAS, Policy, Search, inside, search, threshold, with_silent
from vines.rig.impacts._split import U_SILENT
from vines.rig.impacts._unravel import unclear, unravel
from vines.rig.recording import Sampled

__all__ = ["search_acceleration"]

Floats = npt.NDArray[np.float64]

_MOVES = 6

_AT_REST = 1e-6

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


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Alone(Search):
    """State of a search in an acceleration; its fitter leaves out the samples beside what is no impact.

    Attributes
    ----------
    pulses : Pulses
        Of the acceleration.
    whole, clear : Bins
        All samples that can be fitted, and those of them that are not beside bumps too small for an impact.
    heard : Train
        Pulses that were looked at in this turn.
    knocks : ndarray
        Times of pulses that are none of impacts [s].
    """

    pulses: Pulses
    whole: Bins
    clear: Bins
    heard: Train
    knocks: Floats


def search_acceleration(fitter: Fitter, channel: Sampled) -> Search:
    """Find the impacts in an acceleration, and what of it can be fitted.

    Parameters
    ----------
    fitter : Fitter
        Of the channel.
    channel : Sampled
        The accelerometer on the oscillator.
    """
    pulses = pulses_of(channel)
    sparse = pulses.sparse()
    train = find_pulses(sparse, threshold(sparse))
    bins = _trimmed(fitter.bins, train.t)
    train = _within(bins, train)
    begun = _Alone(fitter.on(bins), train, pulses=pulses, whole=bins, clear=bins, heard=train, knocks=np.zeros(0))
    return search(_ACCELEROMETER_ALONE, begun)


def _trimmed(bins: Bins, t: Floats) -> Bins:
    """Return the samples from after the last pulse near the start of the record to before the first near its end."""
    early, late = t[t < bins.t[0] + _EDGE], t[t > bins.t[-1] - _EDGE]
    reach = TAIL * bins.smooth
    span = (bins.t > early.max(initial=-np.inf) + reach) & (bins.t < late.min(initial=np.inf) - reach)
    return replace(bins, t=bins.t[span], mean=bins.mean[span])


def _within(bins: Bins, train: Train) -> Train:
    return inside(bins, train, _EDGE / 2, _TWICE)


def _without_knocks(found: _Alone, train: Train, knocks: Floats) -> _Alone:
    fitter = found.fitter.on(found.clear.without(knocks, TAIL * found.pulses.smooth))
    return replace(found, train=train, knocks=knocks, fitter=fitter)


def _heard(found: _Alone) -> _Alone:
    """Refine the pulses, now that the motion is known, and add those too small to be seen before.

    What else stands out, such as the end of a knock's ringing, is too small for an impact: its samples are left out.
    """
    pulses, train = found.pulses, found.train
    motion = found.fitter.fit(train, 0).motion
    left = pulses.less(motion.combination(pulses.t, {2: 1.0, 4: 0.5 * pulses.smooth**2}))
    silent = train.without(train.heard)
    # In a flight with an impact that is missing the motion is off, slowly.
    heard = refine_pulses(left.sparse(), train.only(train.heard))
    left = _with_ringing(left, heard)
    sparse = left.sparse()
    heard = refine_pulses(left, find_pulses(sparse, threshold(sparse), heard))
    rest = sparse.values - sparse.shape(heard.t, heard.dv)
    bumps = pulses.t[np.abs(rest) > 2 * SIGMAS * sparse.noise]
    # A pulse beside an impact that only the motion shows is its own, or that of a knock that hides it.
    silent = silent.only(heard.distance(silent.t) > _SAME)
    heard = heard.only((silent.distance(heard.t) > 2 * pulses.smooth) & (np.abs(heard.dv) > LEAST))
    train = _within(found.fitter.bins, heard.merged(silent))
    clear = found.whole.without(bumps, TAIL * pulses.smooth)
    return replace(found, train=train, heard=train.only(train.heard), clear=clear, fitter=found.fitter.on(clear))


def _with_ringing(left: Pulses, train: Train) -> Pulses:
    """Return the pulses with what ringing does to their shape, the same for all, by least squares."""
    plain, wide = replace(left, ring=0.0), replace(left, ring=left.smooth**2)
    one = plain.shape(train.t, train.dv)
    two = wide.shape(train.t, train.dv) - one
    near = np.abs(one) > 0
    columns = np.stack([one[near], two[near]])
    size = np.linalg.solve(columns @ columns.T, columns @ left.values[near])
    return replace(left, ring=float(size[1] / size[0]) * left.smooth**2)


def _judged(found: _Alone) -> _Alone:
    """Keep the impacts; pulses that are not those of impacts are knocks."""
    fitter = found.fitter
    train = _within(fitter.bins, found.train)
    fit = fitter.fit(train)
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
                instead.append((train.t[few[0]] + moment / total, total))
                continue
        keep[heard if chosen is None else heard[chosen]] = True
    t, dv = np.array(instead, dtype=np.float64).reshape(-1, 2).T
    silent = Train.alike(t, dv, U_SILENT)
    return _without_knocks(found, train.only(keep).merged(silent), train.t[~keep & train.heard])


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


def _silent(found: _Alone) -> _Alone:
    """Add impacts that only the motion shows."""
    train = with_silent(found.fitter, _within(found.fitter.bins, found.train))
    return replace(found, train=_settled(found.fitter, train))


def _unravelled(found: _Alone) -> _Alone:
    """Decide by trying what is unclear yet."""
    fitter, heard = found.fitter, found.heard
    train = _within(fitter.bins, found.train)
    fit = fitter.fit(train, 0)
    edges = np.append(fit.motion.starts, fit.motion.stop)
    for stretch in unclear(fit):
        low, high = edges[stretch[0]] + _TWICE, edges[min(stretch[1] + 3, len(edges) - 1)] - _TWICE
        few = heard.between(low, high)
        found_here = unravel(fitter.bins, fit, stretch, few, fitter.model.order)
        if found_here is not None:
            chosen, silent = few.only(found_here[0]), found_here[1]
            new = Train.alike(silent, np.full(len(silent), np.median(np.abs(train.dv))), U_SILENT)
            train = train.only((train.t < low) | (train.t > high)).merged(chosen).merged(new)
    train = _settled(fitter, train)
    return _without_knocks(found, train, heard.t[train.distance(heard.t) > _TWICE])


def _settled(fitter: Fitter, train: Train) -> Train:
    """Move impacts that only the motion shows until they come to rest."""
    train = _within(fitter.bins, _united(train))
    for _ in range(_MOVES):
        silent = ~train.heard
        if not silent.any():
            break
        fit = fitter.fit(train, 0)
        moved = np.where(silent, train.t + fit.shift, train.t)
        train = _within(fitter.bins, _united(Train(moved, np.where(silent, fit.jumps.dv, train.dv), train.u)))
        if np.max(np.abs(fit.shift[silent])) < _AT_REST:
            break
    return _within(fitter.bins, train)


def _united(train: Train) -> Train:
    """Return a train in which silent impacts that stand for one are one, and none is beside a pulse."""
    t, dv, heard = train.t.copy(), train.dv.copy(), train.heard
    keep = np.ones(len(t), bool)
    for k in range(1, len(t)):
        if not (heard[k - 1] or heard[k]) and t[k] - t[k - 1] < _ONE and dv[k] * dv[k - 1] > 0:
            total = dv[k] + dv[k - 1]
            t[k], dv[k] = (dv[k] * t[k] + dv[k - 1] * t[k - 1]) / total, total
            keep[k - 1] = False
        elif not (heard[k - 1] and heard[k]) and t[k] - t[k - 1] < 2 * SMOOTH:
            keep[k - 1 if heard[k] else k] = False
    return Train(t, dv, train.u).only(keep)


def _with_jumps(found: _Alone) -> _Alone:
    """Let go of the impacts without a jump, and leave out the samples beside their pulses."""
    train, bins = found.train, found.fitter.bins
    size = np.abs(found.fitter.fit(train, 0).jumps.dv)
    none = size < np.maximum(LEAST, 0.1 * np.abs(train.dv))
    fitter = found.fitter.on(bins.without(train.t[none & train.heard], TAIL * bins.smooth))
    return replace(found, train=train.without(none), candidates=len(train) + len(found.knocks), fitter=fitter)


def _same(before: _Alone, after: _Alone) -> bool:
    one, other = before.train, after.train
    return len(one) == len(other) and bool(np.all(np.abs(other.t - one.t) < _SAME))


_ACCELEROMETER_ALONE = Policy(
    first=(),
    turn=(_heard, _judged, _silent, _unravelled),
    last=(_with_jumps,),
    turns=(2, 5),
    at_rest=_same,
)
