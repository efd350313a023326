"""From the logs of runs to their curves as a figure shows them."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import pyarrow as pa

from vines.figures import RunCurves
from vines.logs import Log, read
from vines.model import with_one_ball
from vines.pipeline import Input
from vines.stages.plots._caption import listed

__all__ = ["run_curves"]


def run_curves(stages: Iterable[Input]) -> list[RunCurves]:
    """Return the runs that stages of kind ``trajectory`` logged, named by the parameters that they do not share.

    Time is counted in forcing periods from the start of each log. Of several balls there is one for each.
    """
    logs = [read(path) for stage in stages for path in stage.logs.values()]
    curves = []
    for log in logs:
        # of a system without a frequency time is the phase
        period = 2 * math.pi / log.parameters.get("Omega", 1.0)
        state, hit = _columns(log.states), _columns(log.impacts)
        begin = state["t"][0]
        body = "ball" if log.balls else _body(log)
        ends = "barriers" if "walls" in log.parameters else "cavity ends"
        own = {k: v for k, v in log.parameters.items() if any(other.parameters.get(k) != v for other in logs)}
        for number, ball in ({k: _columns(rows) for k, rows in log.balls.items()} or {0: state}).items():
            mine = hit["ball"] == number if number else np.ones(len(hit["t"]), dtype=bool)
            called = f"ball {number}" if number else ""
            curves.append(
                RunCurves(
                    t=(state["t"] - begin) / period,
                    x1=state["x1"],
                    x2=ball["x2"],
                    w=ball["w"],
                    w_dot=ball["w_dot"],
                    hit_t=(hit["t"][mine] - begin) / period,
                    hit_side=hit["side"][mine],
                    hit_x2=hit["x2"][mine],
                    hit_w_dot=hit["w_dot"][mine],
                    label=",  ".join(filter(None, (called, listed(own)))),
                    length=log.parameters.get(f"beta_{number}", 1.0),
                    ball=number,
                    stops=_stops(log, begin) / period,
                    body=body,
                    ends=ends,
                    walls=log.parameters.get("walls", 1.0) != 0.0,
                )
            )
    return curves


def _body(log: Log) -> str:
    """Return what the body between the walls is called."""
    return with_one_ball(log.system).between_walls


def _stops(log: Log, begin: float) -> np.ndarray:
    """Return begin and end of each stop in mid-cavity after the begin of a log, shape (n, 2); its end if it lasts."""
    rows = _columns(log.sticks)
    spells = np.column_stack([rows["t_start"], rows["t_release"]])[rows["side"] == 0]
    return np.where(np.isnan(spells), log.states["t"][-1].as_py(), spells) - begin


def _columns(rows: pa.Table) -> dict[str, np.ndarray]:
    return {name: rows[name].to_numpy() for name in rows.column_names}
