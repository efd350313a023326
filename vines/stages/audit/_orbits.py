"""The physics of stored periodic orbits: each row must be one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from vines.model import START_NAMES, STATE_NAMES
from vines.stages.audit._cycles import Cycles
from vines.stages.audit._defect import Defect, model_defects, relative, sticking, words
from vines.stages.audit._flights import Flights
from vines.stages.audit._rows import Floats, Rows

__all__ = ["orbit_cycles", "orbit_defects", "product_defect"]

_EPSILON = 1e-14
"""Error of a computed multiplier relative to the largest one, per unit of it."""
_PRODUCT = 1e-9


def orbit_cycles(rows: Rows) -> Cycles:
    """Return the orbits as rounds of flights."""
    each = np.repeat(np.arange(len(rows)), rows.lengths)
    t = rows.lists("t")
    dt = np.empty_like(t)
    dt[:-1] = t[1:] - t[:-1]
    last = np.cumsum(rows.lengths) - 1
    dt[last] = t[last - rows.lengths + 1] + _period(rows) - t[last]
    state = {name: rows.lists(name) for name in START_NAMES}
    flights = Flights.of(rows, each, {**state, "dt": dt})
    return Cycles(flights, rows.lengths)


def _period(rows: Rows) -> Floats:
    return 2 * np.pi * rows["p"] / rows["Omega"]


def orbit_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``orbits``."""
    yield from model_defects(rows, np.ones(len(rows), dtype=bool))
    yield Defect("word", "word, name, n, m and p agree", 0.0, np.where(np.isnan(d := words(rows)), np.inf, d))
    lists = ("side", *STATE_NAMES, "w_dot", "phase")
    right = (rows.lengths > 0) & (rows.lengths == rows["n"] + rows["m"])
    right &= all(len(rows.lists(name)) == int(rows.lengths.sum()) for name in lists)
    yield Defect("impacts", "n + m of them in each list", 0.0, np.where(right, 0.0, np.inf))
    yield product_defect(rows)
    yield _stability(rows)
    if not right.all():
        return
    cycles = orbit_cycles(rows)
    stuck = sticking(rows)
    for defect in (*_impacts(rows, cycles), *_energies(rows, cycles)):
        # Of chatters and sticking a row does not tell; `vines verify --recompute` runs through them.
        flown = defect.name not in ("residual", "energy balance")
        yield defect._replace(values=np.where(stuck & flown, np.nan, defect.values))


def product_defect(rows: Rows) -> Defect:
    """Return the check of the product of the multipliers against the determinant, r^(2N) exp(-lam p T)."""
    m = _multipliers(rows)
    codes, known = rows.codes("word")
    counts = [sum(word.partition("/")[0].count(letter) for letter in "LR") for word in known]
    periods = [int(word.partition("/")[2].removesuffix("T") or 1) for word in known]
    N, p = np.array(counts, dtype=float)[codes], np.array(periods, dtype=float)[codes]
    size = np.abs(m)
    log_det = 2 * N * np.log(np.maximum(rows["r"], 1e-300)) - rows["lam"] * p * 2 * np.pi / rows["Omega"]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        product = np.prod(m, axis=1) * np.exp(-log_det)
        # the small ones carry the rounding error of the largest
        slack = _EPSILON * size.max(axis=1) / size.min(axis=1)
        off = np.abs(product - 1) / (1 + slack / _PRODUCT)
    undecided = ~(slack < 1e-2) | (rows["r"] <= 0)
    says = "r^(2N) exp(-lam p T), the determinant"
    return Defect("multiplier product", says, _PRODUCT, np.where(undecided, np.nan, off))


def _multipliers(rows: Rows) -> npt.NDArray[np.complex128]:
    return (rows.lists("multipliers_re") + 1j * rows.lists("multipliers_im")).reshape(len(rows), 4)


def _stability(rows: Rows) -> Defect:
    size = np.abs(_multipliers(rows))
    largest = rows["max_multiplier"]
    wrong = relative(size.max(axis=1), largest)
    wrong = np.where(np.isinf(largest) & np.isinf(size.max(axis=1)), 0.0, wrong)
    wrong = np.where((rows["stable"] == 1) == (largest < 1), wrong, np.inf)
    return Defect("stability", "stable where the largest multiplier is below 1", 1e-12, wrong)


def _impacts(rows: Rows, cycles: Cycles) -> Iterator[Defect]:
    f, side = cycles.flights, rows.lists("side")
    yield Defect("closure", "each flight, flown afresh, meets the next impact", 1e-9, cycles.closure)
    yield Defect("residual", "below 1e-9", 1e-9, np.abs(rows["residual"]))
    gap = np.abs(f.x1 - f.x2 - side)
    speed = np.abs(f.v1 - f.v2 - rows.lists("w_dot"))
    leaving = np.where(side * (f.v1 - f.v2) >= 0, 0.0, np.inf)
    yield Defect(
        "contact",
        "w = ±1 at the impacts, met from inside; w' = v1 - v2",
        1e-12,
        cycles.most(np.max([gap, speed, leaving], axis=0)),
    )
    turn = np.abs(np.exp(1j * f.phase) - np.exp(1j * np.repeat(rows["Omega"], rows.lengths) * rows.lists("t")))
    times = np.where(f.dt > 0, turn, np.inf)
    length = relative(rows["duration"], _period(rows))
    yield Defect("times", "rising, phase = Omega t, duration = pT", 1e-9, np.maximum(cycles.most(times), length))
    admissible = (rows["admissible"] == 1) == ((rows["min_clearance"] > 0) & ~(np.abs(rows["violation_side"]) == 1))
    beyond = np.where(rows["admissible"] == 1, cycles.sums.largest_gap - 1, 0.0)
    yield Defect(
        "admissibility",
        "|w| < 1 between the impacts of admissible ones, which are those with min_clearance > 0",
        1e-9,
        np.where(admissible, np.maximum(beyond, 0.0), np.inf),
    )


def _energies(rows: Rows, cycles: Cycles) -> Iterator[Defect]:
    sums = cycles.sums
    left, right = cycles.losses(rows.lists("side"))
    work, damper = rows["base_work"], rows["damper_loss"]
    lost = damper + rows["impact_loss_left"] + rows["impact_loss_right"]
    yield Defect("energy balance", "base_work = damper_loss + impact losses", 1e-9, relative(work, lost))
    # the two sides share a scale: a loss on one side only may vanish
    both = left + right
    losses = np.maximum(
        relative(rows["impact_loss_left"], left, both), relative(rows["impact_loss_right"], right, both)
    )
    yield Defect("impact losses", "mu (1 - r^2) w'^2/(2 (1 + mu)) summed over each end", 1e-9, losses)
    scale = np.abs(lost)
    energies = np.maximum(relative(work, sums.base_work, scale), relative(damper, sums.damper_loss, scale))
    ratio = relative(rows["kinetic_ratio"], rows["mu"] * sums.v2_square / sums.v1_square)
    rms = relative(rows["rms_x1"] ** 2, sums.x1_square / _period(rows))
    values = np.max([energies, ratio, rms], axis=0)
    yield Defect("measures", "base_work, damper_loss, kinetic_ratio and rms_x1 by quadrature", 1e-8, values)
    yield Defect(
        "largest displacement", "max_abs_x1 of the flights", 1e-8, relative(rows["max_abs_x1"], sums.largest_x1)
    )
