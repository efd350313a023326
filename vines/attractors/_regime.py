"""Regimes that noise may make a run leave: attractors with the patterns of impacts that they show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._attractor import Attractor
from vines.attractors._exit_watch import codes_block, places_block
from vines.dynamics import Scatter, simulate
from vines.dynamics.kernels import room_of
from vines.dynamics.runs import EVENTS_PER_PERIOD

__all__ = ["Regime", "begun", "centres_of", "named_states"]

Floats = npt.NDArray[np.float64]

CUTS = 64
"""Phases at which periods may begin, of which the patterns count as those of a regime: noise shifts impacts."""

IRREGULAR = ("chaotic", "quasiperiodic", "unsettled")


@dataclass(frozen=True)
class Regime:
    """An attractor as exits know it.

    Attributes
    ----------
    attractor : Attractor
        What it is.
    start : ndarray, shape (5,)
        x1, v1, x2, v2 of the kernels and the phase, where watched periods begin: half-way between two contacts.
    codes : ndarray of int
        Codes of the patterns of its periods; empty where it has none that recurs.
    """

    attractor: Attractor
    start: Floats
    codes: npt.NDArray[np.int64]

    @property
    def irregular(self) -> bool:
        """Whether no pattern recurs."""
        return self.attractor.regime in IRREGULAR

    @classmethod
    def of(cls, attractor: Attractor) -> Regime:
        """Return the regime of an attractor."""
        p, room = attractor.params, room_of(attractor.params)
        end = {name: attractor.final[name] for name in (*(each.name for each in p.system.state), "phase")}
        phase = end.pop("phase")
        last = np.array([*room.enter(p, end, phase), phase])
        if attractor.regime in IRREGULAR:
            return cls(attractor, last, np.empty(0, dtype=np.int64))
        span = attractor.p or 1
        at: dict[str, Any] = end
        hits = simulate(p, phi=phase, periods=span, **at).impacts["t"] / p.period
        cuts = np.array([k / CUTS for k in range(CUTS)])
        starts = _later(p, np.tile(last, (CUTS, 1)), cuts)
        found = [_codes(p, starts, span, mirrored) for mirrored in ([False, True] if p.mirrored else [False])]
        start = _later(p, last[None], np.array([_quiet(hits)]))[0]
        return cls(attractor, start, np.unique(np.concatenate(found)))


def centres_of(regime: Regime) -> Floats:
    """Return where a periodic regime, and its mirror image if it is another motion, is at the begin of its periods."""
    attractor, p = regime.attractor, regime.attractor.params
    own = _later(p, np.tile(regime.start, (attractor.p or 1, 1)), np.arange(attractor.p or 1, dtype=float))[:, :4]
    if attractor.symmetric or not p.mirrored:
        return own
    half = np.array([k + 0.5 for k in range(attractor.p or 1)])
    return np.concatenate([own, -_later(p, np.tile(regime.start, (len(half), 1)), half)[:, :4]])


def begun(p: Any, places: Floats) -> Floats:
    """Return runs that begin at time 0 at some places, as kernels hold them, shape (n, STATE)."""
    room = room_of(p)
    c, layout = room.constants(list(p.as_dict().values())), room.layout(p)
    states = np.zeros((len(places), layout.state))
    for state, (x1, v1, x2, v2, phase) in zip(states, places[:, :5].tolist(), strict=True):
        room.begin(c, state, x1, v1, x2, v2, phase, 0.0)
    return states


def named_states(p: Any, places: Floats) -> dict[str, Floats]:
    """Return places by the names of the system, and the phase."""
    room = room_of(p)
    named = [room.leave(p, place[:4], place[4]) | {"phase": place[4]} for place in places.tolist()]
    return {name: np.array([each[name] for each in named]) for name in named[0]}


def _undisturbed(p: Any, count: int) -> tuple[Any, Floats]:
    values = np.tile(p.as_array(), (count, 1))
    return room_of(p).scattered(values, Scatter(), np.zeros(count, dtype=np.int64))


def _later(p: Any, places: Floats, periods: Floats) -> Floats:
    """Return where runs without noise are after so many forcing periods."""
    out = np.empty((len(places), 6))
    table, _room = _undisturbed(p, len(places))
    places_block(table, begun(p, places), periods, EVENTS_PER_PERIOD, out)
    return out[:, :5]


def _codes(p: Any, places: Floats, periods: int, mirrored: bool) -> npt.NDArray[np.int64]:
    codes = np.empty((len(places), periods), dtype=np.int64)
    table, _room = _undisturbed(p, len(places))
    codes_block(table, begun(p, places), periods, EVENTS_PER_PERIOD, mirrored, codes)
    return codes.ravel()


def _quiet(times: Floats) -> float:
    """Return the part of a period, in [0, 1), that is farthest from all of these times modulo 1.

    Examples
    --------
    >>> _quiet(np.array([0.1, 0.2, 1.15]))
    0.65
    """
    if not len(times):
        return 0.0
    folded = np.sort(times % 1.0)
    gaps = np.diff(folded, append=folded[0] + 1.0)
    k = int(np.argmax(gaps))
    return float(round((folded[k] + 0.5 * gaps[k]) % 1.0, 9))
