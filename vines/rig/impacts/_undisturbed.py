"""The response of the oscillator where modes of the frame ring in its channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vines.errors import RigError
from vines.rig.fit import Train, bins_of
from vines.rig.impacts._oscillator import Response
from vines.rig.impacts._ringing import (
    Mode,
    less_modes,
    mean_ringing,
    modes_felt,
    modes_heard,
    modes_seen,
    unpredicted,
)
from vines.rig.recording import Recording

__all__ = ["still_rings", "undisturbed", "without_ringing"]

_CLEAN = 1.25
"""Most that a fit leaves, relative to the noise, before modes are looked for."""

_RINGS = 0.3
"""Least part of what a fit leaves that rings on after the usual impact, for modes to be looked for: those that explain
a fifth of its square, the least that is believed, are .44 of it."""

_LEFT = 0.5
"""Most that may ring on after the usual impact, relative to the noise."""

_FEW = 6
_ROUNDS = 4
_LOOSE, _TIGHT = 1e-4, 2e-5
"""Standard uncertainty of the times before modes are known, and once they are [s]."""


def undisturbed(
    recording: Recording, measure: Callable[[Recording, complex | None], Response]
) -> tuple[Recording, Response, tuple[Mode, ...]]:
    """Return the response with modes of the frame taken off, the recording without them, and the modes.

    Parameters
    ----------
    recording : Recording
    measure : callable
        Finds the impacts in a recording and fits the motion; the second argument is the gain of the accelerometer where
        that is known.

    Notes
    -----
    They are looked for where the fit of a displacement leaves more than its noise and that rings after impacts, or no
    impacts are found.
    """
    best = measure(recording, None)
    found: tuple[Recording, Response, tuple[Mode, ...]] = (recording, best, ())
    if best.order != 0 or (len(best.fit.jumps.t) >= _FEW and best.fit.residual < _CLEAN * best.fit.noise):
        return found
    fair = len(best.fit.jumps.t) >= _FEW and np.mean(best.fit.fair) > 0.5
    trains = [unpredicted(best.begun.bins)]
    if fair:
        size, _ = mean_ringing(best.fit, best.bins.width)
        if 0 < size < _RINGS * best.fit.residual:
            return found
        # Those that modes imitate may fit each other well enough, and ring nothing.
        trains.insert(0, Train(best.fit.jumps.t, best.fit.jumps.dv, np.full(len(best.fit.jumps.t), _LOOSE)))
    for train in trains:
        taken = _taken_off(recording, best, train, measure)
        if taken[2]:
            return taken
    return found


def _taken_off(
    recording: Recording, best: Response, train: Train, measure: Callable[[Recording, complex | None], Response]
) -> tuple[Recording, Response, tuple[Mode, ...]]:
    """Return recording, response and modes, found and taken off in turns, begun with given impacts."""
    channel, heard = recording.channels[best.channel.name], recording.role("lo_acc")
    found: tuple[Recording, Response, tuple[Mode, ...]] = (recording, best, ())
    for _ in range(_ROUNDS):
        if len(train) < _FEW:
            break
        try:
            modes = modes_seen(best.begun, channel, train, found[2])
            if not modes:
                break
            channels = dict(recording.channels)
            channels[channel.name] = less_modes(channel, modes, train.t, train.dv)
            again = measure(replace(recording, channels=channels), best.gain)
            if heard is not None and best.gain is not None:
                fit, delay = again.fit, again.delay
                if len(fit.jumps.t) < _FEW:
                    # Its own modes hide the pulses; what the displacement's past does not predict tells when they ring.
                    less = replace(best.begun.model, bins=bins_of(channels[channel.name]))
                    fit, delay = less.fit(train, draws=0), best.delay
                more = modes_heard(fit, delay, heard, best.gain, modes)
                if more:
                    times, dv = fit.jumps.t, fit.jumps.dv
                    channels[channel.name] = less_modes(channel, modes, times, dv)
                    channels[heard.name] = less_modes(heard, more, times - delay, dv)
                    modes = (*modes, *more)
                    again = measure(replace(recording, channels=channels), best.gain)
        except (RigError, np.linalg.LinAlgError):
            break
        better = len(again.fit.jumps.t) >= _FEW and (
            len(found[1].fit.jumps.t) < _FEW or again.fit.residual < 0.98 * found[1].fit.residual
        )
        if not better:
            break
        found = replace(recording, channels=channels), again, modes
        if again.fit.residual < 1.05 * again.fit.noise:
            break
        train = Train(again.fit.jumps.t, again.fit.jumps.dv, np.full(len(again.fit.jumps.t), _TIGHT))
    return found


def without_ringing(recording: Recording, response: Response, modes: tuple[Mode, ...]) -> Recording:
    """Return a recording without modes of the frame, in the base's displacement and velocity neither.

    An acceleration has pulses that set the modes moving; without their ringing these would count for the base's motion.

    Parameters
    ----------
    recording : Recording
        As it was before they were looked for.
    response : Response
        By which they are known, with its impacts.
    modes : tuple of Mode
        Of the oscillator's channels.
    """
    jumps, channels = response.fit.jumps, dict(recording.channels)
    poles = tuple(mode.s for mode in modes if mode.name == response.channel.name)
    for name, channel in recording.channels.items():
        if channel.role in ("base_disp", "base_vel"):
            late = response.late
            own = modes_felt(channel, response.fit.motion.omega, poles, jumps.t - late, jumps.dv)
        else:
            late = response.delay if channel.role == "lo_acc" else 0.0
            own = tuple(mode for mode in modes if mode.name == name)
        channels[name] = less_modes(channel, own, jumps.t - late, jumps.dv)
    return replace(recording, channels=channels)


def still_rings(response: Response) -> tuple[float, tuple[float, ...]] | None:
    """Return what rings on in a displacement after the usual impact, beside its motion; None where that is little.

    Returns
    -------
    tuple of float and tuple of float, or None
        Its root mean square relative to the noise, and its frequencies [Hz].

    Notes
    -----
    The mean of what the fit leaves after impacts. It bends what the flights say of velocities, and with them r.
    """
    fit = response.fit
    if response.order != 0 or fit.residual < _CLEAN * fit.noise:
        return None
    size, frequencies = mean_ringing(fit, response.bins.width)
    return (size / fit.noise, frequencies) if frequencies and size > _LEFT * fit.noise else None
