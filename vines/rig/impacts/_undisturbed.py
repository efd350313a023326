"""The response of the oscillator where modes of the frame ring in its channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vines.errors import RigError
from vines.rig.fit import Train
from vines.rig.impacts._oscillator import Response
from vines.rig.impacts._ringing import Mode, less_modes, modes_heard, modes_seen, unpredicted
from vines.rig.recording import Recording

__all__ = ["undisturbed"]

_CLEAN = 1.25
"""Most that a fit leaves, relative to the noise, before modes are looked for."""

_FEW = 6
_ROUNDS = 4
_LOOSE, _TIGHT = 1e-4, 2e-5
"""Standard uncertainty of the times before modes are known, and once they are [s]."""


def undisturbed(
    recording: Recording, measure: Callable[[Recording], Response]
) -> tuple[Recording, Response, tuple[Mode, ...]]:
    """Return the response with modes of the frame taken off, the recording without them, and the modes.

    Parameters
    ----------
    recording : Recording
    measure : callable
        Finds the impacts in a recording and fits the motion.

    Notes
    -----
    They are looked for where the fit of a displacement leaves more than its noise, or no impacts are found.
    """
    best = measure(recording)
    found: tuple[Recording, Response, tuple[Mode, ...]] = (recording, best, ())
    if best.order != 0 or (len(best.fit.jumps.t) >= _FEW and best.fit.residual < _CLEAN * best.fit.noise):
        return found
    channel, heard = recording.channels[best.channel.name], recording.role("lo_acc")
    fair = len(best.fit.jumps.t) >= _FEW and np.mean(best.fit.fair) > 0.5
    train = Train(best.fit.jumps.t, best.fit.jumps.dv, np.full(len(best.fit.jumps.t), _LOOSE))
    if not fair:
        train = unpredicted(best.begun.bins)
    for _ in range(_ROUNDS):
        if len(train) < _FEW:
            break
        try:
            modes = modes_seen(best.begun, channel, train, found[2])
            if not modes:
                break
            channels = dict(recording.channels)
            channels[channel.name] = less_modes(channel, modes, train.t, train.dv)
            again = measure(replace(recording, channels=channels))
            if heard is not None and len(again.fit.jumps.t) >= _FEW and again.gain is not None:
                more = modes_heard(again.fit, again.delay, heard, again.gain, modes)
                if more:
                    times, dv = again.fit.jumps.t, again.fit.jumps.dv
                    channels[channel.name] = less_modes(channel, modes, times, dv)
                    channels[heard.name] = less_modes(heard, more, times - again.delay, dv)
                    modes = (*modes, *more)
                    again = measure(replace(recording, channels=channels))
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
