"""Rows of the tables ``comparisons`` and ``rig_cycles``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from vines.model import Word
from vines.rig.recording import Uncertain
from vines.rig.verdict import Calibration, Comparison, Likeness, word_of

__all__ = ["comparison_rows", "cycle_rows", "row_id"]

_BINS = (12, 48)
"""Fewest and most bins of a histogram; between them as many as keep the counts of a run's impacts above their noise."""
_MEASURES = ("phase", "max_abs_x1", "kinetic_ratio")


def comparison_rows(found: Comparison, calibration: Calibration | None = None) -> list[dict[str, Any]]:
    """Return the rows of a comparison in ``comparisons``: one a branch, the nearest first; one if there is none.

    Parameters
    ----------
    found : Comparison
    calibration : Calibration, optional
        That of a comparison at calibrated parameters.
    """
    run = found.run
    head: dict[str, Any] = {
        "run_id": run.run.run_id,
        "protocol": run.run.protocol,
        "basis": found.basis,
        **found.params.as_dict(),
        "pattern": run.pattern.name,
        "accepted": run.accepted,
        "verdict": found.verdict,
        "reason": found.reason,
    }
    if calibration is not None:
        head |= {
            "calibrated_Omega": calibration.Omega,
            "calibrated_A": calibration.A,
            "calibrated_r": calibration.r,
            "calibrated_on": " ".join(calibration.runs),
        }
    if not found.branches:
        return [{**head, "point_id": row_id(run.run.run_id, found.basis, 0), "rank": 0}]
    return [
        {**head, "point_id": row_id(run.run.run_id, found.basis, rank), "rank": rank, **_branch(found, one)}
        for rank, one in enumerate(found.branches)
    ]


def row_id(run_id: str, basis: str, rank: int) -> str:
    """Return what names a row of ``comparisons``.

    Examples
    --------
    >>> row_id("01_up", "measured", 0)
    '01_up/measured/0'
    """
    return f"{run_id}/{basis}/{rank}"


def _branch(found: Comparison, one: Likeness) -> dict[str, Any]:
    candidate, predicted = one.predicted.candidate, one.predicted
    row: dict[str, Any] = {
        "branch": candidate.name,
        "word": candidate.word or None,
        "regime": candidate.regime,
        "stable": candidate.stable,
        "source": candidate.source,
        "branch_id": candidate.branch_id or None,
        "orbit_id": candidate.orbit.orbit_id if candidate.orbit is not None else None,
        "symmetric": candidate.orbit.symmetric if candidate.orbit is not None else None,
        "mirrored": _mirrored(found, candidate.word),
        "matches": one.matches,
        "holding": _number(predicted.holding),
        "periodic": _number(predicted.periodic),
        "fraction": _number(predicted.fraction.value),
        "u_fraction": _number(predicted.fraction.u),
        "rms_w": _number(one.rms_w),
        "rms_w_dot": _number(one.rms_w_dot),
    }
    for name in _MEASURES:
        row[f"E_n_{name}"] = _number(one.errors.get(name))
        for of, values in (("", one.measured), ("model_", one.model)):
            value = values.get(name, Uncertain(math.nan, math.nan))
            turned = value.value
            if name == "phase":  # phases are counted from where periods are cut
                turned = (turned + found.run.periods.cut) % (2 * math.pi)
            row[f"{of}{name}"], row[f"u_{of}{name}"] = _number(turned), _number(value.u)
    return row


def _mirrored(found: Comparison, word: str) -> bool | None:
    """Return whether a branch is the mirror image of what the run shows; None where that says nothing."""
    if not word or not found.run.pattern.holds:
        return None
    shown, one = word_of(found.run.pattern.word), Word(word)
    if str(one) not in (str(shown), str(shown.mirror)):
        return None
    return str(one) != str(shown)


def cycle_rows(found: Comparison) -> list[dict[str, Any]]:
    """Return the rows of a comparison in ``rig_cycles``: one for each branch that shows the pattern of the run."""
    run = found.run
    if run.slots is None:
        return []
    period = 2 * math.pi / run.track.motion.omega
    waits = np.diff(run.impacts["t"]) / period
    rows = []
    for rank, one in enumerate(found.branches):
        model = one.predicted.cycle
        if not len(model[0]) or len(model[0]) != len(one.cycle[0]):
            continue
        count = len(model[0])
        edges = _edges(waits, one.predicted.gaps)
        rows.append(
            {
                "point_id": row_id(run.run.run_id, found.basis, rank),
                "run_id": run.run.run_id,
                "basis": found.basis,
                "rank": rank,
                "branch": one.predicted.candidate.name,
                "p": run.pattern.p,
                "time": (np.arange(count) + 0.5) / count * run.pattern.p,
                "w": one.cycle[0],
                "w_dot": one.cycle[1],
                "model_w": model[0],
                "model_w_dot": model[1],
                "wait_edges": edges,
                "wait_share": np.histogram(waits, edges)[0] / len(waits),
                "model_wait_share": np.histogram(one.predicted.gaps, edges)[0] / max(len(one.predicted.gaps), 1),
            }
        )
    return rows


def _edges(measured: np.ndarray, model: np.ndarray) -> np.ndarray:
    """Return the edges of a histogram that shows all but the rarest waits of both."""
    both = np.concatenate([measured, model])
    low, high = np.quantile(both, [0.001, 0.999])
    margin = max(0.05 * (high - low), 1e-3)
    bins = round(min(max(1.5 * math.sqrt(len(measured)), _BINS[0]), _BINS[1]))
    return np.linspace(max(low - margin, 0.0), high + margin, bins + 1)


def _number(value: float | None) -> float | None:
    """Return a number, or None where there is none: empty in the table."""
    return value if value is not None and math.isfinite(value) else None
