"""Positions of a ball that a camera lost now and then: cells without a number, or frames that are not there at all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.formats import RawChannel

__all__ = ["MOST_LOST", "frames_lost", "whole_frames"]

MOST_LOST = 0.5
"""Largest share of the frames in which a camera may lose the ball."""

_OFF = 0.1
"""By how much of a frame a time stamp may be off its grid: stamps of cameras are rounded."""


def whole_frames(raw: RawChannel) -> RawChannel:
    """Return a channel in which frames that were left out are without a number, where its times show such gaps.

    Examples
    --------
    >>> times = np.array([0.0, 0.1, 0.2, 0.5])
    >>> found = whole_frames(RawChannel("x", np.arange(4.0), times=times))
    >>> found.values, np.round(found.times, 1)
    (array([ 0.,  1.,  2., nan, nan,  3.]), array([0. , 0.1, 0.2, 0.3, 0.4, 0.5]))
    """
    times = raw.times
    if times is None or len(times) < 3 or not np.all(np.diff(times) > 0):
        return raw
    steps = np.diff(times)
    step = float(np.median(steps))
    # The step from stamps over as many frames as they span, so that rounding does not add up.
    count = np.rint(np.cumsum(np.concatenate([[0.0], steps])) / step)
    step = float(np.polyfit(count, times, 1)[0])
    place = np.rint((times - times[0]) / step).astype(np.intp)
    if np.abs(times - times[0] - place * step).max() > _OFF * step or place[-1] == len(times) - 1:
        return raw
    if place[-1] + 1 > len(times) / (1 - MOST_LOST) or np.any(np.diff(place) < 1):
        return raw
    values = np.full(int(place[-1]) + 1, np.nan)
    values[place] = raw.values
    return replace(raw, values=values, times=times[0] + np.arange(len(values)) * step)


def frames_lost(
    values: npt.NDArray[np.float64], where: str, full: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
    """Return positions with straight lines where the ball was lost, and flags of the frames in which it was.

    Raises
    ------
    RigError
        If it was lost in more than half of them.
    """
    lost = ~np.isfinite(values) | (np.abs(values) >= full)
    share = float(np.mean(lost))
    if share > MOST_LOST:
        raise RigError(
            f"{where}: the ball is lost in {share:.0%} of the frames, allowed are {MOST_LOST:.0%}; light it better, or "
            "leave the channel out"
        )
    place = np.arange(len(values))
    return np.interp(place, place[~lost], values[~lost]), lost
