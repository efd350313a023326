"""From the logs of runs to their curves as a figure shows them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from vines.figures import RunCurves
from vines.logs import read
from vines.pipeline import Input
from vines.stages.plots._caption import listed

__all__ = ["run_curves"]


def run_curves(stages: Iterable[Input]) -> list[RunCurves]:
    """Return the runs that stages of kind ``trajectory`` logged, named by the parameters that they do not share.

    Time is counted in forcing periods from the start of each log.
    """
    logs = [read(path) for stage in stages for path in stage.logs.values()]
    curves = []
    for log in logs:
        period = 2 * math.pi / log.parameters["Omega"]
        state, hit = ({name: rows[name].to_numpy() for name in rows.column_names} for rows in (log.states, log.impacts))
        begin = state["t"][0]
        own = {k: v for k, v in log.parameters.items() if any(other.parameters[k] != v for other in logs)}
        curves.append(
            RunCurves(
                t=(state["t"] - begin) / period,
                x1=state["x1"],
                x2=state["x2"],
                w=state["w"],
                w_dot=state["w_dot"],
                hit_t=(hit["t"] - begin) / period,
                hit_side=hit["side"],
                hit_x2=hit["x2"],
                hit_w_dot=hit["w_dot"],
                label=listed(own),
            )
        )
    return curves
