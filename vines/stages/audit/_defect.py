"""What a check of rows gives: how far each row is from what it should be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.model import PARAMETER_NAMES, VI_NES
from vines.stages.audit._rows import Floats, Rows

__all__ = ["Defect", "forced_amplitude", "model_defects", "relative", "sticking", "words"]


class Defect(NamedTuple):
    """One check of all rows of a table.

    Attributes
    ----------
    name : str
        What is checked.
    says : str
        What should hold.
    allowed : float
        Largest defect that is still right.
    values : (n,) float array
        The defect of each row; nan where the check does not apply, inf where there is nothing to compare.
    """

    name: str
    says: str
    allowed: float
    values: Floats


def relative(a: Floats, b: Floats, *more: Floats) -> Floats:
    """Return |a - b| over the largest of |a|, |b| and what else sets the scale; 0 where all vanish."""
    scale = np.max([np.abs(each) for each in (a, b, *more)], axis=0)
    return np.divide(np.abs(a - b), scale, out=np.where(np.isnan(a - b), np.nan, 0.0), where=scale > 0)


def forced_amplitude(rows: Rows, mass: Floats | float) -> Floats:
    """Return the steady amplitude of x1 of an oscillator of this mass that nothing strikes."""
    A, Omega, lam = rows["A"], rows["Omega"], rows["lam"]
    damping = lam * Omega
    with np.errstate(divide="ignore", invalid="ignore"):
        return A * np.hypot(1.0, damping) / np.hypot(1.0 - mass * Omega**2, damping)


def model_defects(rows: Rows, where: npt.NDArray[np.bool_]) -> list[Defect]:
    """Return the checks that every table with parameters and yardsticks passes.

    Parameters
    ----------
    rows : Rows
        With the parameters of the model.
    where : (n,) bool array
        Rows that were computed.
    """
    found = []
    if rows.has(*PARAMETER_NAMES):
        outside = np.zeros(len(rows))
        for each in VI_NES.parameters:
            inside = np.isfinite(rows[each.name]) & each.allowed.holds(rows[each.name])
            outside = np.where(inside, outside, np.inf)
        allowed = ", ".join(each.allowed.of(each.name) for each in VI_NES.parameters)
        found.append(Defect("parameters", f"those of the model: {allowed}", 0.0, outside))
    if rows.has("max_abs_x1", "reduction", "A", "Omega", "lam"):
        free = forced_amplitude(rows, 1.0)
        found.append(
            Defect(
                "reduction",
                "reduction = max_abs_x1/x1_no_ball in closed form",
                1e-9,
                np.where(where & (free > 0), relative(rows["reduction"] * free, rows["max_abs_x1"]), np.nan),
            )
        )
    if rows.has("x1_no_ball", "x1_locked"):
        values = np.maximum(
            relative(rows["x1_no_ball"], forced_amplitude(rows, 1.0)),
            relative(rows["x1_locked"], forced_amplitude(rows, 1.0 + rows["mu"])),
        )
        found.append(
            Defect("yardsticks", "x1_no_ball, x1_locked in closed form", 1e-9, np.where(where, values, np.nan))
        )
    return found


def sticking(rows: Rows) -> npt.NDArray[np.bool_]:
    """Return which rows are of orbits that stick, whose contacts are joined by more than a flight."""
    codes, known = rows.codes("word")
    return np.isin(codes, [code for code, word in enumerate(known) if "*" in word])


def words(rows: Rows) -> Floats:
    """Return 0 where word, name, n, m and p say the same, 1 where they contradict each other; nan without a word."""
    codes, known = rows.codes("word")
    names, called = rows.codes("name")
    bad = np.zeros(len(rows))
    for code, word in enumerate(known):
        letters, _, period = word.partition("/")
        n, m, p = letters.count("L"), letters.count("R"), int(period.removesuffix("T") or 1)
        name = f"{n}:{m}" + (f"/{p}T" if p > 1 else "")
        mine = codes == code
        wrong = names != (called.index(name) if name in called else -2)
        for column, value in (("n", n), ("m", m), ("p", p)):
            if rows.has(column):
                wrong |= rows[column] != value
        bad[mine & wrong] = 1.0
    return np.where(codes >= 0, bad, np.nan)
