"""From what the science returns to rows of the tables ``points`` and ``impacts``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vines.dynamics import ball_locked, no_ball
from vines.model import STATE_NAMES, Word

if TYPE_CHECKING:
    from vines.attractors import Attractor
    from vines.model import Params

__all__ = ["impact_rows", "measured_outline", "measured_row", "outline", "point_row"]


def point_row(
    point_id: str,
    attractor: Attractor,
    start: dict[str, float],
    *,
    carry: str | None,
    before: float,
    seed: int | None = None,
) -> dict[str, Any]:
    """Return the row of ``points`` for one simulated point.

    Parameters
    ----------
    point_id : str
        Id of the point.
    attractor : Attractor
        What the simulation settled to.
    start : dict
        Start state of the whole run: x1, v1, x2, v2 and forcing phase [rad].
    carry : str or None
        The carried axis, if the start was the end of another point.
    before : float
        Forcing periods that were run before the attractor was settled for.
    seed : int, optional
        With which the start was drawn, if it was.
    """
    p = attractor.params
    return {
        **outline(attractor),
        **measured_row(point_id, attractor, start, carry=carry, before=before, seed=seed),
        "x1_no_ball": no_ball(p),
        "x1_locked": ball_locked(p),
    }


def measured_row(
    point_id: str,
    attractor: Attractor,
    start: dict[str, float],
    *,
    carry: str | None,
    before: float,
    seed: int | None = None,
) -> dict[str, Any]:
    """Return what the points of every system tell beside `measured_outline`; arguments as of `point_row`."""
    m = attractor.measures
    return {
        "point_id": point_id,
        **attractor.params.as_dict(),
        "carry": carry,
        "seed": seed,
        **start,
        "settle_periods": before + attractor.transient,
        "record_periods": attractor.recorded,
        "settled": attractor.settled,
        "remaining": attractor.remaining,
        "watched": attractor.watched,
        "escape_rate": attractor.escape_rate if attractor.regime == "chaotic" else None,
        "kinetic_ratio_error": attractor.kinetic_ratio_error,
        "kinetic_1": m.kinetic_1,
        "kinetic_2": m.kinetic_2,
        "max_abs_x1_error": attractor.max_abs_x1_error,
        "rms_x1_error": attractor.rms_x1_error,
        "impacts_left": m.impacts_left,
        "impacts_right": m.impacts_right,
        "sticking_share": attractor.sticking_share,
        "recurrent_sticking": attractor.recurrent_sticking,
        "lyapunov": attractor.lyapunov,
        "lyapunov_error": attractor.lyapunov_error,
        "duration": m.duration,
        "base_work": m.base_work,
        "damper_loss": m.damper_loss,
        "impact_loss_left": m.impact_loss_left,
        "impact_loss_right": m.impact_loss_right,
        "energy_change": m.energy_change,
        "status": "ok" if attractor.status == "complete" else attractor.status,
        "reason": attractor.reason,
    }


def outline(attractor: Attractor) -> dict[str, Any]:
    """Return what every table of attractors tells of one: name, word, measures, where it ended."""
    yardstick = no_ball(attractor.params)
    largest = attractor.measures.max_abs_x1
    return {**measured_outline(attractor), "reduction": largest / yardstick if yardstick > 0 else None}


def measured_outline(attractor: Attractor) -> dict[str, Any]:
    """Return what tables of attractors of every system tell of one."""
    m = attractor.measures
    return {
        "regime": attractor.regime,
        "name": attractor.name,
        "alias": Word(attractor.word).alias if attractor.word else None,
        "word": attractor.word,
        "n": attractor.n,
        "m": attractor.m,
        "p": attractor.p,
        "symmetric": attractor.symmetric,
        "kinetic_ratio": m.kinetic_ratio,
        "max_abs_x1": m.max_abs_x1,
        "rms_x1": m.rms_x1,
        "impacts_per_period": m.impacts_per_period,
        "sticks_per_period": m.sticks_per_period,
        **{f"end_{name}": value for name, value in attractor.final.items() if name != "t"},
    }


def impact_rows(point_id: str, params: Params, impacts: np.ndarray, number: int = 0) -> dict[str, Any]:
    """Return columns of ``impacts`` for a run of impacts; the last one has no successor and is left out.

    Parameters
    ----------
    point_id : str
        Id of the point.
    params : Params
        Its parameters, repeated in each row so that the table answers alone.
    impacts : (n + 1,) structured array
        As :attr:`Trajectory.impacts`.
    number : int
        Number of the attractor at the point.
    """
    n = max(len(impacts) - 1, 0)
    kept = impacts[:n]
    columns: dict[str, Any] = {"point_id": np.full(n, point_id, dtype=object)}
    columns |= {name: np.full(n, value) for name, value in params.as_dict().items()}
    columns["attractor"] = np.full(n, number, dtype=np.int64)
    columns["index"] = np.arange(n, dtype=np.int64)
    for name in ("t", "side", "phase", *STATE_NAMES, "w_dot", "v1_after", "v2_after"):
        columns[name] = kept[name]
    columns["dt_next"] = np.diff(impacts["t"]) if n else np.empty(0)
    return columns
