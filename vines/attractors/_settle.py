"""Run until the transient has gone, and say what is left."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from vines.attractors._attractor import Attractor
from vines.attractors._classify import Recording, Verdict, classify
from vines.dynamics import _advance as col
from vines.dynamics._advance import new_state, pass_over, set_state, shift_time, state_now
from vines.dynamics._constants import constants
from vines.dynamics._measures import Measures, measures_from
from vines.dynamics._simulate import EVENTS_PER_PERIOD, STATUS
from vines.dynamics._simulate import record as run_on
from vines.dynamics._start import check_start
from vines.dynamics._totals import window_totals
from vines.dynamics._trajectory import impacts_of
from vines.errors import StateError
from vines.model import Params

__all__ = ["settle", "settle_from"]

BLOCKS = 8
"""Blocks of the recorded window from whose scatter standard errors are taken."""

ROUNDS = 8
"""How often a run may be taken on because it had not arrived."""

NUDGE = 1e-6
"""Change of the ball's velocity that frees a run from an unstable orbit on which it sits exactly."""


def settle(
    p: Params,
    *,
    x1: float = 0.0,
    v1: float = 0.0,
    x2: float = 0.0,
    v2: float = 0.1,
    t: float = 0.0,
    phi: float = 0.0,
    settle: float = 400,
    record: float = 64,
    patience: float = 4000,
    tolerance: float = 1e-10,
    lyapunov: bool = True,
    max_impacts_per_period: int = EVENTS_PER_PERIOD,
) -> Attractor:
    """Run for `settle` forcing periods, record the next `record`, and say what the run has settled to.

    Parameters
    ----------
    p : Params
        Dimensionless parameters.
    x1, v1, x2, v2, t, phi : float
        Start, as for `vines.dynamics.simulate`.
    settle : float
        Forcing periods to run first, >= 0.
    record : float
        Forcing periods to record, >= 2; a period pT shows if record >= 2 p.
    patience : float
        Forcing periods to run on, in all, where a run is seen to come to its attractor (or to leave an unstable orbit)
        but has not yet done so; 0 to take it as it is.
    tolerance : float
        Largest distance from a periodic orbit at which the run counts as settled on it.
    lyapunov : bool
        Whether to give exponents; they are worked out anyhow where the regime depends on them.
    max_impacts_per_period : int
        Cap on events in one forcing period; when it is passed the regime is ``unsettled``, status ``impact_cap``.

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
    >>> found = settle(Params(mu=0.01, A=0.023))
    >>> found.regime, found.name, found.word, found.symmetric
    ('periodic', '2:1', 'LLR', False)
    """
    check_start(x1=x1, v1=v1, x2=x2, v2=v2, t=t, phi=phi)
    phase = math.fmod(p.Omega * t, 2 * math.pi) + phi
    start = {"x1": x1, "v1": v1, "x2": x2, "v2": v2, "t": t, "phase": phase}
    return settle_from(
        p,
        start,
        settle=settle,
        record=record,
        patience=patience,
        tolerance=tolerance,
        lyapunov=lyapunov,
        max_impacts_per_period=max_impacts_per_period,
    )


def settle_from(
    p: Params,
    start: Mapping[str, float],
    *,
    settle: float = 400,
    record: float = 64,
    patience: float = 4000,
    tolerance: float = 1e-10,
    lyapunov: bool = True,
    max_impacts_per_period: int = EVENTS_PER_PERIOD,
) -> Attractor:
    """Do as `settle`, from a state with its forcing phase: that of another point's `Attractor.final`, for instance.

    Parameters
    ----------
    p : Params
        Dimensionless parameters.
    start : mapping
        x1, v1, x2, v2 and phase [rad]; t, if given, is only the origin of `Attractor.final["t"]`.
    settle, record, patience, tolerance, lyapunov, max_impacts_per_period
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
    >>> first = settle(Params(mu=0.01, A=0.02))
    >>> settle_from(Params(mu=0.01, A=0.0201), first.final, settle=100).name
    '1:1'
    """
    x1, v1, x2, v2, phase = (float(start[name]) for name in ("x1", "v1", "x2", "v2", "phase"))
    t = float(start.get("t", 0.0))
    check_start(x1=x1, v1=v1, x2=x2, v2=v2, phase=phase, t=t)
    for name, value, least in (("settle", settle, 0), ("record", record, 2), ("patience", patience, 0)):
        if not (isinstance(value, int | float) and math.isfinite(value) and value >= least):
            raise StateError(f"{name} is {value!r} periods; give a finite number >= {least}")
    if not tolerance > 0:
        raise StateError(f"tolerance is {tolerance!r}; give a number > 0")
    run = _Run(p, (x1, v1, x2, v2, phase), max_impacts_per_period)
    recording = run.record(settle, record)
    found = _verdict(recording, run.status, tolerance)
    note = ""
    spare = patience
    for _ in range(ROUNDS):
        if found.unstable and not note:
            note = f"nudged: {found.reason}"
            run.nudge()
            wait = settle
        elif found.settled or not found.remaining <= spare:
            break
        else:
            wait = float(math.ceil(1.05 * found.remaining)) + 1.0
            spare -= wait
        recording = run.record(wait, record)
        found = _verdict(recording, run.status, tolerance)
    measures, errors = _measure(recording, found)
    known = lyapunov or (not math.isnan(found.lyapunov_error) and found.regime not in ("periodic", "no_impact"))
    return Attractor(
        params=p,
        regime=found.regime,
        settled=found.settled,
        word=found.word,
        name=found.name,
        n=found.n,
        m=found.m,
        p=found.p,
        symmetric=found.symmetric,
        sticks=measures.sticks_per_period,
        measures=measures,
        kinetic_ratio_error=errors[0],
        max_abs_x1_error=errors[1],
        rms_x1_error=errors[2],
        impacts=_recorded_impacts(recording),
        final=_final(recording) | {"t": t + run.periods * p.period},
        lyapunov=found.lyapunov if known else math.nan,
        lyapunov_error=found.lyapunov_error if known else math.nan,
        exponents=found.exponents if known else np.full(4, np.nan),
        multipliers=found.multipliers,
        remaining=found.remaining,
        transient=run.periods - record,
        status=run.status,
        reason=found.reason or note,
    )


class _Run:
    """A run that can wait, record, and go on; `periods` counts all of it."""

    def __init__(self, p: Params, begin: tuple[float, float, float, float, float], cap: int) -> None:
        self.p, self.cap = p, cap
        self.c = constants(p)
        self.state = new_state()
        set_state(self.state, *begin, 0.0)
        self.periods = 0.0
        self.status = "complete"
        self._recorded = 0.0

    def record(self, wait: float, length: float) -> Recording:
        """Run on for `wait` forcing periods, then record `length` of them, time counted from there."""
        period = self.p.period
        shift_time(self.state, self._recorded)
        code = pass_over(self.c, self.state, wait * period, self.cap, np.empty((64, col.ROW)))
        shift_time(self.state, wait * period)
        self.periods += wait + length
        self._recorded = length * period
        # Where the run had to stop before, only the instant of the stop is recorded.
        stop = self._recorded if code == col.COMPLETE else float(self.state[col.S_T])
        rows, status = run_on(self.c, self.state, stop, self.cap, int(4 * length) + 64)
        self.status = STATUS[code] if code != col.COMPLETE else status
        return Recording(self.p, self.c, rows, self._recorded, self.state, self.cap)

    def nudge(self) -> None:
        """Change the ball's velocity by NUDGE, to leave an unstable orbit."""
        x1, v1, x2, v2, phase, _ = state_now(self.c, self.state, self._recorded)
        set_state(self.state, x1, v1, x2, v2 + NUDGE, phase, self._recorded)


def _verdict(recording: Recording, status: str, tolerance: float) -> Verdict:
    if status != "complete":
        return Verdict(
            "unsettled", False, remaining=math.nan, reason="more events in a forcing period than the cap allows"
        )
    return classify(recording, tolerance)


def _measure(recording: Recording, found: Verdict) -> tuple[Measures, tuple[float, float, float]]:
    """Return the measures and the standard errors of kinetic_ratio, max_abs_x1, rms_x1."""
    p, c, rows = recording.params, recording.c, recording.rows
    stop = float(rows[-1, col.TIME])
    if found.p is not None:
        stop = _quiet_time(rows, found.p * p.period)
        start = stop - found.p * p.period
        return measures_from(p, window_totals(c, rows, len(rows), start, stop)), (0.0, 0.0, 0.0)
    whole = measures_from(p, window_totals(c, rows, len(rows), 0.0, stop))
    width = stop / BLOCKS
    if not width > 0:
        return whole, (math.nan, math.nan, math.nan)
    parts = [
        measures_from(p, window_totals(c, rows, len(rows), k * width, min((k + 1) * width, stop)))
        for k in range(BLOCKS)
    ]
    values = np.array([(m.kinetic_ratio, m.max_abs_x1, m.rms_x1) for m in parts])
    scatter = np.std(values, axis=0, ddof=1) / math.sqrt(BLOCKS)
    return whole, (float(scatter[0]), float(scatter[1]), float(scatter[2]))


def _quiet_time(rows: npt.NDArray[np.float64], span: float) -> float:
    """Return the middle of the longest pause in the last `span`, so that no event lies on the edge of a window."""
    times = rows[rows[:, col.TIME] >= rows[-1, col.TIME] - span, col.TIME]
    gaps = np.diff(times)
    k = int(np.argmax(gaps))
    return float(times[k] + 0.5 * gaps[k])


def _recorded_impacts(recording: Recording) -> npt.NDArray[np.void]:
    rows = recording.rows
    return impacts_of(rows[1:][rows[1:, col.TIME] > 0.0])


def _final(recording: Recording) -> dict[str, float]:
    last = recording.rows[-1]
    names = {"x1": col.X1, "v1": col.A_V1, "x2": col.X2, "v2": col.A_V2, "phase": col.PHASE}
    return {name: float(last[column]) for name, column in names.items()}
