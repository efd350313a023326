"""What can be told of the rows of the other tables: verdicts, optima, approximations, basins."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vines.model import PARAMETER_NAMES
from vines.stages.audit._defect import Defect, model_defects, relative, words
from vines.stages.audit._rows import Floats, Rows

__all__ = [
    "atlas_defects",
    "basin_defects",
    "check_defects",
    "dimensionless_defects",
    "optimum_defects",
    "reduced_defects",
]


def atlas_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``atlas``."""
    done = rows.text("status") == "ok"
    sought, less = (
        [set((text or "").replace(",", " ").split()) for text in rows.text(name)] for name in ("words", "incomplete")
    )
    stray = np.array([not few <= all_of_them for few, all_of_them in zip(less, sought, strict=True)], dtype=bool)
    bad = stray | ~(rows["stable"] <= rows["orbits"])
    yield Defect("counts", "parts are no more than the whole", 0.0, np.where(done, np.where(bad, np.inf, 0.0), np.nan))


def dimensionless_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``dimensionless``: (6) of the paper."""
    M, omega0 = rows["mass"], rows["omega0"]
    made = {
        "k": (omega0**2 * M, "omega0^2 M"),
        "c": (rows["lam"] * M * omega0, "lam M omega0"),
        "E": (rows["A"] * rows["b"], "A b"),
        "ball_mass": (rows["mu"] * M, "mu M"),
        "forcing_frequency": (rows["Omega"] * omega0, "Omega omega0"),
    }
    for name, (value, says) in made.items():
        yield Defect(name, says, 1e-12, relative(rows[name], value))


def check_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``checks``."""
    verdict = rows.text("verdict")
    off = np.abs(rows["our_value"] - rows["published_value"])
    within = off <= rows["tolerance"] * (1 + 1e-12)
    wrong = np.where(verdict == "reproduced", ~within, (verdict == "differs") & within)
    number = np.isfinite(off) & np.isfinite(rows["tolerance"])
    yield Defect(
        "verdict",
        "reproduced where ours is within the tolerance",
        0.0,
        np.where(number, np.where(wrong, np.inf, 0.0), np.nan),
    )


def optimum_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``optima``."""
    yield from model_defects(rows, np.ones(len(rows), dtype=bool))
    yield Defect("word", "word and name agree", 0.0, words(rows))
    # lengths are in units of the cavity, so the objective of a varied cavity is b max|x1|
    reached = np.where(rows.text("objective") == "max_abs_x1", rows["b"] * rows["max_abs_x1"], rows["kinetic_ratio"])
    yield Defect("value", "that of the objective", 1e-9, relative(rows["value"], reached))
    unstable = ~(rows["max_multiplier"] <= 1 + 1e-9) | ~(rows["min_clearance"] > -1e-9)
    yield Defect("optimum", "stable and admissible", 0.0, np.where(unstable, np.inf, 0.0))


def reduced_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``reduced``."""
    done = rows.text("status") == "ok"
    yield from model_defects(rows, done)
    errors = np.zeros(len(rows))
    for name in ("max_abs_x1", "kinetic_ratio", "w_dot"):
        both = np.isfinite(rows[name]) & np.isfinite(rows[f"exact_{name}"])
        off = np.abs(rows[f"error_{name}"] - (rows[name] / rows[f"exact_{name}"] - 1))
        errors = np.maximum(errors, np.where(both, off, 0.0))
    yield Defect("errors", "those of the approximation against the exact orbit", 1e-9, np.where(done, errors, np.nan))
    yield Defect("symmetric orbit", "the quadratic equation for V in closed form", 1e-9, _closed_form(rows))
    stable = (rows["exact_stable"] == 1) == (rows["exact_max_multiplier"] < 1)
    there = rows["exact_orbits"] > 0
    yield Defect(
        "stability",
        "stable where the largest multiplier is below 1",
        0.0,
        np.where(done & there, np.where(stable, 0.0, np.inf), np.nan),
    )


def _closed_form(rows: Rows) -> Floats:
    """Return the residual of the equation of symmetric 1:1 orbits, (alpha² + beta²) V² + 2 alpha V + 1 - B² = 0."""
    mu, A, Omega, r, lam = (rows[name] for name in PARAMETER_NAMES)
    half, gamma = np.pi / Omega, np.sqrt(1 - lam**2 / 4)
    s = -lam / 2 + 1j * gamma
    q = 1 / (1 + np.exp(s * half))
    kappa = (1 + 2 * mu - r) / (1 + r)
    alpha = 2 * mu * q.imag / gamma - half / 2
    beta = (kappa + 2 * mu * ((s * q).imag / gamma - 1)) / Omega
    B2 = A**2 * (1 + (lam * Omega) ** 2) / ((1 - Omega**2) ** 2 + (lam * Omega) ** 2)
    V = rows["exact_ball_speed"]
    terms = ((alpha**2 + beta**2) * V**2, 2 * alpha * V, 1 - B2)
    return np.abs(sum(terms)) / np.max([np.abs(each) for each in terms], axis=0)


def basin_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``basins``."""
    yield from model_defects(rows, np.ones(len(rows), dtype=bool))
    yield from cell_defects(rows)


def cell_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of cells of basins of any system."""
    bad = ~(rows["weight"] > 0) | ~(rows["attractor"] >= -1) | ~(rows["periods"] >= 0)
    yield Defect("cells", "weight > 0, an attractor or -1", 0.0, np.where(bad, np.inf, 0.0))
    total = np.full(len(rows), np.nan)
    if len(rows):
        total[0] = abs(rows["weight"].sum() - 1)
    yield Defect("area", "the weights sum to 1", 1e-9, total)
