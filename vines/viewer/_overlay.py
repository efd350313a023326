"""Runs laid over each other: the curves of all of them in the same views, at the same phase of the forcing.

A run of several balls shows the gap of each in a view of its own, over half the length of its cavity; a run of one ball
laid over it is its ball 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from vines.errors import ViewerError
from vines.logs import Log
from vines.viewer._balls import half_of
from vines.viewer._clock import CYCLE, Clock, ticks
from vines.viewer._drawn import Drawn
from vines.viewer._layout import FPS, Shown, cavity_views
from vines.viewer._style import GRID, OVERLAID, PLANE

__all__ = ["check_overlay", "overlaid", "send_overlay"]

_ROOT = "/overlay"
_CURVES = {
    "w": "Gap w = x1 − x2: +1 is an impact on L, −1 on R",
    "w_dot": "Rate of the gap w'",
    "x1": "Displacement of the mass x1",
    "x2": "Displacement of the ball x2",
}
_HEIGHT = 1.15
"""Height at which the largest ``|w'|`` of all runs is drawn over w."""
_DARK = [13, 17, 23]
_LEGEND = 0.25


def check_overlay(logs: Sequence[Log]) -> None:
    """Refuse runs that cannot be laid over each other.

    Raises
    ------
    ViewerError
        If there are fewer than two or more than there are colours, one is not of the model's quantities, or their
        forcing differs, so that their phases run apart.
    """
    if not 2 <= len(logs) <= len(OVERLAID):
        raise ViewerError(f"--overlay lays 2 to {len(OVERLAID)} runs over each other, {len(logs)} were named")
    for log in logs:
        if log.kind == "rig":
            raise ViewerError(
                f"{log.name} is what sensors measured; its reconstructed run is in the stage of kind compare"
            )
    pace = [log.parameters.get("Omega") for log in logs]
    if len(set(pace)) > 1:
        raise ViewerError(f"Omega is {' and '.join(map(str, pace))}; runs laid over each other need one and the same")


def send_overlay(rec: rr.RecordingStream, runs: Sequence[Drawn], states: Sequence[dict[str, np.ndarray]]) -> None:
    """Send the curves of all runs, and w' over w.

    Parameters
    ----------
    rec : rerun.RecordingStream
        Where they go.
    runs : sequence of Drawn
        The runs.
    states : sequence of dict of str to numpy.ndarray, shape (n,)
        Columns of their ``vines.v1.State``, n > 0.
    """
    logs = [run.log for run in runs]
    gaps = [_gaps(log, own) for log, own in zip(logs, states, strict=True)]
    several = any(log.balls for log in logs)
    largest = max(float(np.abs(w_dot).max()) for each in gaps for _, w_dot in each.values()) or 1.0
    plane = f"{_ROOT}/plane/up"
    rec.log(plane, rr.Transform3D(scale=[1.0, -1.0, 1.0]), static=True)
    walls = [[(w, -_HEIGHT), (w, _HEIGHT)] for w in (-1.0, 1.0)]
    rec.log(f"{plane}/walls", rr.LineStrips2D(walls, radii=rr.Radius.ui_points(0.8), colors=GRID), static=True)
    for k, (log, own) in enumerate(zip(logs, states, strict=True)):
        clock = Clock(float(own["t"][0]), float(own["phase"][0]), log.parameters.get("Omega", 1.0))
        width, colour = (3.6 if k == 0 else 1.3), OVERLAID[k]
        drawn = {f"w_{ball}": w for ball, (w, _) in gaps[k].items()} | {"x1": own["x1"]}
        for name, values in (drawn if several else {name: own[name] for name in _CURVES}).items():
            path = f"{_ROOT}/{name}/run_{k}"
            rec.log(path, rr.SeriesLines(colors=colour, widths=width, names=log.name), static=True)
            rec.send_columns(path, indexes=clock.columns(own["t"]), columns=rr.Scalars.columns(scalars=values))
        paths = [np.column_stack([w, w_dot * (_HEIGHT / largest)]) for w, w_dot in gaps[k].values()]
        loops = [path[part] for path in paths for part in runs[k].parts]
        style = {"radii": rr.Radius.ui_points(width / 2), "colors": colour, "draw_order": 10.0 + k}
        rec.log(f"{plane}/run_{k}", rr.LineStrips2D(loops, **style), static=True)


def _gaps(log: Log, states: dict[str, np.ndarray]) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Return of each ball its gap over half the length of its cavity, and the rate of the gap."""
    if not log.balls:
        return {1: (states["w"], states["w_dot"])}
    tables = {ball: (table["w"].to_numpy(), table["w_dot"].to_numpy()) for ball, table in log.balls.items()}
    return {ball: (w / half_of(log, ball), w_dot) for ball, (w, w_dot) in tables.items()}


def overlaid(runs: Sequence[Shown], *, still: bool = False) -> rrb.Blueprint:
    """Return the layout of runs that are laid over each other.

    Parameters
    ----------
    runs : sequence of Shown
        Two or more.
    still : bool
        For a picture that nobody can pan: curves leave room for their legends, the top bar is hidden.
    """
    start, end = min(run.first for run in runs), max(run.last for run in runs)
    boundary = rrb.TimeRangeBoundary
    last = end + _LEGEND * (end - start)
    span = (
        rrb.TimeRange(start=boundary.absolute(seq=int(ticks(start))), end=boundary.absolute(seq=int(ticks(last))))
        if still
        else rrb.TimeRange(start=boundary.infinite(), end=boundary.infinite())
    )
    balls = max(len(run.parts) for run in runs)
    titles = {f"w_{ball}": f"Gap of ball {ball}, w/β: ±1 is an impact" for ball in range(1, balls + 1)}
    shown = titles | {"x1": _CURVES["x1"]} if balls else _CURVES
    curves = [
        rrb.TimeSeriesView(
            origin=f"{_ROOT}/{name}",
            name=title,
            axis_x=rrb.TimeAxis(view_range=span),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=name == next(iter(shown))),
        )
        for name, title in shown.items()
    ]
    plane = rrb.Spatial2DView(
        origin=f"{_ROOT}/plane",
        name=f"{PLANE}: {'w/β' if balls else 'w'} across, w' up",
        background=_DARK,
        visual_bounds=rrb.VisualBounds2D(x_range=(-1.3, 1.3), y_range=(-1.35, 1.35)),
    )
    named = [replace(run, parts=tuple(f"{run.name}, {part}" for part in run.parts)) for run in runs]
    cavities = [rrb.Vertical(*cavity_views(run)) if run.several else cavity_views(run)[0] for run in named]
    heights = [max(1.0, 0.7 * len(run.parts)) for run in runs]
    abouts = rrb.Tabs(*(rrb.TextDocumentView(origin=f"{run.root}/about", name=run.name) for run in runs))
    body = rrb.Horizontal(
        rrb.Vertical(*curves),
        rrb.Vertical(plane, *cavities, abouts, row_shares=[2.2, *heights, 0.9]),
        column_shares=[3.0, 2.0],
    )
    panel = rrb.TimePanel(state="collapsed", timeline=CYCLE, fps=FPS, play_state="paused")
    parts = (body, panel, rrb.TopPanel(state="hidden")) if still else (body, panel)
    return rrb.Blueprint(*parts, collapse_panels=True)
