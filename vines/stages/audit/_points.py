"""The physics of stored points: balances of the recorded window, and the impacts of periodic attractors."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vines.stages.audit._defect import Defect, model_defects, relative, words
from vines.stages.audit._rows import Floats, Rows

__all__ = ["attractor_defects", "point_defects"]

_MEASURES = (
    *("kinetic_1", "kinetic_2", "max_abs_x1", "rms_x1", "duration", "base_work", "damper_loss"),
    *("impact_loss_left", "impact_loss_right", "energy_change"),
)


def point_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``points``."""
    done = rows.text("status") == "ok"
    yield from model_defects(rows, done)

    def where(values: Floats) -> Floats:
        return np.where(done, values, np.nan)

    missing = np.any([~np.isfinite(rows[name]) for name in _MEASURES], axis=0)
    yield Defect("measures", "there in every row whose status is ok", 0.0, where(np.where(missing, np.inf, 0.0)))
    yield Defect("word", "word, name, n, m and p agree", 0.0, where(words(rows)))
    yield Defect("states", "|w| <= 1 at start and end, phases in [0, 2 pi)", 1e-9, where(_states(rows)))
    work, damper, change = rows["base_work"], rows["damper_loss"], rows["energy_change"]
    lost = rows["impact_loss_left"] + rows["impact_loss_right"]
    scale = np.max([np.abs(work), np.abs(damper), np.abs(lost), np.abs(change)], axis=0)
    yield Defect(
        "energy balance",
        "base_work = damper_loss + impact losses + energy_change",
        1e-9,
        where(relative(work, damper + lost + change, scale)),
    )
    negative = np.min([damper, rows["impact_loss_left"], rows["impact_loss_right"]], axis=0) < -1e-12 * scale
    yield Defect("losses", "never negative", 0.0, where(np.where(negative, np.inf, 0.0)))
    ratio = np.where(
        rows["kinetic_1"] > 0, rows["kinetic_2"] / np.where(rows["kinetic_1"] > 0, rows["kinetic_1"], 1), 0
    )
    ratio = np.where(rows["kinetic_1"] > 0, relative(rows["kinetic_ratio"], ratio), np.nan)
    yield Defect("kinetic energies", "kinetic_ratio = kinetic_2/kinetic_1", 1e-12, where(ratio))
    above = np.where(rows["rms_x1"] > rows["max_abs_x1"] * (1 + 1e-12), np.inf, 0.0)
    yield Defect("displacements", "rms_x1 <= max_abs_x1", 0.0, where(above))
    yield from _window(rows, done)


def _states(rows: Rows) -> Floats:
    beyond = np.zeros(len(rows))
    for end in ("", "end_"):
        beyond = np.maximum(beyond, np.abs(rows[f"{end}x1"] - rows[f"{end}x2"]) - 1)
        phase = rows[f"{end}phase"]
        beyond = np.where((phase >= 0) & (phase < 2 * np.pi + 1e-12), beyond, np.inf)
    return beyond


def _window(rows: Rows, done: np.ndarray) -> Iterator[Defect]:
    """Yield the checks of the length of the record and the counts over it."""
    T = 2 * np.pi / rows["Omega"]
    periods = np.where(np.isnan(rows["p"]), rows["record_periods"], rows["p"])
    yield Defect(
        "window",
        "pT long for a periodic attractor, else as long as the record",
        1e-9,
        np.where(done, relative(rows["duration"], periods * T), np.nan),
    )
    impacts = (rows["impacts_left"] + rows["impacts_right"]) * T / rows["duration"]
    yield Defect(
        "impacts per period",
        "impacts on both ends over the window",
        1e-9,
        np.where(done, relative(rows["impacts_per_period"], impacts), np.nan),
    )
    settled = done & (rows["settled"] == 1)
    periodic = settled & (rows.text("regime") == "periodic")
    exponent = rows["lyapunov"]
    sign = np.where(periodic & (exponent > 0), exponent, 0.0)
    sign = np.where(settled & (rows.text("regime") == "chaotic") & (exponent <= 0), np.inf, sign)
    # on an attractor that has just lost its stability the exponent of the orbit is still within this of zero
    yield Defect(
        "lyapunov exponent",
        "not positive for a periodic attractor, positive for a chaotic one",
        1e-6,
        np.where(settled & np.isfinite(exponent), sign, np.nan),
    )


def attractor_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``attractors``."""
    known = np.isfinite(rows["max_abs_x1"])
    yield from model_defects(rows, known)
    gap = np.abs(rows["end_x1"] - rows["end_x2"]) - 1
    yield Defect("states", "|w| <= 1 at the end", 1e-9, np.where(known, np.maximum(gap, 0.0), np.nan))
    yield from share_defects(rows)
    above = np.where(rows["rms_x1"] > rows["max_abs_x1"] * (1 + 1e-12), np.inf, 0.0)
    yield Defect("displacements", "rms_x1 <= max_abs_x1", 0.0, np.where(known, above, np.nan))


def share_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the check of the shares of attractors."""
    share = rows["fraction"]
    outside = np.where((share >= -1e-12) & (share <= 1 + 1e-12), 0.0, np.inf)
    yield Defect("shares", "between 0 and 1", 0.0, np.where(np.isnan(share), np.nan, outside))
