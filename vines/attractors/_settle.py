"""Run until the transient has gone, and say what is left."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.attractors import _verdict as v
from vines.attractors._attractor import Attractor
from vines.attractors._look import look_at_block
from vines.attractors._naming import attractor_from, word_of
from vines.attractors._patience import Patience
from vines.attractors._staying import REGULAR, note_conserving, watch_on
from vines.attractors._waiting import next_wait
from vines.domains import Named, Number, Parameters, stated
from vines.dynamics.kernels import Room, constants, pass_over, room_of, shift_time, table_of
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import EVENTS_PER_PERIOD, IN_TURN, impacts_of, measures_from, slices, start_of
from vines.errors import StateError
from vines.model import Word

__all__ = ["APART", "NUDGE", "ROUNDS", "Settled", "parted", "settle", "settle_from", "settled"]

ROUNDS = 8
"""How often a run may be taken on because it had not arrived."""

NUDGE = 1e-6
"""Change of the ball's velocity that frees a run from an unstable orbit on which it sits exactly."""


APART = 1e-9
"""Difference in velocity with which equal balls start."""


@stated(
    p=Parameters(),
    t=Number(least=-1e12, most=1e12),
    phi=Number(least=-1e12, most=1e12),
    apart=Number(least=0, most=1e-3),
)
def settle(
    p: Any,
    *,
    t: float = 0.0,
    phi: float = 0.0,
    settle: float = 400,
    record: float = 64,
    patience: float = 4000,
    watch: float = 512,
    tolerance: float = 1e-10,
    largest_p: int | None = None,
    lyapunov: bool = True,
    errors: bool = True,
    max_impacts_per_period: int = EVENTS_PER_PERIOD,
    apart: float = APART,
    ties: str = IN_TURN,
    **start: Any,
) -> Attractor:
    """Run for `settle` forcing periods, record the next `record`, and say what the run has settled to.

    Parameters
    ----------
    p : Params, or the parameters of another system
        Dimensionless parameters.
    t, phi : float
        Time of the start, and phase of the forcing at t = 0 [rad].
    settle : float
        Forcing periods to run first, >= 0.
    record : float
        Forcing periods to record, >= 2; a period pT shows if record >= 2 p.
    patience : float
        Forcing periods to run on, in all, where a run is seen to come to its attractor (or to leave an unstable orbit)
        but has not yet done so; 0 to take it as it is.
    watch : float
        Forcing periods, >= 16, to run on where nothing repeats, before an exponent is believed; up to 16 times as many
        where it does not differ from 0.
    tolerance : float
        Largest distance from a periodic orbit at which the run counts as settled on it, at most 1e-4.
    largest_p : int, optional
        Largest number of forcing periods over which a repetition is looked for, at most 4096; at least twice as many
        are recorded. As if 32 where it is left out, or half of `record` if that is less.
    lyapunov : bool
        Whether to give exponents; they are worked out anyhow where the regime depends on them.
    errors : bool
        Whether a run that never repeats is watched on, for nine times `record` and up to `patience` periods, until what
        it measured has standard errors; where its chaos ends on the way it is looked at again from there.
    max_impacts_per_period : int
        Cap on events in one forcing period; when it is passed the regime is ``unsettled``, status ``impact_cap``.
    apart : float
        By how much more than the one before it each of several balls of one length and restitution starts in velocity:
        those that hit together would do so for ever, which no run does that begins beside it. 0 to leave them.
    ties : str
        How balls are struck that arrive at one instant, as those do that rode on one wall and have cavities of one
        length: ``in_turn``, one after the other in the order of their numbers, which is what the smallest difference
        between them comes to, or ``together``, by one law of all, so that equal balls move as one. Ties are counted in
        ``measures.ties`` (docs/dynamics.md, "Ties").
    **start : float
        Start state by the names of the system, as for `vines.dynamics.simulate`.

    Returns
    -------
    Attractor

    Raises
    ------
    StateError
        If the start is not a state of the model or an option is out of range.

    Notes
    -----
    A run that sits on an unstable periodic orbit (a carried sweep past its bifurcation does) is nudged once by 1e-6 in
    v2 and run again for the same time; `reason` then says so.

    Examples
    --------
    >>> from vines.model import Params
    >>> found = settle(Params(mu=0.01, A=0.023))
    >>> found.regime, found.name, found.word, found.symmetric
    ('periodic', '2:1', 'LLR', False)
    """
    begin = parted(p, start_of(p, start, t, phi), apart)
    found = settled(
        p, begin, Patience(settle, record, patience, watch, tolerance, max_impacts_per_period, largest_p, ties), errors
    )
    return attractor_from(p, *found, t, lyapunov)


@stated(p=Parameters(), start=Named(Number()))
def settle_from(
    p: Any,
    start: Mapping[str, float],
    *,
    settle: float = 400,
    record: float = 64,
    patience: float = 4000,
    watch: float = 512,
    tolerance: float = 1e-10,
    largest_p: int | None = None,
    lyapunov: bool = True,
    errors: bool = True,
    max_impacts_per_period: int = EVENTS_PER_PERIOD,
    ties: str = IN_TURN,
) -> Attractor:
    """Do as `settle`, from a state with its forcing phase: that of another point's `Attractor.final`, for instance.

    Parameters
    ----------
    p : Params, or the parameters of another system
        Dimensionless parameters.
    start : mapping
        The coordinates of the system (x1, v1, x2, v2) and phase [rad]; t, if given, is only the origin of
        `Attractor.final["t"]`.
    settle, record, patience, watch, tolerance, largest_p, lyapunov, errors, max_impacts_per_period, ties
        As for `settle`.

    Returns
    -------
    Attractor

    Raises
    ------
    StateError
        If the start is not a state of the model or an option is out of range.

    Examples
    --------
    >>> from vines.model import Params
    >>> first = settle(Params(mu=0.01, A=0.02))
    >>> settle_from(Params(mu=0.01, A=0.0201), first.final, settle=100).name
    '1:1'
    """
    if "phase" not in start:
        raise StateError(f"start has {', '.join(map(str, start)) or 'nothing'}; give all coordinates and the phase")
    t = float(start.get("t", 0.0))
    at = {name: value for name, value in start.items() if name not in ("t", "phase")}
    begin = start_of(p, at, 0.0, start["phase"])
    found = settled(
        p, begin, Patience(settle, record, patience, watch, tolerance, max_impacts_per_period, largest_p, ties), errors
    )
    return attractor_from(p, *found, t, lyapunov)


def _passed_over(
    c: Any, state: npt.NDArray[np.float64], stop: float, period: float, cap: int, work: npt.NDArray[np.float64]
) -> int:
    """Run on to `stop` as `pass_over` does, in slices between which Python hears Ctrl-C."""
    code = 0
    for end in slices(0.0, stop, period):
        code = pass_over(c, state, end, cap, work)
        if code:
            break
    return code


class Settled(NamedTuple):
    """A run at its end: verdict, totals of the window, word if it repeats, and recorded impacts."""

    verdict: npt.NDArray[np.float64]
    totals: npt.NDArray[np.float64]
    word: Word | None
    hits: npt.NDArray[np.void]


def parted(p: Any, begin: tuple[Any, Any, Any, Any, float], apart: float) -> tuple[Any, Any, Any, Any, float]:
    """Return a start in which balls of one length and restitution differ in velocity."""
    x1, v1, x2, v2, phase = begin
    for group in getattr(p, "together", ()):
        v2[np.array(group) - 1] += apart * np.arange(len(group))
    return x1, v1, x2, v2, phase


def _begin(
    room: Room, c: Any, state: npt.NDArray[np.float64], at: tuple[Any, Any, Any, Any, float], how: Patience
) -> None:
    """Put a run at its start, at time 0."""
    room.begin(c, state, *at, 0.0)
    if how.ties == IN_TURN:
        room.strike_in_turn(state)


def settled(p: Any, begin: tuple[Any, Any, Any, Any, float], how: Patience, errors: bool) -> Settled:
    """Run from a start, as kernels hold it, until it is decided what it settles to."""
    how.check_length(p.period)
    c, room = constants(p), room_of(p)
    layout = room.layout(p)
    states = np.zeros((1, layout.state))
    state = states[0]
    _begin(room, c, state, begin, how)
    table = table_of(p)
    work = np.empty((layout.rows, layout.width))
    length = v.EXPONENTS + 3 * layout.directions + layout.width - col.ROW
    verdicts, totals = np.empty((1, length)), np.zeros((1, layout.totals))
    verdict = verdicts[0]
    stages, period = np.array([how.window]), np.array([p.period])
    sides, hits = np.empty(0, dtype=np.int8), np.empty((0, layout.width + 1))
    wait, spare, ran, nudged = float(how.settle), float(how.patience), 0.0, math.nan
    for turn in range(ROUNDS + 1):
        waited = np.array([_passed_over(c, state, wait * p.period, p.period, how.cap, work)])
        shift_time(state, wait * p.period)
        left = np.array([[spare, math.isnan(nudged)]]) if turn < ROUNDS else np.zeros((1, 2))
        sides, hits = look_at_block(
            table,
            states,
            waited,
            left,
            stages,
            float(how.watch),
            how.cap,
            how.tolerance,
            how.longest,
            True,
            verdicts,
            totals,
        )
        shift_time(state, how.window * p.period)
        ran += wait + how.window
        if verdict[v.NEXT] == v.STAYS:
            if verdict[v.SETTLED] > 0.0 and room.conserves(p):
                note_conserving(verdicts, np.ones(1, dtype=bool))
            if not errors or turn == ROUNDS or verdict[v.REGIME] in REGULAR:
                break
            m = measures_from(p, totals[0])
            measured = np.array([[m.kinetic_ratio, m.max_abs_x1, m.rms_x1]])
            if not watch_on(lambda _: table, states, period, measured, verdicts, how)[0]:
                break
            wait, ran = 0.0, ran + float(verdict[v.WATCHED] - verdict[v.RECORDED])
        elif verdict[v.NEXT] == v.IS_FREED:
            wait, nudged = float(how.settle), float(verdict[v.VALUE])
            *at, phase = verdict[v.FINAL : v.FINAL + 5].tolist()
            there = room.leave(p, at, phase, verdict[length - layout.width + col.ROW :].tolist())
            x1, v1, x2, v2 = room.enter(p, there, phase)
            _begin(room, c, state, (x1, v1, x2, v2 + NUDGE, phase), how)
        else:
            wait = float(next_wait(verdict[v.REMAINING], spare, few_lengths=False))
            spare -= wait
    verdict[v.NUDGED], verdict[v.PERIODS] = nudged, ran - how.window
    word = word_of(sides, int(verdict[v.P]), p) if len(sides) else None
    return Settled(verdict, totals[0], word, impacts_of(hits, p))
