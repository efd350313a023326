"""A long run in slices of time, between which Python hears Ctrl-C.

A kernel knows no signals, and may run for a minute. A run does not depend on how it was cut into calls, so it is
cut where Python can look up.
"""

from __future__ import annotations

from collections.abc import Iterator

__all__ = ["SLICE", "slices"]

SLICE = 1000.0
"""Forcing periods of a slice: some milliseconds, and tenths of a second where the ball chatters all the time."""


def slices(start: float, stop: float, period: float) -> Iterator[float]:
    """Yield the times up to which a run goes, one after the other; the last is `stop` itself.

    Parameters
    ----------
    start, stop : float
        Times.
    period : float
        Forcing period.

    Examples
    --------
    >>> list(slices(0.0, 25.0, 0.01)), list(slices(0.0, 5.0, 0.01))
    ([10.0, 20.0, 25.0], [5.0])
    """
    at = 1
    while (end := start + at * SLICE * period) < stop:
        yield end
        at += 1
    yield stop
