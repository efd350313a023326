"""The physics of stored bifurcations and curves: the orbit is one, and its critical multiplier where it belongs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vines.model import PARAMETER_NAMES
from vines.stages.audit._cycles import Cycles
from vines.stages.audit._defect import Defect, model_defects, relative, sticking, words
from vines.stages.audit._flights import Flights
from vines.stages.audit._orbits import product_defect
from vines.stages.audit._rows import Floats, Rows

__all__ = ["bifurcation_defects", "branch_defects", "critical_defect", "curve_defects", "curve_equations"]

_AT_ONE = ("fold", "symmetry_breaking")
_WITHOUT = ("grazing", "incomplete_chatter", "release_tangency")
"""Types at which no multiplier is critical."""

_CRITICAL = 1e-5
"""Where two multipliers meet, at a fold of a symmetric pair for instance, each is known to half the digits only."""


def bifurcation_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``bifurcations``."""
    yield from model_defects(rows, np.ones(len(rows), dtype=bool))
    yield Defect("word", "word and name agree", 0.0, words(rows))
    yield Defect("value", "that of the parameter it is found in", 1e-12, _named(rows, "parameter", "value"))
    yield critical_defect(rows)
    lists = ("side", "x1", "w_dot", "phase")
    right = (rows.lengths > 0) & all(len(rows.lists(name)) == int(rows.lengths.sum()) for name in lists)
    yield Defect("impacts", "as many in each list", 0.0, np.where(right, 0.0, np.inf))
    if right.all():
        cycles = _cycles(rows)
        stuck = sticking(rows)
        closure = np.where(stuck, np.nan, cycles.closure)
        yield Defect("closure", "each flight, flown afresh, meets the next impact", 1e-9, closure)
        beyond = np.where(stuck, np.nan, np.maximum(cycles.sums.largest_gap - 1, 0.0))
        yield Defect("admissibility", "|w| <= 1 between the impacts", 1e-9, beyond)


def _cycles(rows: Rows) -> Cycles:
    """Return the orbits at the bifurcations; the ball's speeds follow from where and when it is struck."""
    each = np.repeat(np.arange(len(rows)), rows.lengths)
    letters, known = rows.codes("word")
    periods = np.array([int(word.partition("/")[2].removesuffix("T") or 1) for word in known])[letters]
    t, side, x1, w_dot = (rows.lists(name) for name in ("t", "side", "x1", "w_dot"))
    last = np.cumsum(rows.lengths) - 1
    first = last - rows.lengths + 1
    following = np.arange(1, len(t) + 1)
    following[last] = first
    dt = t[following] - t
    dt[last] += 2 * np.pi * periods / rows["Omega"]
    x2 = x1 - side
    v2 = np.empty_like(x1)
    v2[following] = (x2[following] - x2) / dt
    state = {"x1": x1, "v1": w_dot + v2, "x2": x2, "v2": v2, "phase": rows.lists("phase"), "dt": dt}
    flights = Flights.of(rows, each, state)
    return Cycles(flights, rows.lengths)


def _named(rows: Rows, names: str, values: str) -> Floats:
    """Return how far the values are from those of the parameters that a column names."""
    codes, known = rows.codes(names)
    off = np.full(len(rows), np.inf)
    for code, name in enumerate(known):
        if name in PARAMETER_NAMES:
            off = np.where(codes == code, relative(rows[values], rows[name]), off)
    return off


def critical_defect(rows: Rows) -> Defect:
    """Return the check of the multiplier that makes an orbit of any system a bifurcation."""
    return Defect("critical multiplier", "+1, -1, on the unit circle, or real, by the type", _CRITICAL, _critical(rows))


def _critical(rows: Rows) -> Floats:
    m = rows["multiplier_re"] + 1j * rows["multiplier_im"]
    types = rows.text("type")
    off = np.full(len(rows), np.inf)
    off = np.where(np.isin(types, _AT_ONE), np.abs(m - 1), off)
    off = np.where(types == "period_doubling", np.abs(m + 1), off)
    off = np.where(types == "neimark_sacker", np.where(m.imag != 0, np.abs(np.abs(m) - 1), np.inf), off)
    off = np.where(types == "pair_turns_real", np.abs(m.imag), off)
    return np.where(np.isin(types, _WITHOUT), np.nan, off)


def curve_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``curves``."""
    yield from model_defects(rows, np.ones(len(rows), dtype=bool))
    yield Defect("word", "word and name agree", 0.0, words(rows))
    yield product_defect(rows)
    yield from curve_equations(rows)


def curve_equations(rows: Rows) -> Iterator[Defect]:
    """Yield those of them that hold for curves of any system."""
    yield Defect("residual", "below 1e-9", 1e-9, np.abs(rows["residual"]))
    m = (rows.lists("multipliers_re") + 1j * rows.lists("multipliers_im")).reshape(len(rows), -1)
    types = rows.text("type")
    off = np.full(len(rows), np.inf)
    # what is stored belongs to the whole period; the others are as exact as the largest one lets them be
    slack = np.maximum(1.0, np.abs(m).max(axis=1))
    off = np.where(np.isin(types, _AT_ONE), np.abs(m - 1).min(axis=1), off)
    off = np.where(types == "period_doubling", np.abs(m + 1).min(axis=1), off)
    i, j = np.triu_indices(m.shape[1], 1)
    off = np.where(types == "neimark_sacker", np.abs(m[:, i] * m[:, j] - 1).min(axis=1), off)
    off = np.where(np.isin(types, _WITHOUT), np.nan, off) / slack
    yield Defect("critical multiplier", "+1, -1, or a pair of product 1, by the type", _CRITICAL, off)
    inside = rows["min_clearance"] >= -1e-9
    if rows.has("walls"):
        inside |= rows["walls"] == 0
    wrong = (rows["admissible"] == 1) & ~inside
    yield Defect("admissibility", "no turning point beyond a wall", 0.0, np.where(wrong, np.inf, 0.0))


def branch_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``branches``."""
    yield from model_defects(rows, np.ones(len(rows), dtype=bool))
    yield Defect("word", "word and name agree", 0.0, words(rows))
    yield Defect("from", "the parameter of the first orbit", 1e-12, _named(rows, "parameter", "from"))
    yield Defect("orbits", "one at least", 0.0, np.where(rows["orbits"] >= 1, 0.0, np.inf))
