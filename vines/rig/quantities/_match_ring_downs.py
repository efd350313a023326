"""Which ring-downs belong to a run: those that its ``run.json`` names, else its neighbours in time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vines.errors import RigError, nearest
from vines.rig.recording import RunInfo

__all__ = ["match_ring_downs"]


def match_ring_downs(run: RunInfo, known: Sequence[RunInfo]) -> tuple[str, ...]:
    """Return the names of the ring-downs that give omega0 and lam of a run.

    Parameters
    ----------
    run : RunInfo
        With the ball.
    known : sequence of RunInfo
        All runs at hand; those of protocol ``ringdown`` count.

    Returns
    -------
    tuple of str
        The ring-downs that ``run.json`` names; if it names none, the last one that began before the run and the first
        one after it, or the one of them that there is.

    Raises
    ------
    RigError
        If one that it names is not at hand, or there is none at all.

    Examples
    --------
    >>> from vines.rig import Uncertain
    >>> one = Uncertain(1.0, 0.0)
    >>> def info(name, hour, protocol):
    ...     began = f"2026-01-05T{hour}:00:00Z"
    ...     return RunInfo(name, began, protocol, None, None, 0.0, one, one, one, True, (20.0, 20.0))
    >>> free = [info("a", "08", "ringdown"), info("b", "09", "ringdown"), info("c", "12", "ringdown")]
    >>> match_ring_downs(info("run", "10", "dwell"), free)
    ('b', 'c')
    """
    free = {one.run_id: one for one in known if one.protocol == "ringdown"}
    for name in run.ringdown:
        if name not in free:
            hint = nearest(name, free) if free else "there is none"
            raise RigError(f"run {run.run_id!r} names the ring-down {name!r}, which is not at hand: {hint}")
    if run.ringdown:
        return run.ringdown
    if not free:
        raise RigError(
            f"run {run.run_id!r} has no ring-down: omega0 must be known to .01 %; record one before and after the "
            "sweep, or name a folder of one with --ringdown"
        )
    began = sorted((_time(one), name) for name, one in free.items())
    here = _time(run)
    before = [name for at, name in began if at <= here][-1:]
    after = [name for at, name in began if at > here][:1]
    return (*before, *after)


def _time(run: RunInfo) -> np.datetime64:
    """Return when a run began; UTC, as ``run.json`` says."""
    try:
        return np.datetime64(run.start_utc.removesuffix("Z"), "ms")
    except ValueError:
        raise RigError(f"run {run.run_id!r}: start_utc is {run.start_utc!r}, which is not ISO 8601 in UTC") from None
