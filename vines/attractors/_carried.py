"""Many runs of one system carried on from states at one phase of the forcing, whatever the system."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import ensemble
from vines.dynamics.kernels import constants, open_window, room_of, run_window, window_totals
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import totals as entry
from vines.dynamics.runs import EVENTS_PER_PERIOD, each_thread, measures_of, threads_allowed
from vines.kernels import entry_njit
from vines.model import Params

__all__ = ["carried", "names_of", "part_alike", "sort_alike"]

Floats = npt.NDArray[np.float64]

BLOCK = 1024
"""Most runs in one call of the kernel; a thread takes one block after the other."""


def names_of(p: Any) -> tuple[str, ...]:
    """Return the names of the coordinates of a state, the columns of arrays of states."""
    return tuple(each.name for each in p.system.state)


def carried(
    p: Any, states: Floats, phase: float | Floats, periods: float, *, measured: bool = False
) -> tuple[Floats, npt.NDArray[np.void] | None]:
    """Let runs go on for a while.

    Parameters
    ----------
    p : Params, or the parameters of another system
    states : ndarray, shape (n, d)
        Coordinates by the order of the declaration.
    phase : float or ndarray, shape (n,)
        Phase of the forcing.
    periods : float
        Forcing periods.
    measured : bool
        Whether to take measures.

    Returns
    -------
    states : ndarray, shape (n, d)
        Where the runs came.
    measures : structured ndarray, or None
        As `Ensemble.measures`, of all balls together.
    """
    names = names_of(p)
    if isinstance(p, Params):
        starts = dict(zip(names, states.T, strict=True)) | {"phase": phase}
        run = ensemble(p, starts, periods=periods, record="measures" if measured else "final")
        return np.stack([run.final[name] for name in names], axis=1), run.measures if measured else None
    room, layout, c = room_of(p), room_of(p).layout(p), constants(p)
    n, stop = len(states), periods * p.period
    begun = np.zeros((n, layout.state))
    phases = np.broadcast_to(phase, n).tolist()
    for state, values, angle in zip(begun, states.tolist(), phases, strict=True):
        room.begin(c, state, *room.enter(p, dict(zip(names, values, strict=True)), angle), angle, 0.0)
        # As settled runs are.
        room.strike_in_turn(state)
    finals = np.empty((n, layout.width))
    sums = np.zeros((n if measured else 0, entry.TOTALS))

    def work(block: slice) -> None:
        rows = np.empty((layout.rows, layout.width))
        # Constants of its own: those of some systems hold the room that a kernel works in.
        own = constants(p)
        _carry_block(own, begun[block], stop, EVENTS_PER_PERIOD, rows, finals[block], sums[block])

    cores = threads_allowed()
    size = min(BLOCK, max(16, -(-n // (4 * cores))))
    each_thread(work, [slice(k, min(k + size, n)) for k in range(0, n, size)], cores)
    at = finals[:, [col.X1, col.A_V1, col.X2, col.A_V2]].tolist()
    ends = finals[:, col.PHASE].tolist()
    more = finals[:, col.ROW :].tolist()
    there = [list(room.leave(p, *each).values()) for each in zip(at, ends, more, strict=True)]
    # Totals of several balls have their masses in them, and the unit of energies of the pair is its ball's mass.
    measures = measures_of(np.ones(n), sums) if measured else None
    return np.array(there).reshape(n, len(names)), measures


@entry_njit
def _carry_block(c, states, stop, cap, rows, finals, sums):
    """Run on from time 0, and fill `finals` with the rows of the ends, `sums` with totals if there is room."""
    for k in range(states.shape[0]):
        count = open_window(c, states[k], rows)
        rows, count, _ = run_window(c, states[k], stop, cap, rows, count)
        for j in range(finals.shape[1]):
            finals[k, j] = rows[count, j]
        if sums.shape[0] > 0:
            totals = window_totals(c, rows, count + 1, 0.0, stop)
            for j in range(sums.shape[1]):
                sums[k, j] = totals[j]


def part_alike(p: Any, states: Floats, by: float) -> None:
    """Let balls that would move as one for ever, since they are in one state, each be faster by so much, in place."""
    names = names_of(p)
    for group in getattr(p, "together", ()):
        x, v = ([names.index(f"{name}_{ball}") for ball in group] for name in ("x2", "v2"))
        own = np.stack([states[:, x], states[:, v]], axis=-1)
        for place in range(1, len(group)):
            states[:, v[place]] += by * np.all(own[:, place, None] == own[:, :place], axis=2).sum(axis=1)


def sort_alike(p: Any, states: Floats) -> Floats:
    """Return states, shape (n, d), with balls that are equal to each other in one order: nothing else tells them apart.

    Those that rest are last, since they may be anywhere.
    """
    groups = getattr(p, "alike", ())
    if not groups:
        return states
    names = names_of(p)
    sorted_states = states.copy()
    for group in groups:
        x, v = ([names.index(f"{name}_{ball}") for ball in group] for name in ("x2", "v2"))
        order = np.lexsort((states[:, x], states[:, v] == 0.0), axis=1)
        for columns in (x, v):
            sorted_states[:, columns] = np.take_along_axis(states[:, columns], order, axis=1)
    return sorted_states
