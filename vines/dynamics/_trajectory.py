"""A run of the simulator: its events, and everything that follows from them in closed form."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.domains import Number, Numbers, Whole, stated
from vines.dynamics import _advance as col
from vines.dynamics._measures import Measures, measures_from
from vines.dynamics._room import constants, room_of
from vines.dynamics._totals import accumulate, sample_rows, window_totals
from vines.errors import StateError
from vines.html import html_table
from vines.model import START_NAMES, STATE_NAMES, VI_NES

__all__ = ["BALL_IMPACT", "EVENT", "IMPACT", "SAMPLE", "STICK", "Trajectory", "impacts_of"]

_ENERGIES = VI_NES.energies

EVENT = np.dtype(
    [("kind", "i1"), ("side", "i1")] + [(name, "f8") for name in ("t", "phase", *STATE_NAMES, "v1_after", "v2_after")]
)
"""Kind 0 start (also a fresh start inside a very long flight), 1 impact, 2 stick, 3 release, 4 end; with
friction also 5 stop in mid-cavity, 6 slide: the ball turns, or slides again."""

IMPACT = np.dtype(
    [("t", "f8"), ("side", "i1")]
    + [(name, "f8") for name in (*STATE_NAMES, "w_dot", "v1_after", "v2_after", "phase")]
    + [("index", "i8")]
)
STICK = np.dtype(
    [("side", "i1")]
    + [(name, "f8") for name in ("t_start", "t_release", "phase_start", "phase_release")]
    + [("impacts", "i8")]
)
MOST_SAMPLES = 50_000_000
"""Most samples of one call: they take gigabytes."""

SAMPLE = np.dtype(
    [(name, "f8") for name in ("t", *STATE_NAMES, "w", "w_dot", "phase")]
    + [("stuck", "i1")]
    + [(name, "f8") for name in ("base", *_ENERGIES.stored, *_ENERGIES.gained, *_ENERGIES.lost)]
)

_COLUMN = {
    "kind": col.KIND,
    "side": col.SIDE,
    "t": col.TIME,
    "phase": col.PHASE,
    "x1": col.X1,
    "v1": col.V1,
    "x2": col.X2,
    "v2": col.V2,
    "v1_after": col.A_V1,
    "v2_after": col.A_V2,
}

Table = npt.NDArray[np.void]


BALL_IMPACT = np.dtype([*IMPACT.descr, ("ball", "i8"), ("ties", "i8")])
"""Where there are several balls: the number of the ball, from 1 on, and how many others hit at the same instant."""


def impacts_of(rows: npt.NDArray[np.float64], p: Any = None) -> Table:
    """Return the impacts among rows of a system as a structured array of dtype IMPACT, with what it has beside that.

    Where balls have numbers the dtype is BALL_IMPACT; other columns are those of `Room.beside`.
    """
    hits = rows[rows[:, col.KIND] == col.IMPACT]
    balls = getattr(p, "balls", 0) > 0
    room = None if p is None else room_of(p)
    beside, width = (room.beside, room.layout(p).width) if room else ((), 0)
    plain = BALL_IMPACT if balls else IMPACT
    out = np.empty(len(hits), dtype=[*plain.descr, *((name, "f8") for name in beside)] if beside else plain)
    if balls:
        out["ball"], out["ties"] = hits[:, col.ROW], hits[:, col.ROW + 1]
    for k, name in enumerate(reversed(beside), start=1):
        out[name] = hits[:, width - k]
    for name, column in _COLUMN.items():
        if name != "kind":
            out[name] = hits[:, column]
    out["w_dot"] = hits[:, col.V1] - hits[:, col.V2]
    out["index"] = np.arange(len(hits))
    return out


@dataclass(frozen=True)
class Trajectory:
    """One run, exact between its events; everything dimensionless.

    Attributes
    ----------
    params : Params, or those of another system
        Parameters of the run.
    phi : float
        Phase of the forcing at t = 0 [rad]: phase = (Omega t + phi) mod 2 pi.
    t_start, t_end : float
        Times of start and end.
    status : str
        ``complete``; ``impact_cap`` if a forcing period had more events than allowed, ``step_limit`` if a flight
        needed more certified steps than allowed: the run then ends at the last event.
    rows : ndarray, shape (n, 13)
        The events as the kernels wrote them.
    """

    params: Any
    phi: float
    t_start: float
    t_end: float
    status: str
    rows: npt.NDArray[np.float64] = field(repr=False)

    def _repr_html_(self) -> str:
        """Return the run as a small table, which a notebook shows."""
        periods = (self.t_end - self.t_start) / self.params.period
        sides = self.impacts["side"]
        return html_table(
            f"Trajectory over {periods:.6g} forcing periods",
            {
                "parameters": self.params,
                "time": f"from {self.t_start:.6g} to {self.t_end:.6g}",
                "impacts": f"{np.count_nonzero(sides > 0)} on L, {np.count_nonzero(sides < 0)} on R",
                "spells of sticking": len(self.sticks),
                "status": self.status,
                "at the end": [f"{name} = {value:.6g}" for name, value in self.final.items()],
            },
        )

    @cached_property
    def events(self) -> Table:
        """All events with the state just before and the velocities just after; see :data:`EVENT`."""
        out = np.empty(len(self.rows), dtype=EVENT)
        for name, column in _COLUMN.items():
            out[name] = self.rows[:, column]
        return out

    @cached_property
    def impacts(self) -> Table:
        """The impacts: t, side (+1 L, -1 R), state and w_dot just before, velocities just after, phase, index."""
        return impacts_of(self.rows, self.params)

    @cached_property
    def sticks(self) -> Table:
        """Spells of sticking: side, times and phases of begin (where the chatter accumulates) and release, impacts.

        The release is nan if the ball is still stuck; `impacts` are those of the chatter that were followed one by one.
        """
        begins = np.flatnonzero(self.rows[:, col.KIND] == col.STICK)
        ends = np.flatnonzero(self.rows[:, col.KIND] == col.RELEASE)
        out = np.empty(len(begins), dtype=STICK)
        out["side"] = self.rows[begins, col.SIDE]
        # The merge replaces a chatter at its present impact; the chain itself ends where its hops accumulate.
        rest = self._rest_of_chatter(begins)
        out["t_start"] = self.rows[begins, col.TIME] + rest
        out["phase_start"] = (self.rows[begins, col.PHASE] + constants(self.params).Omega * rest) % (2 * np.pi)
        out["impacts"] = self.rows[begins, col.RUN]
        out["t_release"] = np.nan
        out["phase_release"] = np.nan
        # A run that starts in contact has its merge too, so that the k-th release belongs to the k-th merge.
        out["t_release"][: len(ends)] = self.rows[ends, col.TIME]
        out["phase_release"][: len(ends)] = self.rows[ends, col.PHASE]
        return out

    @cached_property
    def rests(self) -> Table:
        """Spells in which the ball does not move against the cavity: those of `sticks`, and stops in it with side 0."""
        return self.sticks

    def _rest_of_chatter(self, begins: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        """Return how long the hops left out at each merge last together; 0 where r = 1."""
        rows = self.rows[begins]
        side = rows[:, col.SIDE]
        speed = np.maximum(side * (rows[:, col.V2] - rows[:, col.V1]), 0.0)
        lasts = self._hops(speed, side * self._push(rows)) if self.params.r < 1 else np.zeros(len(rows))
        # Where the push has almost gone the ball is let go before the series would end.
        until = np.append(self.rows[1:, col.TIME], self.t_end)[begins] - rows[:, col.TIME]
        return np.where(lasts < until, lasts, 0.0)

    def _push(self, rows: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return w'' of a free ball at merges."""
        return room_of(self.params).push(self.params, rows[:, col.X1], rows[:, col.V1], rows[:, col.PHASE])

    def _hops(self, speed: npt.NDArray[np.float64], push: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return how long hops last that begin with a speed, 2 u/(a (1 - r)); 0 where nothing pushes."""
        return np.divide(2 * speed, push * (1 - self.params.r), out=np.zeros_like(speed), where=push > 0)

    @property
    def final(self) -> dict[str, float]:
        """State at the end: the coordinates of the system (x1, v1, x2, v2 of the VI-NES), t and phase [rad]."""
        last = self.rows[-1]
        phase = float(last[col.PHASE])
        at = last[[col.X1, col.A_V1, col.X2, col.A_V2]].tolist()
        return {
            **room_of(self.params).leave(self.params, at, phase, last[col.ROW :].tolist()),
            "t": self.t_end,
            "phase": phase,
        }

    @stated(last=Number(above=0, optional=True))
    def measures(self, last: float | None = None) -> Measures:
        """Return the energy measures of the whole run, or of its last forcing periods.

        Parameters
        ----------
        last : float, optional
            Forcing periods before the end, at most as many as were run.

        Raises
        ------
        StateError
            If the run is shorter than that.
        """
        start = self.t_start
        if last is not None:
            start = self.t_end - last * self.params.period
            if not last > 0 or start < self.t_start - 1e-9 * self.params.period:
                ran = (self.t_end - self.t_start) / self.params.period
                raise StateError(
                    f"last is {last!r} periods; allowed is more than 0 and at most the {ran:g} that were run"
                )
            start = max(start, self.t_start)
        totals = window_totals(constants(self.params), self.rows, len(self.rows), start, self.t_end)
        return measures_from(self.params, totals)

    @stated(
        n=Whole(least=0, most=MOST_SAMPLES, optional=True),
        times=Numbers(most=MOST_SAMPLES, optional=True),
        per_period=Whole(most=MOST_SAMPLES, optional=True),
    )
    def sample(
        self,
        n: int | None = None,
        *,
        times: npt.ArrayLike | None = None,
        per_period: int | None = None,
        at_events: bool = False,
    ) -> Table:
        """Return the state at chosen times, from the closed forms.

        Parameters
        ----------
        n : int, optional
            This many evenly spaced times, both ends included. If nothing is chosen, 1000.
        times : array_like, optional
            These times, in ascending order, within the run.
        per_period : int, optional
            This many times a forcing period, from the start on.
        at_events : bool
            Add two samples at each impact, merge and release, just before and just after it.

        Returns
        -------
        structured ndarray, dtype SAMPLE
            t, x1, v1, x2, v2, w, w_dot, phase [rad], stuck (0 in flight, else the wall), base (A sin phase), energies
            kinetic_1 = v1²/2, kinetic_2 = mu v2²/2, potential = (x1 - base)²/2, and since the start of the run
            base_work, damper_loss and impact_loss (merges included).

        Raises
        ------
        StateError
            If times lie outside the run, or more than one of n, times, per_period is given.
        """
        chosen = self._times(n, times, per_period)
        begins = self.rows[:, col.TIME]
        segment = np.clip(np.searchsorted(begins, chosen, side="right") - 1, 0, len(begins) - 1)
        tau = np.maximum(chosen - begins[segment], 0.0)
        before = np.zeros(len(chosen), dtype=np.bool_)
        t = chosen
        if at_events:
            first, last = self._instants()
            keep = ~np.isin(chosen, begins[first])
            t = np.concatenate([chosen[keep], np.repeat(begins[first], 2)])
            segment = np.concatenate([segment[keep], np.stack([first - 1, last], axis=1).ravel()])
            tau = np.concatenate(
                [tau[keep], np.stack([self.rows[first, col.TAU], np.zeros(len(first))], axis=1).ravel()]
            )
            before = np.concatenate([before[keep], np.tile([True, False], len(first))])
            order = np.lexsort((tau, segment, t))
            t, segment, tau, before = t[order], segment[order], tau[order], before[order]
        return self._fill(t, segment, tau, before)

    def _instants(self) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Return the rows of the events before and after each of which a sample is taken, here one by one."""
        kinds = self.rows[:, col.KIND]
        events = np.flatnonzero((kinds >= col.IMPACT) & (kinds <= col.RELEASE))
        return events, events

    def _times(self, n: int | None, times: npt.ArrayLike | None, per_period: int | None) -> npt.NDArray[np.float64]:
        if sum(choice is not None for choice in (n, times, per_period)) > 1:
            raise StateError("more than one of n, times and per_period is given; choose one")
        if times is not None:
            chosen = np.atleast_1d(np.asarray(times, dtype=np.float64))
            slack = 1e-12 * max(1.0, abs(self.t_end), abs(self.t_start))
            inside = np.all(np.isfinite(chosen)) and np.all(np.diff(chosen) >= 0)
            if not inside or np.any(chosen < self.t_start - slack) or np.any(chosen > self.t_end + slack):
                raise StateError(f"times must ascend and lie between {self.t_start:g} and {self.t_end:g}")
            return chosen
        if per_period is not None:
            step = self.params.period / per_period
            count = int(np.floor((self.t_end - self.t_start) / step * (1 + 1e-14))) + 1
            return np.minimum(self.t_start + step * np.arange(count), self.t_end)
        return np.linspace(self.t_start, self.t_end, 1000 if n is None else n)

    def _fill(
        self,
        t: npt.NDArray[np.float64],
        segment: npt.NDArray[np.int64],
        tau: npt.NDArray[np.float64],
        before: npt.NDArray[np.bool_],
    ) -> Table:
        c = constants(self.params)
        raw = np.empty((len(t), 9))
        sample_rows(c, self.rows, self._totals, segment, tau, before, raw)
        out = np.empty(len(t), dtype=SAMPLE)
        out["t"] = t
        for k, name in enumerate((*START_NAMES, "stuck", *_ENERGIES.gained, *_ENERGIES.lost)):
            out[name] = raw[:, k]
        out["w"] = out["x1"] - out["x2"]
        out["w_dot"] = out["v1"] - out["v2"]
        p = self.params
        room = room_of(p)
        out["base"] = room.base(p, out["phase"])
        out["kinetic_1"], out["kinetic_2"], out["potential"] = room.stored(p, out)
        return out

    @cached_property
    def _totals(self) -> npt.NDArray[np.float64]:
        return accumulate(constants(self.params), self.rows)
