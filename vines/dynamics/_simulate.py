"""Run the simulator from one start state and keep everything."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.bounds import MOST_EVENTS, check_periods
from vines.domains import Choice, Number, Parameters, Whole, stated
from vines.dynamics import _advance as col
from vines.dynamics._advance import begin
from vines.dynamics._room import IN_TURN, TIES, TOGETHER, constants, room_of, start_of
from vines.dynamics._slices import slices
from vines.dynamics._trajectory import Trajectory
from vines.dynamics._window import run_window

__all__ = ["EVENTS_PER_PERIOD", "STATUS", "record", "simulate"]

EVENTS_PER_PERIOD = 10_000
"""Default cap on events in one forcing period; a complete chatter takes about ln(1e-7)/ln(r) of them."""

STATUS = {col.COMPLETE: "complete", col.EVENT_CAP: "impact_cap", col.STEP_LIMIT: "step_limit"}


def record(
    c: Any, state: npt.NDArray[np.float64], stops: Iterable[float], cap: int, expected: int, width: int = col.ROW
) -> tuple[npt.NDArray[np.float64], str]:
    """Run on to the last of `stops` with every row kept, whatever their number, and a last row for the end.

    Returns
    -------
    (rows, status)
        Rows from one for the last event before the call to one for the end.
    """
    rows = np.empty((max(expected, 16), width))
    begin(c, state, rows)
    count, code = 1, col.COMPLETE
    for stop in stops:
        try:
            rows, count, code = run_window(c, state, stop, cap, rows, count)
        except SystemError as error:
            # What a signal raised while numba handed the rows over; it goes on as if nothing had been.
            raise (error.__cause__ or error) from None
        if code != col.COMPLETE:
            break
    return rows[: count + 1].copy(), STATUS[code]


@stated(
    p=Parameters(),
    t=Number(least=-1e12, most=1e12),
    phi=Number(least=-1e12, most=1e12),
    periods=Number(above=0),
    max_impacts_per_period=Whole(most=MOST_EVENTS),
    ties=Choice(TIES),
)
def simulate(
    p: Any,
    *,
    t: float = 0.0,
    phi: float = 0.0,
    periods: float = 500,
    max_impacts_per_period: int = EVENTS_PER_PERIOD,
    ties: str = TOGETHER,
    **start: Any,
) -> Trajectory:
    """Run a system exactly, event by event, and keep every event.

    Parameters
    ----------
    p : Params, or the parameters of another system
        Dimensionless parameters.
    t : float
        Time of the start.
    phi : float
        Phase of the forcing at t = 0 [rad].
    periods : float
        Forcing periods to run, > 0.
    max_impacts_per_period : int
        Cap on events in one forcing period; when it is passed the run ends there with status ``impact_cap``.
    ties : str
        How several balls are struck that arrive at one instant: ``together`` by one law of all, or ``in_turn``, one
        after the other in the order of their numbers, as `vines.settle` has it (docs/dynamics.md, "Ties").
    **start : float
        Start state by the names of the system: x1, v1, x2, v2 of oscillator and ball (0, 0, 0, .1 where not given),
        with a gap of at most 1; w, w_dot of the impact pair. A start on a wall with the ball approaching begins
        with an impact; with no relative velocity the sign of the push decides between sticking and flight.

    Returns
    -------
    Trajectory

    Raises
    ------
    StateError
        If the start is not a state of the model, or `periods` or the cap is not positive.

    Examples
    --------
    >>> from vines.model import Params
    >>> run = simulate(Params(mu=0.01, A=0.015), periods=300)
    >>> "".join("L" if hit["side"] > 0 else "R" for hit in run.impacts[-4:])
    'LRLR'
    >>> abs(run.measures(last=1).balance) < 1e-14
    True
    """
    at = start_of(p, start, t, phi)
    check_periods("periods", periods, p.period)
    c = constants(p)
    room = room_of(p)
    layout = room.layout(p)
    state = np.zeros(layout.state)
    room.begin(c, state, *at, float(t))
    if ties == IN_TURN:
        room.strike_in_turn(state)
    stop = t + periods * p.period
    stops = slices(t, stop, p.period)
    rows, status = record(c, state, stops, max_impacts_per_period, int(4 * periods) + layout.rows, layout.width)
    return (room.trajectory or Trajectory)(p, float(phi), float(t), float(rows[-1, col.TIME]), status, rows)
