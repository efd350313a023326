"""The oscillator's motion and its velocity jumps from its channels: detect, fit, add what is missed, prune, refine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.fit import KEEP, U_PULSE, Bins, Fitter, Forced, JumpFit, JumpModel, Push, Train, bins_of, straight
from vines.rig.impacts._acceleration_alone import search_acceleration
from vines.rig.impacts._delay import share
from vines.rig.impacts._pulses import SMOOTH, pulses_of
from vines.rig.impacts._search import Search, inside
from vines.rig.impacts._with_displacement import search_displacement
from vines.rig.recording import Recording, Sampled

__all__ = ["Response", "measure_response"]

Floats = npt.NDArray[np.float64]

_EVERY = 6.25e-4
"""Distance of the values of a smoothed acceleration that the fit uses [s]: about the width of the smoothing."""

_TWIN = 8e-3
"""Impacts nearer than this, with opposite jumps, may be one and a false one beside it [s]."""

_AT_WALL = 0.2
"""How far from the wall, relative to b, a ball may seem to be at a soft impact."""

_DENIED = 0.2
"""Largest part of the impacts that the motion may deny."""

_ROUNDS = 5

_SEEN = 4e-3
"""Impacts of the ball's own sensor nearer than this to one of the oscillator's are that one [s]."""

_MOVES = 3

_AT_REST = 1e-5


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
    pushed : Push or None
        What the ball's friction was taken to add.
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
    begun : Fitter
        Of the channel before anything was found out about it.
    delay : float
        By how much `channel` is later than the accelerometer [s].
    lent : ndarray of bool, shape (K,)
        Impacts that the ball's own sensor showed and those of the oscillator did not.
    """

    channel: Sampled
    order: int
    bins: Bins
    fit: JumpFit
    pushed: Push | None
    pulse: Floats
    gain: complex | None
    late: float
    u_late: float
    drift: float
    candidates: int
    pruned: int
    begun: Fitter
    delay: float
    lent: npt.NDArray[np.bool_]


def measure_response(
    recording: Recording,
    s: complex,
    omega: float,
    forced: Forced | None = None,
    *,
    driven: complex,
    friction: float = 0.0,
    u_natural: tuple[float, float] = (1e-5, 1e-3),
    impacts: tuple[Floats, Floats] | None = None,
    seen: Train | None = None,
    gain: complex | None = None,
    seed: int = 0,
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
        As of `JumpModel`.
    friction : float
        Acceleration of the oscillator by the ball's friction, mu times the ball's deceleration [m/s^2].
    u_natural : tuple of float
        Relative standard uncertainties of omega0 and lam.
    driven : complex
        First harmonic of the forced response that the base asks for [m].
    impacts : tuple of ndarray, optional
        Times [s] on the clock of the oscillator's channel and velocity jumps [m/s], if they are known otherwise.
    seen : Train, optional
        Impacts that a sensor of the ball showed: those among them that the oscillator's do not show are taken over.
    gain : complex, optional
        Of the accelerometer, relative to the second derivative of the displacement, where that is known: what rings
        after impacts, and the pulses that begin it, are nearly nothing at the forcing frequency, but each alone is not.
    seed : int
        Of the draws for uncertainties.

    Raises
    ------
    RigError
        If no channel measures the oscillator.
    """
    displacement, accelerometer = recording.role("lo_disp"), recording.role("lo_acc")
    channel = displacement or accelerometer
    if channel is None:
        alone = "; a velocity alone gives no impacts" if recording.role("lo_vel") else ""
        raise RigError(f"run {recording.run.run_id!r} has no channel on the oscillator (lo_disp or lo_acc){alone}")
    order = 0 if displacement is not None else 2
    bins = bins_of(channel) if order == 0 else _quiet(channel)
    model = JumpModel(bins, s, omega, order, forced, seed=seed)
    fitter = begun = Fitter(model, driven, recording.run.b.value, friction, u_natural)
    sensor = accelerometer if accelerometer is not None else channel
    if impacts is not None:
        train = inside(bins, Train.alike(*impacts, U_PULSE))
        found = Search(fitter, train, candidates=len(train))
    elif order == 0:
        found = search_displacement(fitter, channel, accelerometer, gain)
    else:
        found = search_acceleration(fitter, channel)
        fitter = found.fitter
    train, delay = found.train.later(found.delay), found.delay
    lent = np.zeros(len(train), bool)
    if seen is not None and impacts is None:
        train, lent = _with_seen(fitter, train, seen)
    fit, _ = fitter.fit_rubbed(train)
    for _ in range(_ROUNDS if impacts is None else 0):
        keep = _credible(fit, train, fitter, lent)
        if keep.all():
            break
        train, lent = train.only(keep), lent[keep]
        fit, _ = fitter.fit_rubbed(train)
    pushed = fitter.rubbed(fit)
    if pushed is not None and order == 0:
        fitter = straight(fitter, train, pushed)
    fit = fitter.fit(train, 32, pushed)
    late, u_late = (
        share(delay, found.u_delay, channel.u_time, sensor.u_time) if found.gain is not None else (0.0, channel.u_time)
    )
    return Response(
        channel, order, fitter.bins, fit, pushed, train.dv, found.gain, late, u_late, found.drift, found.candidates,
        found.candidates - len(train) + int(np.count_nonzero(lent)), begun, delay, lent,
    )  # fmt: skip


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


def _with_seen(fitter: Fitter, train: Train, seen: Train) -> tuple[Train, npt.NDArray[np.bool_]]:
    """Add impacts that only the ball's own sensor shows, moved to where the oscillator bends; say which they are."""
    more = inside(fitter.bins, seen.only(train.distance(seen.t) > _SEEN))
    lent = np.zeros(len(train), bool)
    if not len(more):
        return train, lent
    order = np.argsort(np.concatenate([train.t, more.t]), kind="stable")
    lent = np.concatenate([lent, np.ones(len(more), bool)])[order]
    train = train.merged(more)
    for _ in range(_MOVES):
        shift = np.where(lent, np.clip(fitter.fit(train, 0).shift, -_SEEN / 2, _SEEN / 2), 0.0)
        moved = train.t + shift
        if np.any(np.diff(moved) <= 0):
            break
        train = Train(moved, train.dv, train.u)
        if np.abs(shift).max() < _AT_REST:
            break
    return train, lent


def _credible(fit: JumpFit, train: Train, fitter: Fitter, lent: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Say which impacts to keep; of several near each other, the least credible one goes first.

    An impact whose jump the motion shows stays, but of two in one place, with jumps that cancel, not the one that was
    heard less well. One that was heard only stays if the motion does not deny its pulse, if it is not what a far
    larger one beside it left, and if the ball was at the wall then: it changes the ball's flight hardly. Beside a
    flight that is not one nothing can be said; and where many are denied, it is the fit that is wrong. One that the
    ball's own sensor `lent` is no noise: it stays as long as its jump is that of the ball's turn.
    """
    dv, t, pulse = fit.jumps.dv, train.t, train.dv
    shown = np.abs(dv) > KEEP * fit.u_dv
    denied = np.abs(dv - pulse) > KEEP * fit.u_dv
    blind = ~(fit.fair[:-1] & fit.fair[1:])
    soft = ~denied & ~_beside(t, dv, pulse) & (_off_the_wall(fit, fitter.b) < _AT_WALL * fitter.b)
    # An acceleration has weighed pulses and flights against each other before.
    keep = shown | (train.heard & (blind | soft | (fitter.model.order == 2)))
    keep |= lent & (np.abs(dv - pulse) < KEEP * fit.u_dv + 0.2 * np.abs(pulse))
    if not len(keep) or np.mean(~keep) > _DENIED:
        return np.ones(len(t), bool)
    # In a cluster a false impact spoils the jumps of its neighbours.
    worth = np.abs(dv) / fit.u_dv
    for k in np.flatnonzero(~keep):
        around = np.abs(t - t[k]) < _TWIN
        keep[k] = np.min(worth[around & ~keep], initial=np.inf) < worth[k]
    near = np.flatnonzero((np.diff(t) < _TWIN) & (dv[:-1] * dv[1:] < 0))
    worse = np.where(train.u[near] > train.u[near + 1], near, near + 1)
    keep[worse[~train.heard[worse]]] = False
    return keep


def _beside(t: Floats, dv: Floats, pulse: Floats) -> npt.NDArray[np.bool_]:
    """Say which pulses are small ones beside a large one: more likely what is left of that."""
    small = np.zeros(len(t), bool)
    for k, other in ((slice(1, None), slice(None, -1)), (slice(None, -1), slice(1, None))):
        small[k] |= (np.diff(t) < 4 * SMOOTH) & (np.abs(pulse[k]) < 0.2 * np.abs(dv[other]))
    return small


def _off_the_wall(fit: JumpFit, b: float) -> Floats:
    """Return how far from the wall a ball would be that flies straight from the impact before to the one after [m]."""
    jumps, t = fit.jumps, fit.motion.starts[1:]
    x2 = jumps.x + np.sign(jumps.dv) * b
    off = np.zeros(len(t))
    if len(t) > 2:
        share = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
        off[1:-1] = np.abs(x2[1:-1] - x2[:-2] - share * (x2[2:] - x2[:-2]))
    return off
