"""What many runs settle to: the transients in lanes, the decisions as for a single run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeGuard, cast

import numpy as np
import numpy.typing as npt

from vines.attractors import _verdict as v
from vines.attractors._classified import NO_IMPACTS, Classified
from vines.attractors._classify_family import classify_family
from vines.attractors._look import look_at_block
from vines.attractors._naming import word_of
from vines.attractors._patience import Patience
from vines.attractors._settle import APART, NUDGE, ROUNDS
from vines.attractors._staying import note_conserving, watch_on
from vines.attractors._waiting import next_wait
from vines.domains import Whole, stated
from vines.dynamics import ensemble
from vines.dynamics.kernels import ParameterTable, constants_kernel, set_state, state_now
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import totals as entry
from vines.dynamics.runs import (
    EVENTS_PER_PERIOD,
    IN_TURN,
    each_thread,
    impacts_of,
    measures_of,
    parameter_table,
    start_table,
    threads_allowed,
)
from vines.model import DAMPING, FREQUENCY, MASS, PARAMETER_NAMES, RESTITUTION, START_NAMES, Parameters, Params

__all__ = ["Classified", "classify_many"]

Floats = npt.NDArray[np.float64]


STAGES = (4.0, 16.0)
"""Forcing periods after which a recording is looked at before its end: most runs repeat soon."""

BLOCK = 512
"""Most runs in one call of the kernel; a thread takes one block after the other."""


@stated(threads=Whole(optional=True))
def classify_many(
    params: Parameters | Sequence[Parameters] | Mapping[str, npt.ArrayLike],
    starts: Mapping[str, npt.ArrayLike] | None = None,
    *,
    settle: float = 400,
    record: float = 64,
    patience: float = 4000,
    watch: float = 512,
    tolerance: float = 1e-10,
    largest_p: int | None = None,
    impacts: bool = False,
    errors: bool = True,
    max_impacts_per_period: int = EVENTS_PER_PERIOD,
    threads: int | None = None,
    apart: float = APART,
    ties: str = IN_TURN,
) -> Classified:
    """Do as `settle` for many parameter points or starts at once, in lanes and on all cores.

    Parameters
    ----------
    params, starts
        As for `vines.ensemble`; of another system, whose runs settle one by one, parameter objects and starts by its
        names, what every ball has also by its name without a number, in rows of one value a ball.
    settle, record, patience, watch, tolerance, largest_p, max_impacts_per_period
        As for `settle`, but a recording ends as soon as the run is seen to repeat.
    impacts : bool
        Whether to keep the recorded impacts.
    errors : bool
        Whether runs that never repeat are watched on until what they measured has standard errors, as by `settle`.
    threads : int, optional
        Cores to use; all of this process's if left out. Results do not depend on it, nor on what else is in the call.
    apart, ties : float, str
        As for `settle`.

    Returns
    -------
    Classified

    Raises
    ------
    ParameterError, StateError
        If a parameter, start or option is not allowed; the message gives the first one.

    Examples
    --------
    >>> many = classify_many({"mu": 0.01, "A": [0.015, 0.02, 0.021, 0.023, 0.03]})
    >>> many.name.tolist(), many.regime[-1].item()
    (['1:1', '1:1', '2:2/2T', '2:1', None], 'chaotic')
    """
    how = Patience(settle, record, patience, watch, tolerance, max_impacts_per_period, largest_p, ties)
    if _of_another_system(params):
        return classify_family(params, starts, how, apart=apart, impacts=impacts, errors=errors, threads=threads)
    table, given = parameter_table(cast(Any, params)), start_table(starts)
    how.check_length(2.0 * np.pi / float(np.min(table[:, FREQUENCY])))
    n = np.broadcast_shapes(table.shape[:1], given.shape[:1])[0]
    parameters, begin = (np.ascontiguousarray(np.broadcast_to(each, (n, 5))) for each in (table, given))
    work = _Many(parameters, begin.copy(), how, impacts, threads)
    everyone = np.arange(n)
    if settle > 0:
        work.wait(everyone, settle)
    work.arrive(everyone, errors)
    return Classified(parameters, begin, work.words, work.verdicts, work.totals, work.hits)


def _of_another_system(
    params: Parameters | Sequence[Parameters] | Mapping[str, npt.ArrayLike],
) -> TypeGuard[Parameters | Sequence[Parameters]]:
    """Say whether parameters are objects of another system than the VI-NES."""
    first = params[0] if isinstance(params, Sequence) and params else params
    return isinstance(first, Parameters) and not isinstance(first, Params)


class _Many:
    """Runs on their way: where each is, and what was seen of it last."""

    def __init__(self, parameters: Floats, states: Floats, how: Patience, impacts: bool, threads: int | None) -> None:
        n = len(parameters)
        self.parameters, self.states, self.how = parameters, states, how
        self.cores = threads_allowed() if threads is None else max(1, threads)
        self.waited = np.zeros(n, dtype=np.int64)
        self.verdicts = np.zeros((n, v.VERDICT))
        self.totals = np.zeros((n, entry.TOTALS))
        self.words = np.full(n, None, dtype=object)
        self.hits = [NO_IMPACTS] * n if impacts else None
        self.stages = np.array([*(stage for stage in STAGES if stage < how.window), how.window])
        self.conserves = (parameters[:, DAMPING] == 0.0) & (parameters[:, RESTITUTION] == 1.0)

    def place(self, runs: npt.NDArray[np.int64], final: npt.NDArray[np.void], codes: npt.NDArray[np.int64]) -> None:
        """Put runs where an ensemble left them."""
        for k, name in enumerate(START_NAMES):
            self.states[runs, k] = final[name]
        # The kernels of lanes and of a single run number their ends differently.
        self.waited[runs] = np.array([col.COMPLETE, col.EVENT_CAP, col.STEP_LIMIT])[codes]

    def arrive(self, runs: npt.NDArray[np.int64], errors: bool) -> None:
        """Decide what runs have settled to, anew where chaos that was watched on has ended."""
        ran = np.full(len(self.states), float(self.how.settle))
        for turn in range(ROUNDS + 1):
            self.decide(runs, ran)
            found = self.verdicts[runs]
            note_conserving(found, self.conserves[runs])
            self.verdicts[runs] = found
            if not errors or turn == ROUNDS:
                return
            before = self.verdicts[runs, v.RECORDED] + self.verdicts[runs, v.PERIODS]
            ended = self.watch_on(runs)
            ran[runs] = before + self.verdicts[runs, v.WATCHED] - self.verdicts[runs, v.RECORDED]
            runs = runs[ended]
            if not len(runs):
                return

    def decide(self, runs: npt.NDArray[np.int64], begun: Floats) -> None:
        """Look at every run, and wait for those that are seen to come to their attractor.

        `begun` has for each the forcing periods that it was run before.
        """
        n = len(self.states)
        spare = np.full(n, float(self.how.patience))
        ran = begun.copy()
        nudged = np.full(n, np.nan)
        for turn in range(ROUNDS + 1):
            free = np.isnan(nudged[runs])
            self.look(runs, np.stack([spare[runs], free], axis=1) if turn < ROUNDS else np.zeros((len(runs), 2)))
            found = self.verdicts[runs]
            found[:, v.NUDGED], found[:, v.PERIODS] = nudged[runs], ran[runs]
            self.verdicts[runs] = found
            free, come = found[:, v.NEXT] == v.IS_FREED, found[:, v.NEXT] == v.WAITS
            if not np.any(free | come):
                return
            wait = next_wait(np.where(come, found[:, v.REMAINING], 0.0), spare[runs], few_lengths=True)
            wait = np.where(free, float(self.how.settle), wait)
            nudged[runs[free]] = found[free, v.VALUE]
            self.states[runs[free], 3] += NUDGE
            spare[runs[come]] -= wait[come]
            on = free | come
            runs, wait = runs[on], wait[on]
            ran[runs] += found[on, v.RECORDED] + wait
            for length in np.unique(wait[wait > 0]):
                self.wait(runs[wait == length], float(length))

    def wait(self, runs: npt.NDArray[np.int64], periods: float) -> None:
        """Let runs go on for so many forcing periods, in lanes."""
        later = ensemble(
            dict(zip(PARAMETER_NAMES, self.parameters[runs].T, strict=True)),
            dict(zip(START_NAMES, self.states[runs].T, strict=True)),
            periods=periods,
            max_impacts_per_period=self.how.cap,
            threads=self.cores,
        )
        self.place(runs, later.final, later.codes)

    def look(self, runs: npt.NDArray[np.int64], spare: Floats) -> None:
        """Record every run and decide what it shows; `spare` says for how long each may go on, and whether freed."""
        size = min(BLOCK, max(16, -(-len(runs) // (4 * self.cores))))
        blocks = [slice(k, min(k + size, len(runs))) for k in range(0, len(runs), size)]
        each_thread(lambda block: self._look_at(runs[block], spare[block]), blocks, self.cores)

    def watch_on(self, runs: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
        """Watch runs on whose motion never repeated; return which of them have come to another motion."""
        ended = np.zeros(len(runs), dtype=bool)
        wild = np.flatnonzero(np.isin(self.verdicts[runs, v.REGIME], (v.CHAOTIC, v.QUASIPERIODIC, v.UNSETTLED)))
        size = min(BLOCK, max(16, -(-len(wild) // (4 * self.cores))))
        blocks = [slice(k, min(k + size, len(wild))) for k in range(0, len(wild), size)]

        def block(part: slice) -> None:
            some = runs[wild[part]]
            states, found = self._states_of(some), self.verdicts[some]
            period = 2.0 * np.pi / self.parameters[some, FREQUENCY]
            m = measures_of(self.parameters[some, MASS], self.totals[some])
            measured = np.stack([m["kinetic_ratio"], m["max_abs_x1"], m["rms_x1"]], axis=1)
            seen = watch_on(
                lambda few: ParameterTable(self.parameters[some[few]]), states, period, measured, found, self.how
            )
            self.verdicts[some] = found
            ended[wild[part]] = seen
            for k in np.flatnonzero(seen).tolist():
                now = state_now(constants_kernel(*self.parameters[some[k]]), states[k], 0.0)
                self.states[some[k]] = now[: len(START_NAMES)]

        each_thread(block, blocks, self.cores)
        return ended

    def _states_of(self, runs: npt.NDArray[np.int64]) -> Floats:
        """Return the runs at time 0 as kernels hold them."""
        states = np.zeros((len(runs), col.STATE))
        for state, (x1, v1, x2, v2, phase) in zip(states, self.states[runs].tolist(), strict=True):
            set_state(state, x1, v1, x2, v2, phase, 0.0)
        return states

    def _look_at(self, runs: npt.NDArray[np.int64], spare: Floats) -> None:
        verdicts, totals = np.empty((len(runs), v.VERDICT)), np.zeros((len(runs), entry.TOTALS))
        states = self._states_of(runs)
        sides, rows = look_at_block(
            ParameterTable(self.parameters[runs]),
            states,
            self.waited[runs],
            spare,
            self.stages,
            float(self.how.watch),
            self.how.cap,
            self.how.tolerance,
            self.how.longest,
            self.hits is not None,
            verdicts,
            totals,
        )
        self.verdicts[runs], self.totals[runs] = verdicts, totals
        self.states[runs] = verdicts[:, v.FINAL : v.FINAL + 5]
        at = 0
        lags, periods = verdicts[:, v.LAG].astype(int).tolist(), verdicts[:, v.P].astype(int).tolist()
        for run, lag, p in zip(runs.tolist(), lags, periods, strict=True):
            self.words[run] = word_of(sides[at : at + lag], p) if lag else None
            at += lag
        if self.hits is not None:
            ends = np.searchsorted(rows[:, col.ROW], np.arange(len(runs) + 1))
            for k, run in enumerate(runs.tolist()):
                self.hits[run] = impacts_of(rows[ends[k] : ends[k + 1]])
