"""Two views of the impacts: their phases on a dial, and two lanes over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr

from vines.viewer._called import NO_STOPS
from vines.viewer._clock import Clock
from vines.viewer._scene import write
from vines.viewer._style import BALL, BALLS, GRID, LEFT, RIGHT, STOPPED

__all__ = ["DIAL_BOUNDS", "LANES", "bars_of", "dial", "lanes"]

DIAL_BOUNDS = ((-1.75, 1.75), (-1.62, 1.62))
"""What the view of the dial shows; its circle has radius 1."""
LANES = (-1.7, 1.7)
"""Range of the view of the lanes: L at +1, R at -1, as the gap at their impacts."""
_SIDES = (("left", 1, LEFT, 1.07), ("right", -1, RIGHT, 0.93))
"""Name, side, colour, and the radius at which an impact is marked: L outside, R inside of the circle."""


def dial(
    rec: rr.RecordingStream,
    root: str,
    states: dict[str, np.ndarray],
    impacts: dict[str, np.ndarray],
    clock: Clock,
) -> None:
    """Draw the phase of the forcing as a hand, that of each impact as a mark, counter-clockwise from the right.

    Parameters are those of `vines.viewer._scene.cavity`; `impacts` has the columns of ``vines.v1.Impact``. Marks have
    the colour of the side, of several balls that of the ball.
    """
    # Beneath the origin of the view, whose own transform would not show; y points down in Rerun.
    root = f"{root}/face"
    rec.log(root, rr.Transform3D(scale=[1.0, -1.0, 1.0]), static=True)
    turn = np.linspace(0.0, 2 * np.pi, 97)
    quarter = np.arange(4) * np.pi / 2
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    ticks = [[(0.82 * np.cos(a), 0.82 * np.sin(a)), (1.18 * np.cos(a), 1.18 * np.sin(a))] for a in quarter]
    rec.log(
        f"{root}/circle",
        rr.LineStrips2D([ring, *ticks], radii=rr.Radius.ui_points(0.8), colors=GRID, draw_order=1.0),
        static=True,
    )
    places = [(1.34, 0.0), (0.0, 1.3), (-1.34, 0.0), (0.0, -1.3)]
    write(rec, f"{root}/circle/phases", places, ["0", "π/2", "π", "3π/2"])

    phase = states["phase"]
    tips = np.column_stack([np.cos(phase), np.sin(phase)])
    hand = np.stack([np.zeros_like(tips), tips], axis=1).astype(np.float32)
    style = rr.LineStrips2D.from_fields(radii=rr.Radius.ui_points(1.6), colors=BALL, draw_order=10.0)
    rec.log(f"{root}/hand", style, static=True)
    rec.send_columns(f"{root}/hand", indexes=clock.columns(states["t"]), columns=rr.LineStrips2D.columns(strips=hand))

    for name, hits, colour, radius in _marks(impacts):
        if not hits.any():
            continue
        angle = impacts["phase"][hits]
        marks = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        rec.log(
            f"{root}/impacts/{name}",
            rr.Points2D(marks, radii=rr.Radius.ui_points(3.5), colors=(*colour, 190), draw_order=20.0),
            static=True,
        )
        latest = f"{root}/latest/{name}"
        rec.log(
            latest,
            rr.Points2D.from_fields(radii=rr.Radius.ui_points(6.5), colors=colour, draw_order=30.0),
            static=True,
        )
        rec.send_columns(
            latest,
            indexes=clock.columns(impacts["t"][hits]),
            columns=rr.Points2D.columns(positions=marks.astype(np.float32)),
        )


def _marks(impacts: dict[str, np.ndarray]) -> Sequence[tuple[str, np.ndarray, tuple[int, int, int], float]]:
    """Return name, impacts, colour and radius of each kind of mark on the dial."""
    of_side = [(name, impacts["side"] == side, colour, radius) for name, side, colour, radius in _SIDES]
    if "ball" not in impacts:
        return of_side
    return [
        (f"{name}_{ball}", hits & (impacts["ball"] == ball), BALLS[ball - 1], radius)
        for ball in np.unique(impacts["ball"]).tolist()
        for name, hits, _, radius in of_side
    ]


def lanes(
    rec: rr.RecordingStream,
    root: str,
    states: dict[str, np.ndarray],
    impacts: dict[str, np.ndarray],
    clock: Clock,
    stops: np.ndarray = NO_STOPS,
) -> None:
    """Draw impacts as marks on two lanes, and spells in which the ball sticks, or stops between the walls, as bars.

    Parameters are those of `vines.viewer._scene.cavity`; `impacts` has the columns of ``vines.v1.Impact``.
    """
    # Thin lines through the lanes; they also keep the span of time the same as in the other views.
    rows = np.tile([1.0, -1.0], (len(states["t"]), 1))
    rec.log(f"{root}/lane", rr.SeriesLines(colors=[GRID, GRID], widths=[1.0, 1.0], names=["", ""]), static=True)
    indexes = clock.columns(states["t"])
    rec.send_columns(
        f"{root}/lane",
        indexes=indexes,
        columns=rr.Scalars.columns(scalars=rows.ravel()).partition(np.full(len(rows), 2)),
    )
    stuck = states["stuck"]
    for name, side, colour, _ in _SIDES:
        if (stuck == side).any():
            path = f"{root}/stuck_{name}"
            bar = np.where(stuck == side, float(side), np.nan)
            rec.log(path, rr.SeriesLines(colors=colour, widths=7.0, names=f"stuck {name[0].upper()}"), static=True)
            rec.send_columns(path, indexes=indexes, columns=rr.Scalars.columns(scalars=bar))
        hits = impacts["side"] == side
        if hits.any():
            path = f"{root}/{name}"
            style = rr.SeriesPoints(
                colors=colour, markers="diamond", marker_sizes=6.0, names=f"impact {name[0].upper()}"
            )
            rec.log(path, style, static=True)
            rec.send_columns(
                path,
                indexes=clock.columns(impacts["t"][hits]),
                columns=rr.Scalars.columns(scalars=np.full(hits.sum(), float(side))),
            )
    if len(stops):
        path = f"{root}/stopped"
        rec.log(path, rr.SeriesLines(colors=STOPPED, widths=7.0, names="stop in mid-cavity"), static=True)
        times, bars = bars_of(stops)
        rec.send_columns(path, indexes=clock.columns(times), columns=rr.Scalars.columns(scalars=bars))


def bars_of(spells: np.ndarray, heights: np.ndarray | float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return times and values of a curve that is there in some spells, shape (n, 2), only.

    Examples
    --------
    >>> bars_of(np.array([[1.0, 2.0], [4.0, 5.0]]))[1]
    array([ 0.,  0., nan,  0.,  0., nan])
    """
    values = np.full((len(spells), 3), np.nan)
    values[:, :2] = np.broadcast_to(heights, len(spells))[:, None]
    return np.repeat(spells, [1, 2], axis=1).ravel(), values.ravel()
