"""Many trajectories at once: many parameter points, many starts, or both."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from vines.bounds import MOST_EVENTS, check_periods, shown
from vines.cores import cores
from vines.domains import Choice, Number, Of, Whole, stated
from vines.dynamics import _advance as col
from vines.dynamics import _lane_run as lanes
from vines.dynamics import _totals as entry
from vines.dynamics._lane_record import arrange
from vines.dynamics._scatter import Scatter
from vines.dynamics._scatter_constants import ROOM
from vines.dynamics._scatter_run import scatter_block
from vines.dynamics._simulate import EVENTS_PER_PERIOD
from vines.dynamics._start import LARGEST, SLACK
from vines.dynamics._trajectory import IMPACT
from vines.errors import ParameterError, StateError, nearest
from vines.model import FREQUENCY, MASS, PARAMETER_NAMES, START_NAMES, STATE_NAMES, VI_NES, X1, X2, Params

__all__ = [
    "FINAL",
    "MEASURES",
    "STATUS_NAMES",
    "Ensemble",
    "each_thread",
    "ensemble",
    "measures_of",
    "parameter_table",
    "start_table",
    "threads_allowed",
]

Floats = npt.NDArray[np.float64]

RECORDS = ("final", "measures", "impacts")
"""What an ensemble may record, in the order of what it costs."""

STATUS_NAMES = ("complete", "impact_cap", "step_limit")

_PARAMETER_DEFAULTS = {parameter.name: parameter.default for parameter in VI_NES.parameters}
_START_DEFAULTS = {coordinate.name: coordinate.start for coordinate in VI_NES.start}

FINAL = np.dtype([(name, "f8") for name in START_NAMES] + [("stuck", "i1")])
"""State at the end; `stuck` is 0 in flight, else the wall that the ball rides on."""

MEASURES = np.dtype(
    [
        (name, "f8")
        for name in (
            "duration",
            "kinetic_1",
            "kinetic_2",
            "kinetic_ratio",
            "max_abs_x1",
            "t_max_abs_x1",
            "rms_x1",
            "base_work",
            "damper_loss",
            "impact_loss_left",
            "impact_loss_right",
            "energy_change",
        )
    ]
    + [(f"{name}_error", "f8") for name in ("kinetic_ratio", "max_abs_x1", "rms_x1")]
    + [(name, "i8") for name in ("impacts_left", "impacts_right", "sticks_left", "sticks_right")]
)
"""As `Measures`, one row a trajectory, times counted from the start of the recording.

The standard errors are those of batch means: the scatter of a measure over eight equal parts of the recorded time,
divided by the root of eight; nan where the run ended before its time. They hold if a part is longer than the memory of
the motion; for a periodic orbit they are 0 only if a part holds whole periods of it.
"""

RUN_IMPACT = np.dtype([("run", "i8"), *((name, IMPACT[name]) for name in IMPACT.names or ())])

BLOCK = 4096
"""Most trajectories in one call of the kernel; a thread takes one block after the other."""


@dataclass(frozen=True)
class Ensemble:
    """What became of many trajectories; row k of every array belongs to trajectory k.

    Attributes
    ----------
    parameters : ndarray, shape (n, 5)
        mu, A, Omega, r, lam.
    starts : ndarray, shape (n, 5)
        x1, v1, x2, v2 and phase [rad].
    final : structured ndarray, dtype FINAL
        State at the end; that of the last event where the status is not ``complete``.
    counts : ndarray of int, shape (n,)
        Impacts in all, those before the recording included.
    codes : ndarray of int, shape (n,)
        0 ``complete``, 1 ``impact_cap``, 2 ``step_limit``; see `status`.
    impacts : structured ndarray or None
        Recorded impacts as `Trajectory.impacts`, with the column `run` first; sorted by run and time.
    exponents : ndarray, shape (n, 4), or None
        Lyapunov exponents over the recorded time, in descending order, -inf for directions that sticking removes.
    exponent_errors : ndarray, shape (n, 4), or None
        Their standard errors by means of eight batches, 0 for directions that sticking removes.
    scatter : Scatter or None
        What was drawn at random, with its seed.
    """

    parameters: Floats
    starts: Floats
    final: npt.NDArray[np.void]
    counts: npt.NDArray[np.int64]
    codes: npt.NDArray[np.int64]
    impacts: npt.NDArray[np.void] | None = field(default=None, repr=False)
    exponents: Floats | None = None
    exponent_errors: Floats | None = None
    scatter: Scatter | None = None
    _measured: npt.NDArray[np.void] | _Runs | None = field(default=None, repr=False)

    def __len__(self) -> int:
        return len(self.counts)

    @property
    def status(self) -> npt.NDArray[np.str_]:
        """``complete``, ``impact_cap`` or ``step_limit`` for each trajectory."""
        return np.array(STATUS_NAMES)[self.codes]

    @cached_property
    def measures(self) -> npt.NDArray[np.void] | None:
        """Energy measures over the recorded time, dtype MEASURES; None where only final states were recorded.

        With the standard errors of kinetic_ratio, max_abs_x1 and rms_x1 by batch means. Where impacts were recorded
        the trajectories are run again for them, the same to the last bit, when they are first asked for.
        """
        known = self._measured
        return known.done(lanes.WITH_MEASURES).measures if isinstance(known, _Runs) else known


@dataclass(frozen=True)
class _Runs:
    """What is to be run, whatever of it is recorded."""

    table: Floats
    begin: Floats
    periods: float
    settle: float
    cap: int
    scatter: Scatter | None
    threads: int | None

    def done(self, what: int) -> Ensemble:
        """Run all, block by block, and return the ensemble."""
        work = _Work(self, what)
        n = len(self.table)
        cores = threads_allowed() if self.threads is None else max(1, self.threads)
        # Lanes idle at the end of a block, so on one core all is one; but impacts would fill more memory than caches.
        whole = cores == 1 and not what & lanes.WITH_IMPACTS
        size = min(BLOCK, n if whole else max(lanes.LANES, -(-n // (4 * cores))))
        blocks = [slice(k, min(k + size, n)) for k in range(0, n, size)]
        each_thread(work.run, blocks, cores)
        return work.result()


@stated(
    periods=Number(above=0),
    settle=Number(least=0),
    record=Choice(RECORDS),
    scatter=Of("Scatter", optional=True),
    threads=Whole(optional=True),
    max_impacts_per_period=Whole(most=MOST_EVENTS),
)
def ensemble(
    params: Params | Sequence[Params] | Mapping[str, npt.ArrayLike],
    starts: Mapping[str, npt.ArrayLike] | None = None,
    *,
    periods: float = 500,
    settle: float = 0,
    record: Literal["final", "measures", "impacts"] = "final",
    lyapunov: bool = False,
    scatter: Scatter | None = None,
    max_impacts_per_period: int = EVENTS_PER_PERIOD,
    threads: int | None = None,
) -> Ensemble:
    """Run many trajectories, in lanes and on all cores.

    Parameters
    ----------
    params : Params, sequence of Params, or mapping of arrays
        One for all, one for each, or arrays by name (``{"mu": .01, "A": np.linspace(.01, .1, 100)}``; Omega, r, lam may
        be left out).
    starts : mapping of arrays, optional
        x1, v1, x2, v2, phase [rad]; what is left out is as in `simulate`. Broadcast against `params`.
    periods : float
        Forcing periods to record, > 0.
    settle : float
        Forcing periods to run first, of which nothing is kept.
    record : {"final", "measures", "impacts"}
        ``final`` keeps states at the end only; ``measures`` energy measures too; ``impacts`` every impact too, and
        runs once more for the measures only if `Ensemble.measures` is asked for.
    lyapunov : bool
        Whether to give Lyapunov exponents over the recorded time.
    scatter : Scatter, optional
        Restitution that varies from impact to impact, noise and a second harmonic of the base, units that differ.
    max_impacts_per_period : int
        Cap on events in one forcing period; a trajectory that passes it ends there, its status says so.
    threads : int, optional
        Cores to use; all of this process's if left out, one in a worker process. Results do not depend on it.

    Returns
    -------
    Ensemble

    Raises
    ------
    ParameterError, StateError
        If a parameter or start is not allowed; the message gives the first one.

    Examples
    --------
    >>> import numpy as np
    >>> p = Params(mu=0.01, A=0.015)
    >>> many = ensemble(p, {"v2": np.linspace(0.05, 0.15, 5)}, settle=300, periods=10, record="measures")
    >>> many.measures["impacts_left"]
    array([10, 10, 10, 10, 10])
    """
    table = parameter_table(params)
    begin = start_table(starts)
    n = np.broadcast_shapes(table.shape[:1], begin.shape[:1])[0]
    # Copies: a kernel would be compiled once more for arrays that are read-only, as those of broadcast_to are.
    table = np.array(np.broadcast_to(table, (n, len(PARAMETER_NAMES))), order="C")
    begin = np.array(np.broadcast_to(begin, (n, len(START_NAMES))), order="C")
    longest = 2.0 * math.pi / float(np.min(table[:, FREQUENCY]))
    for name, value in (("periods", periods), ("settle", settle)):
        check_periods(name, value, longest)
    if scatter is not None and lyapunov:
        raise StateError("lyapunov is not defined for runs with scatter; leave one of them out")
    if scatter is not None and scatter.spread:
        table = scatter.units(VI_NES, table)
    what = {"final": lanes.FINAL, "measures": lanes.WITH_MEASURES, "impacts": lanes.WITH_IMPACTS}[record]
    what += lanes.WITH_EXPONENTS if lyapunov else 0
    return _Runs(table, begin, periods, settle, max_impacts_per_period, scatter, threads).done(what)


def threads_allowed() -> int:
    """Return how many threads this process may use: its cores, one in a worker process of a pipeline."""
    named = os.environ.get("NUMBA_NUM_THREADS", "")
    there = cores()
    return min(int(named), there) if named.isdigit() and int(named) > 0 else there


def each_thread(work: Callable[[slice], object], blocks: Iterable[slice], cores: int) -> None:
    """Do the work of every block on so many threads; kernels release the interpreter's lock.

    After Ctrl-C no block begins, and nobody waits for those that have begun.
    """
    blocks = list(blocks)
    if cores == 1 or len(blocks) <= 1:
        for block in blocks:
            work(block)
        return
    # The first block alone compiles or loads the kernel, once.
    work(blocks[0])
    pool = ThreadPoolExecutor(cores)
    try:
        for _ in pool.map(work, blocks[1:]):
            pass
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


class _Work:
    """The arrays of an ensemble, filled block by block."""

    def __init__(self, runs: _Runs, what: int) -> None:
        n = len(runs.table)
        self.runs, self.what = runs, what
        span = 2.0 * math.pi / runs.table[:, FREQUENCY]
        self.first, self.lengths = runs.settle * span, runs.periods * span
        self.finals = np.zeros((n, 6))
        self.totals = np.zeros((n, entry.TOTALS)) if what & lanes.WITH_MEASURES else None
        self.errors = np.full((n, 3), math.nan) if what & lanes.WITH_MEASURES else None
        self.growths = np.zeros((n, 5)) if what & lanes.WITH_EXPONENTS else None
        self.growth_errors = np.zeros((n, 4)) if what & lanes.WITH_EXPONENTS else None
        self.counts = np.zeros(n, dtype=np.int64)
        self.codes = np.zeros(n, dtype=np.int64)
        self.events: dict[int, Floats] = {}
        self.sizes: dict[int, int] = {}

    def run(self, block: slice) -> None:
        """Run a block; its events get more room until they fit."""
        n, scatter = block.stop - block.start, self.runs.scatter
        totals = np.zeros((0, entry.TOTALS)) if self.totals is None else self.totals[block]
        errors = np.zeros((0, 3)) if self.errors is None else self.errors[block]
        growths = np.zeros((0, 5)) if self.growths is None else self.growths[block]
        growth_errors = np.zeros((0, 4)) if self.growth_errors is None else self.growth_errors[block]
        room = int(n * (4 * self.runs.periods + 64)) if self.what & lanes.WITH_IMPACTS else 0
        while True:
            events = np.empty((room, col.ROW + 1))
            common = (self.runs.cap, self.what, self.finals[block], totals, errors)
            rest = (self.counts[block], self.codes[block], events)
            runs = (self.runs.table[block], self.runs.begin[block], self.first[block], self.lengths[block])
            if scatter is None:
                filled = lanes.run_block(*runs, *common, growths, growth_errors, *rest)
            else:
                own = np.empty(ROOM)
                filled = scatter_block(
                    *runs, *common, *rest, scatter.numbers(self.runs.table[block]), block.start, own.ctypes.data
                )
            if not np.any(self.codes[block] == lanes.OVERFLOW):
                break
            room *= 2
        if self.what & lanes.WITH_IMPACTS:
            self.sizes[block.start] = n
            self.events[block.start] = events[:filled]

    def result(self) -> Ensemble:
        """Put the arrays together."""
        final = np.empty(len(self.finals), dtype=FINAL)
        for k, name in enumerate(FINAL.names or ()):
            final[name] = self.finals[:, k]
        exponents = exponent_errors = None
        if self.growths is not None and self.growth_errors is not None:
            rates = self.growths[:, :4] / self.growths[:, 4:]
            order = np.argsort(-rates, axis=1, kind="stable")
            exponents = np.take_along_axis(rates, order, axis=1)
            exponent_errors = np.take_along_axis(self.growth_errors, order, axis=1)
        return Ensemble(
            parameters=self.runs.table,
            starts=self.runs.begin,
            final=final,
            counts=self.counts,
            codes=self.codes,
            impacts=self._impacts() if self.what & lanes.WITH_IMPACTS else None,
            exponents=exponents,
            exponent_errors=exponent_errors,
            scatter=self.runs.scatter,
            _measured=self._measured(),
        )

    def _measured(self) -> npt.NDArray[np.void] | _Runs | None:
        """Return the measures if they were taken; for impacts alone what is to be run again if they are asked for."""
        if self.totals is not None:
            return measures_of(self.runs.table[:, MASS], self.totals, self.errors)
        return self.runs if self.what & lanes.WITH_IMPACTS else None

    def _impacts(self) -> npt.NDArray[np.void]:
        out = np.empty(sum(len(rows) for rows in self.events.values()), dtype=RUN_IMPACT)
        place = 0
        for start in sorted(self.events):
            rows = self.events.pop(start)
            arrange(rows, self.sizes[start], start, out[place : place + len(rows)])
            place += len(rows)
        return out


def measures_of(mu: Floats, totals: Floats, errors: Floats | None = None) -> npt.NDArray[np.void]:
    """Return energy measures, dtype MEASURES, from totals of windows, shape (n, TOTALS), and their standard errors."""
    out = np.empty(len(totals), dtype=MEASURES)
    duration = totals[:, entry.DURATION]
    v1, v2 = totals[:, entry.V1_SQUARE], totals[:, entry.V2_SQUARE]
    with np.errstate(divide="ignore", invalid="ignore"):
        out["duration"] = duration
        out["kinetic_1"] = 0.5 * v1 / duration
        out["kinetic_2"] = 0.5 * mu * v2 / duration
        out["kinetic_ratio"] = np.where(v1 > 0, mu * v2 / v1, np.nan)
        out["rms_x1"] = np.sqrt(np.maximum(totals[:, entry.X1_SQUARE], 0.0) / duration)
    for k, name in enumerate(("kinetic_ratio", "max_abs_x1", "rms_x1")):
        out[f"{name}_error"] = math.nan if errors is None else errors[:, k]
    for name, column in (
        ("max_abs_x1", entry.MAX_ABS_X1),
        ("t_max_abs_x1", entry.T_MAX_ABS_X1),
        ("base_work", entry.BASE_WORK),
        ("damper_loss", entry.DAMPER_LOSS),
        ("impact_loss_left", entry.LOSS_LEFT),
        ("impact_loss_right", entry.LOSS_RIGHT),
        ("energy_change", entry.ENERGY_CHANGE),
        ("impacts_left", entry.IMPACTS_LEFT),
        ("impacts_right", entry.IMPACTS_RIGHT),
        ("sticks_left", entry.STICKS_LEFT),
        ("sticks_right", entry.STICKS_RIGHT),
    ):
        out[name] = totals[:, column]
    return out


def parameter_table(params: Params | Sequence[Params] | Mapping[str, npt.ArrayLike]) -> Floats:
    """Return the parameters of many runs, shape (n, 5), or raise `ParameterError`."""
    if isinstance(params, Params):
        return np.array([[getattr(params, name) for name in PARAMETER_NAMES]])
    if isinstance(params, Mapping):
        return _check_parameters(_columns(params, _PARAMETER_DEFAULTS, ParameterError, "parameter"))
    if isinstance(params, list | tuple) and not params:
        raise ParameterError("params is empty; give at least one point")
    if not isinstance(params, Sequence) or isinstance(params, str | bytes):
        raise ParameterError(f"params is {shown(params)}; give vines.Params, a list of them, or arrays by name")
    for p in params:
        if not isinstance(p, Params):
            raise ParameterError(f"params holds {shown(p)}; give vines.Params, a list of them, or arrays by name")
    return np.array([[getattr(p, name) for name in PARAMETER_NAMES] for p in params])


def _columns(
    given: Mapping[str, npt.ArrayLike],
    defaults: Mapping[str, float | None],
    error: type[Exception],
    kind: str,
) -> Floats:
    for name in given:
        if name not in defaults:
            raise error(f"unknown {kind} {name!r}: {nearest(name, defaults)}")
    arrays = []
    for name, default in defaults.items():
        value = given.get(name, default)
        if value is None:
            raise error(f"{kind} {name!r} is missing; give a number or an array")
        try:
            numbers = None if isinstance(value, str | bytes | bool) else np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            numbers = None
        if numbers is None or not numbers.size:
            raise error(f"{name} is {shown(value)}; give a number or an array of numbers")
        arrays.append(np.atleast_1d(numbers).ravel())
    try:
        return np.stack(np.broadcast_arrays(*arrays), axis=1)
    except ValueError:
        sizes = ", ".join(f"{name} {len(a)}" for name, a in zip(defaults, arrays, strict=True) if len(a) > 1)
        raise error(f"arrays of different lengths ({sizes}); give one length, or single numbers") from None


def _check_parameters(table: Floats) -> Floats:
    good = np.isfinite(table).all(axis=1)
    for parameter, column in zip(VI_NES.parameters, table.T, strict=True):
        good &= parameter.allowed.holds(column)
    if not good.all():
        # The first bad point says in the words of Params what is wrong.
        k = int(np.flatnonzero(~good)[0])
        Params(**dict(zip(PARAMETER_NAMES, table[k].tolist(), strict=True)))
    return table


def start_table(starts: Mapping[str, npt.ArrayLike] | None) -> Floats:
    """Return the starts of many runs, shape (n, 5), or raise `StateError`."""
    if not (starts is None or isinstance(starts, Mapping)):
        raise StateError(f"starts is {shown(starts)}; give arrays by name, such as {{'v2': [0.1, 0.2]}}")
    table = _columns(starts or {}, _START_DEFAULTS, StateError, "start")
    bad = ~np.isfinite(table).all(axis=1)
    if bad.any():
        raise StateError(f"start {int(np.flatnonzero(bad)[0])} is not finite; give finite numbers")
    far = np.abs(table[:, : len(STATE_NAMES)]).max(axis=1) > LARGEST
    if far.any():
        k = int(np.flatnonzero(far)[0])
        raise StateError(f"start {k} is {table[k].tolist()}, allowed are coordinates of at most {LARGEST:g}")
    w = table[:, X1] - table[:, X2]
    outside = np.abs(w) > 1.0 + SLACK
    if outside.any():
        k = int(np.flatnonzero(outside)[0])
        raise StateError(
            f"the gap w = x1 - x2 is {w[k]:g} at start {k}; allowed is |w| <= 1: the ball is in the cavity"
        )
    return table
