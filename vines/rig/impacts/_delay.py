"""By how much one sensor is later than another that sees the same impacts."""

from __future__ import annotations

import numpy as np

from vines.rig.fit import KEEP, JumpFit
from vines.rig.impacts._search import LOOSE

__all__ = ["mean_shift", "share", "shrunk"]

_STEADY = 1.5e-6
"""Standard uncertainty, at least, of a change of the delay between two sensors [s]."""


def mean_shift(fit: JumpFit) -> tuple[float, float, float]:
    """Return the mean shift of the times, its standard uncertainty, and its change over the record in units of that."""
    weight = fit.jumps.dv**2 * (np.abs(fit.jumps.dv) > KEEP * fit.u_dv)
    if np.count_nonzero(weight) < 8:
        return 0.0, LOOSE, 0.0

    def mean(part: slice) -> tuple[float, float]:
        w, shift = weight[part], fit.shift[part]
        centre = float(np.sum(w * shift) / np.sum(w))
        return centre, float(np.sqrt(np.sum(w**2 * (shift - centre) ** 2)) / np.sum(w))

    half = len(weight) // 2
    (early, u_early), (later, u_later) = mean(slice(0, half)), mean(slice(half, None))
    return *mean(slice(None)), (later - early) / max(float(np.hypot(u_early, u_later)), _STEADY)


def shrunk(seen: tuple[float, ...], known: float) -> tuple[float, float]:
    """Return the delay between two sensors and its uncertainty: what the impacts say and the alignment, weighted."""
    weight = known**2 / (known**2 + seen[1] ** 2)
    return weight * seen[0], known * seen[1] / float(np.hypot(known, seen[1]))


def share(delay: float, u_delay: float, u_channel: float, u_sensor: float) -> tuple[float, float]:
    """Return how late the fitted channel is itself, of the delay between both, and the uncertainty of that."""
    own, other = max(u_channel, 1e-7), max(u_sensor, 1e-7)
    part = own**2 / (own**2 + other**2)
    return part * delay, float(np.hypot(part * u_delay, own * other / np.hypot(own, other)))
