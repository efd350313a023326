"""The blueprint: which views there are and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import rerun.blueprint as rrb
from rerun.blueprint.encodings import TimelineColumn

from vines.viewer._balls import lanes_range, track
from vines.viewer._called import Called
from vines.viewer._clock import CYCLE, IMPACT, SIM_TIME, ticks
from vines.viewer._impacts import DIAL_BOUNDS, LANES
from vines.viewer._scene import PHASE_BOUNDS, cavity_bounds
from vines.viewer._style import PARAMETERS, PLANE

__all__ = ["FPS", "Shown", "blueprint", "cavity_views", "following"]

_WINDOW = 20
"""Forcing cycles up to which curves show a whole run; longer runs scroll with the time cursor."""
_LATEST = 10
"""Forcing cycles that curves of a run show that goes on."""
_BEFORE = 0.05
"""Part of the span of such curves that is before the cursor: the viewer opens with the cursor on the first state."""
_BEFORE_STILL = 0.6
"""The same in a picture, whose cursor is in the middle of the run."""
FPS = 320.0
"""Thousandths of a forcing cycle that pass in a second where it plays."""
_ABREAST = 3
"""Runs side by side from which on the titles have to be short."""
_TRAIL = 0.25
"""Length of the trail in the phase plane, in forcing cycles."""
_BRIEF = {"w": "Gap w", "w_dot": "Rate w'", "lanes": "Impacts L, R", "balance": "Balance"}
"""Titles of curves where there is little room."""
_LEGEND = 0.4
"""Room that a still picture leaves for a legend, as a part of the run."""
_STACKED = 3
"""Tracks, and curves of a rig, that fit above each other."""
_LOW = 0.3
"""Room below the ruler in a low view of a cavity, b."""
_NARROW = 0.4
"""Room beside the ends of a narrow phase plane, for what is written there."""
_DARK = [13, 17, 23]


@dataclass(frozen=True)
class Shown:
    """What the layout must know of a run.

    Attributes
    ----------
    root : str
        Path of its entities, such as ``"/run"``.
    name : str
        What it is called.
    start, end : float
        First and last time, 1/omega0; of a rig in seconds.
    first, last : float
        The same in forcing cycles.
    period : float
        Forcing period, 1/omega0.
    reach : float
        Largest displacement of the mass, b.
    kind : str
        ``"run"``, ``"orbit"`` or ``"rig"``.
    parts : tuple of str
        Of a rig, the curves that there are; of a run with several balls, what the track of each is called.
    longest : float
        Half the length of the longest cavity, b.
    following : bool
        Whether the run goes on: curves show the last cycles.
    timeline : str
        That by which curves are drawn.
    beside : bool
        Whether other runs stand beside it.
    brief : bool
        Whether there is room for short titles only.
    called : Called
        What its bodies are called.
    widest : float
        Largest |w| that the phase plane shows; 1 where there are walls.
    """

    root: str
    name: str
    start: float
    end: float
    first: float
    last: float
    period: float
    reach: float = 1.0
    kind: str = "run"
    parts: tuple[str, ...] = ()
    longest: float = 1.0
    following: bool = False
    timeline: str = CYCLE
    beside: bool = False
    brief: bool = False
    called: Called = field(default_factory=Called)
    widest: float = 1.0

    @property
    def several(self) -> bool:
        """Whether the run has balls with numbers."""
        return self.kind != "rig" and bool(self.parts)


def blueprint(runs: Sequence[Shown], *, still: bool = False, playing: bool = False) -> rrb.Blueprint:
    """Return the layout for one run, or for several side by side with one time cursor.

    Parameters
    ----------
    runs : sequence of Shown
        At least one.
    still : bool
        For a picture that nobody can pan: curves leave room for their legends, the top bar is hidden.
    playing : bool
        Whether it plays from the start on.
    """
    # A rig has seconds and no cycles that are known.
    timeline = SIM_TIME if any(run.kind == "rig" for run in runs) else CYCLE
    many = {"beside": len(runs) > 1, "brief": len(runs) >= _ABREAST}
    runs = [replace(run, timeline=timeline, **many) for run in runs]
    # One period of an orbit is there to be watched going round.
    looping = not still and all(run.kind == "orbit" for run in runs)
    panel = rrb.TimePanel(
        state="collapsed",
        timeline=timeline,
        fps=FPS,
        play_state="playing" if looping or playing else "paused",
        loop_mode="all",
        playback_speed=0.5 if looping else 1.0,
    )
    if len(runs) == 1:
        body = _measured(runs[0], still) if runs[0].kind == "rig" else _alone(runs[0], still)
    else:
        body = rrb.Horizontal(*(_measured(run, still) if run.kind == "rig" else _column(run, still) for run in runs))
    parts = (body, panel, rrb.TopPanel(state="hidden")) if still else (body, panel)
    return rrb.Blueprint(*parts, collapse_panels=True)


def following(run: Shown) -> rrb.Blueprint:
    """Return the layout for a run that goes on: what does not need the whole of it, at the latest time."""
    views = rrb.Vertical(
        *cavity_views(run),
        _ends(run, False),
        _gap(run, False),
        _rate(run, False),
        _lanes(run, False),
        row_shares=[2.7, 2.3, 1.8, 1.8, 1.3],
    )
    said = rrb.Vertical(_energy(run, False), _about(run), _impacts(run), row_shares=[2.0, 1.6, 2.0])
    panel = rrb.TimePanel(state="collapsed", timeline=SIM_TIME, play_state="following")
    return rrb.Blueprint(rrb.Horizontal(views, said, column_shares=[4.6, 2.6]), panel, collapse_panels=True)


def _alone(run: Shown, still: bool) -> rrb.Horizontal:
    """Return the views of one run."""
    ends, shares = ([], [1.8]) if run.several else ([_ends(run, still)], [2.3, 1.8])
    return rrb.Horizontal(
        rrb.Vertical(
            *cavity_views(run),
            *ends,
            _gap(run, still),
            _rate(run, still),
            _lanes(run, still),
            row_shares=[*_shares(run, 2.7), *shares, 1.8, _lanes_share(run)],
        ),
        rrb.Vertical(_phase(run), _energy(run, still), _balance(run, still), row_shares=[4.4, 2.6, 2.6]),
        rrb.Vertical(_dial(run), _about(run), _impacts(run), row_shares=[3.4, 3.9, 2.6]),
        column_shares=[4.6, 3.6, 2.6],
    )


def _column(run: Shown, still: bool) -> rrb.Vertical:
    """Return one of several runs beside each other."""
    more = rrb.Tabs(_impacts(run), _about(run), _energy(run, still), _balance(run, still))
    return rrb.Vertical(
        *cavity_views(run),
        rrb.Horizontal(_phase(run), _dial(run), column_shares=[1.5, 1.0]),
        _gap(run, still),
        _rate(run, still),
        _lanes(run, still),
        more,
        row_shares=[*_shares(run, 2.5), 3.6, 1.7, 1.7, _lanes_share(run), 1.9],
    )


def cavity_views(run: Shown) -> list[rrb.Spatial2DView | rrb.Grid]:
    """Return the views of cavity and ball: several above each other, many in two columns."""
    if not run.several:
        return [_drawn(run, f"{run.root}/cavity", run.name)]
    tracks = [_track(run, ball, label) for ball, label in enumerate(run.parts, 1)]
    return [rrb.Grid(*tracks, grid_columns=2)] if len(tracks) > _STACKED else [*tracks]


def _shares(run: Shown, one: float) -> list[float]:
    """Return the heights of the views of the cavities, of which a single one would have the height `one`."""
    if not run.several:
        return [one]
    balls = len(run.parts)
    return [1.0 * -(-balls // 2) + 3.0] if balls > _STACKED else [min(1.9, 5.0 / balls)] * balls


def _lanes_share(run: Shown) -> float:
    return 0.9 + 0.3 * len(run.parts) if run.several else 1.3


def _measured(run: Shown, still: bool) -> rrb.Horizontal:
    """Return the views of a run of a rig: a curve a sensor."""
    curves = [_series(run, part, part.replace("_", " "), still) for part in run.parts]
    stacked = rrb.Vertical(*curves) if len(curves) <= _STACKED else rrb.Grid(*curves, grid_columns=2)
    return rrb.Horizontal(stacked, _about(run), column_shares=[4.0, 1.4])


def _track(run: Shown, ball: int, label: str) -> rrb.Spatial2DView:
    return _drawn(run, track(run.root, ball), label, _LOW)


def _drawn(run: Shown, origin: str, name: str, more: float = 0.0) -> rrb.Spatial2DView:
    """Return a view of cavity and ball, with `more` room for the ruler's numbers where it is low."""
    (left, right), (top, bottom) = cavity_bounds(run.reach, run.longest)
    return rrb.Spatial2DView(
        origin=origin,
        name=name if run.brief else f"{run.called.drawing}: {name}",
        background=_DARK,
        visual_bounds=rrb.VisualBounds2D(x_range=(left, right), y_range=(top, bottom + (_LOW if run.beside else more))),
    )


def _phase(run: Shown) -> rrb.Spatial2DView:
    (left, right), (top, bottom) = ((run.widest * low, run.widest * high) for low, high in PHASE_BOUNDS)
    if run.brief:
        left, right = left - _NARROW, right + _NARROW
    boundary = rrb.TimeRangeBoundary
    back = {
        SIM_TIME: boundary.cursor_relative(seconds=-_TRAIL * run.period),
        CYCLE: boundary.cursor_relative(seq=-int(ticks(_TRAIL))),
        IMPACT: boundary.cursor_relative(seconds=-1.0),
    }
    across = "w/β across, w' up" if run.several else "w across, w' up, trail of a quarter cycle"
    return rrb.Spatial2DView(
        origin=f"{run.root}/phase",
        name=PLANE if run.brief else f"{PLANE}: {across}",
        background=_DARK,
        visual_bounds=rrb.VisualBounds2D(x_range=(left, right), y_range=(top, bottom)),
        time_ranges=[
            rrb.VisibleTimeRange(timeline, start=start, end=boundary.cursor_relative())
            for timeline, start in back.items()
        ],
    )


def _series(
    run: Shown, part: str, name: str, still: bool, legend: bool = True, span: tuple[float, float] | None = None
) -> rrb.TimeSeriesView:
    boundary = rrb.TimeRangeBoundary
    if run.following:
        start, end = boundary.cursor_relative(**_span(run, -_LATEST)), boundary.cursor_relative()
    elif run.kind != "rig" and run.last - run.first > _WINDOW:
        before = _BEFORE_STILL if still else _BEFORE
        start, end = (
            boundary.cursor_relative(**_span(run, part)) for part in (-before * _WINDOW, (1 - before) * _WINDOW)
        )
    elif still:
        start = boundary.absolute(**_moment(run, 0.0))
        end = boundary.absolute(**_moment(run, 1.0 + (0.0 if run.beside else _LEGEND)))
    else:
        # Without numbers, since they would be those of one timeline only.
        start, end = boundary.infinite(), boundary.infinite()
    return rrb.TimeSeriesView(
        origin=f"{run.root}/{part}",
        name=_BRIEF.get(part, name) if run.brief else name,
        axis_x=rrb.TimeAxis(view_range=rrb.TimeRange(start=start, end=end)),
        axis_y=None if span is None else rrb.ScalarAxis(range=span),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend),
    )


def _span(run: Shown, cycles: float) -> dict[str, Any]:
    """Return a length of time on the timeline of a run, as Rerun's boundaries take it."""
    if run.timeline == CYCLE:
        return {"seq": int(ticks(cycles))}
    return {"seconds": cycles * run.period}


def _moment(run: Shown, part: float) -> dict[str, Any]:
    """Return the time at which a part of a run is over, as Rerun's boundaries take it."""
    if run.timeline == CYCLE:
        return {"seq": int(ticks(run.first + part * (run.last - run.first)))}
    return {"seconds": run.start + part * (run.end - run.start)}


def _ends(run: Shown, still: bool) -> rrb.TimeSeriesView:
    return _series(run, "ends", run.called.ends, still)


def _gap(run: Shown, still: bool) -> rrb.TimeSeriesView:
    if run.several:
        return _series(run, "w", "Gaps w/β: +1 is an impact on L (▲), −1 on R (▼)", still)
    return _series(run, "w", run.called.gap, still, legend=False)


def _rate(run: Shown, still: bool) -> rrb.TimeSeriesView:
    if run.several:
        return _series(
            run, "w_dot", "Rates of the gaps w', marked just before impacts on L (▲) and R (▼)", still, False
        )
    return _series(run, "w_dot", "Rate of the gap w', marked just before impacts on L (red) and R (blue)", still, False)


def _lanes(run: Shown, still: bool) -> rrb.TimeSeriesView:
    if run.several:
        name = "Impacts ball by ball, on L (▲) and R (▼); bars: the ball sticks"
        return _series(run, "lanes", name, still, legend=False, span=lanes_range(len(run.parts)))
    return _series(run, "lanes", run.called.lanes, still, legend=False, span=LANES)


def _dial(run: Shown) -> rrb.Spatial2DView:
    (left, right), (top, bottom) = DIAL_BOUNDS
    return rrb.Spatial2DView(
        origin=f"{run.root}/dial",
        name="Phases" if run.beside else "Phase at impacts: L outside, R inside",
        background=_DARK,
        visual_bounds=rrb.VisualBounds2D(x_range=(left, right), y_range=(top, bottom)),
    )


def _energy(run: Shown, still: bool) -> rrb.TimeSeriesView:
    return _series(run, "energy", "Energy", still)


def _balance(run: Shown, still: bool) -> rrb.TimeSeriesView:
    return _series(run, "balance", "Running balance: work = damper + impacts + stored", still)


def _impacts(run: Shown) -> rrb.TextLogView:
    hidden = [TimelineColumn(timeline, visible=False) for timeline in (SIM_TIME, CYCLE, IMPACT)]
    return rrb.TextLogView(
        origin=f"{run.root}/impacts",
        name="Impacts",
        columns=rrb.TextLogColumns(timeline_columns=hidden, text_log_columns=["LogLevel", "Body"]),
    )


def _about(run: Shown) -> rrb.TextDocumentView:
    return rrb.TextDocumentView(origin=f"{run.root}/about", name=PARAMETERS)
