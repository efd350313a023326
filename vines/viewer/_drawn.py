"""What of a log is drawn: all of it, or of a long one what a screen can show."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from vines.logs import Log
from vines.viewer._thin import chosen_rows, peaks

__all__ = ["Drawn", "drawn", "thinning"]

_CURVES = ("x1", "v1", "x2", "w", "w_dot", "stuck")
"""Columns of states whose peaks stay; what else is drawn has its peaks where these have theirs, or only grows."""
MOST_STATES = 60_000
"""States of a run up to which all are drawn; of a longer one about as many stay."""
_MOST_SAMPLES = 2_000_000
"""Samples of all sensors of a rig and of its base that are drawn together."""


@dataclass(frozen=True)
class Drawn:
    """A log as it is drawn.

    Attributes
    ----------
    log : Log
        With the states, the balls and the samples that are drawn; its impacts are all there.
    parts : tuple of slice
        Of the states, those between which none is left out.
    """

    log: Log
    parts: tuple[slice, ...]


def drawn(log: Log, *, at: float | None = None, full: bool = False) -> Drawn:
    """Return what is drawn of a log.

    Parameters
    ----------
    log : Log
        A run, an orbit or a rig.
    at : float, optional
        Time around which all states of a long run stay; the middle if left out.
    full : bool
        Whether all is drawn, however long it is.
    """
    if full or not thinning(log):
        return Drawn(log, (slice(0, log.states.num_rows),))
    parts: tuple[slice, ...] = (slice(0, log.states.num_rows),)
    changes: dict[str, object] = {}
    if log.states.num_rows > MOST_STATES:
        tables = [log.states, *log.balls.values(), *([log.nes] if log.nes.num_rows else [])]
        curves = [_column(table, name) for table in tables for name in _CURVES if name in table.column_names]
        rows = chosen_rows(_column(log.states, "t"), curves, at, most=MOST_STATES)
        parts = tuple(rows.parts())
        balls = {number: table.take(rows.chosen) for number, table in log.balls.items()}
        changes |= {"states": log.states.take(rows.chosen), "balls": balls}
        if log.nes.num_rows:
            changes["nes"] = log.nes.take(rows.chosen)
    if _samples(log) > _MOST_SAMPLES:
        share = _MOST_SAMPLES / _samples(log)
        sensors = {name: _thinned(table, ("value", "valid"), share) for name, table in log.sensors.items()}
        base = _thinned(log.base, ("displacement", "velocity", "acceleration"), share)
        changes |= {"sensors": sensors, "base": base}
    return Drawn(replace(log, **changes), parts)


def thinning(log: Log) -> str:
    """Return in words what is left out of the picture of a long log, or nothing."""
    said: list[str] = []
    if (count := log.states.num_rows) > MOST_STATES:
        said.append(
            f"of {count:,} states about {MOST_STATES:,}: all at the start, at the end and around one time (--at)"
        )
    if (count := _samples(log)) > _MOST_SAMPLES:
        said.append(f"of {count:,} samples about {_MOST_SAMPLES:,}")
    return f"drawn are {'; '.join(said)}, elsewhere the peaks of each curve; every impact is there" if said else ""


def _samples(log: Log) -> int:
    return log.base.num_rows + sum(samples.num_rows for samples in log.sensors.values())


def _thinned(table: pa.Table, curves: tuple[str, ...], share: float) -> pa.Table:
    """Return the rows of a table at which its curves have their peaks, with the first and the last."""
    if not table.num_rows:
        return table
    rows = peaks([_column(table, name) for name in curves], int(share * table.num_rows))
    return table.take(np.union1d(rows, [0, table.num_rows - 1]))


def _column(table: pa.Table, name: str) -> np.ndarray:
    return table[name].to_numpy()
