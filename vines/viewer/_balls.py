"""A run with several balls: a track a cavity, and curves and marks in the colour of the ball, side by shape."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import rerun as rr

from vines.logs import Log
from vines.viewer._clock import Clock
from vines.viewer._curves import balance_of, lines, running
from vines.viewer._drawn import Drawn
from vines.viewer._impacts import dial
from vines.viewer._scene import cavity, move, phase_frame, stretch_of
from vines.viewer._style import BALLS, GRID, LINE, MASS, SPRING

__all__ = ["half_of", "lanes_range", "send_balls", "track", "track_labels"]

_Shape = Literal["up", "down"]
_SIDES: tuple[tuple[str, int, _Shape], ...] = (("L", 1, "up"), ("R", -1, "down"))
"""Letter, sign and shape of the impacts of a side."""
_LANE = 0.24
"""Height of L above, and R below, the middle of a ball's lane; lanes are 1 apart."""


@dataclass(frozen=True)
class _Ball:
    """One ball: its number, colour, half the length of its cavity, states and impacts, gaps over that half."""

    number: int
    colour: tuple[int, int, int]
    half: float
    states: dict[str, np.ndarray]
    impacts: dict[str, np.ndarray]

    @property
    def name(self) -> str:
        return f"ball {self.number}"


def track(root: str, ball: int) -> str:
    """Return the path of the drawing of a ball in its cavity."""
    return f"{root}/track_{ball}"


def track_labels(log: Log) -> tuple[str, ...]:
    """Return what the track of each ball is called: its number and its parameters."""

    def told(ball: int) -> str:
        own = [f"{name} = {log.parameters[key]:g}" for name in ("mu", "beta", "r")
               if (key := f"{name}_{ball}") in log.parameters]  # fmt: skip
        return f"ball {ball}{', ' if own else ''}{', '.join(own)}"

    return tuple(map(told, log.balls))


def lanes_range(balls: int) -> tuple[float, float]:
    """Return the range of the view of the lanes: ball k at -k, L above and R below."""
    return -balls - 0.6, -0.4


def half_of(log: Log, ball: int) -> float:
    """Return half the length of a ball's cavity, in b; as the states say where parameters are lost."""
    told = log.parameters.get(f"beta_{ball}")
    return float(np.abs(log.balls[ball]["w"].to_numpy()).max(initial=0.0)) or 1.0 if told is None else told


def send_balls(
    rec: rr.RecordingStream,
    root: str,
    drawn: Drawn,
    states: dict[str, np.ndarray],
    impacts: dict[str, np.ndarray],
    clock: Clock,
) -> None:
    """Send all that is drawn of a run with several balls; `states` are those of the oscillator."""
    log = drawn.log
    balls = [_ball(log, ball, states, impacts) for ball in log.balls]
    longest = max(ball.half for ball in balls)
    for ball in balls:
        cavity(
            *(rec, track(root, ball.number), ball.states, clock),
            half=ball.half,
            longest=longest,
            colour=ball.colour,
        )
    indexes = clock.columns(states["t"])
    _plane(rec, f"{root}/phase/plane", balls, indexes, drawn.parts)
    lines(rec, f"{root}/w/gap", [(each.name, each.states["w"] / each.half, each.colour) for each in balls], indexes)
    lines(rec, f"{root}/w_dot/rate", [(each.name, each.states["w_dot"], each.colour) for each in balls], indexes)
    own = [each.states["kinetic_2"] + each.states["potential_2"] for each in balls]
    stored = np.sum([states["kinetic_1"], states["potential"], *own], axis=0)
    energies = [
        ("total", stored, MASS),
        ("mass, v1²/2", states["kinetic_1"], LINE),
        ("spring, (x1 − e)²/2", states["potential"], SPRING),
        *((each.name, energy, each.colour) for each, energy in zip(balls, own, strict=True)),
    ]
    lines(rec, f"{root}/energy", energies, indexes)
    running(rec, root, balance_of(states, stored), indexes)
    dial(rec, f"{root}/dial", states, impacts, clock)
    for each in balls:
        _lane(rec, f"{root}/lanes", each, clock)
        for letter, side, shape in _SIDES:
            hits = each.impacts["side"] == side
            for part, values in (("w", each.impacts["side"].astype(float)), ("w_dot", each.impacts["w_dot"])):
                name = f"{letter}{each.number}"
                _marks(rec, f"{root}/{part}/{name}", name, each.impacts["t"][hits], values[hits], each, shape, clock)


def _ball(log: Log, ball: int, states: dict[str, np.ndarray], impacts: dict[str, np.ndarray]) -> _Ball:
    table = log.balls[ball]
    own = {name: table[name].to_numpy() for name in table.column_names}
    hits = impacts["ball"] == ball
    return _Ball(
        ball,
        BALLS[(ball - 1) % len(BALLS)],
        half_of(log, ball),
        states | own,
        {name: values[hits] for name, values in impacts.items()},
    )


def _plane(
    rec: rr.RecordingStream,
    root: str,
    balls: list[_Ball],
    indexes: list[rr.TimeColumn],
    parts: tuple[slice, ...],
) -> None:
    """Draw the orbits of all balls in the plane of w/beta and w', and where they are now."""
    fastest = max(float(np.abs(each.states["w_dot"]).max()) for each in balls) or 1.0
    rec.log(root, rr.Transform3D(scale=[1.0, -stretch_of(fastest), 1.0]), static=True)
    for each in balls:
        path = np.column_stack([each.states["w"] / each.half, each.states["w_dot"]])
        at = f"{root}/ball_{each.number}"
        style = {"radii": rr.Radius.ui_points(1.0), "colors": (*each.colour, 150), "draw_order": 10.0}
        rec.log(f"{at}/orbit", rr.LineStrips2D([path[part] for part in parts], **style), static=True)
        size = rr.Radius.ui_points(6.0)
        rec.log(f"{at}/now", rr.Points2D([(0.0, 0.0)], radii=size, colors=each.colour, draw_order=40.0), static=True)
        move(rec, f"{at}/now", indexes, path[:, 0], path[:, 1])
    phase_frame(rec, root, fastest, "w/β")


def _lane(rec: rr.RecordingStream, root: str, ball: _Ball, clock: Clock) -> None:
    """Draw impacts of a ball as marks, L above and R below, and its spells of sticking as bars."""
    indexes = clock.columns(ball.states["t"])
    middle = -float(ball.number)
    rest = np.full(len(ball.states["t"]), middle)
    lines(rec, f"{root}/lane_{ball.number}", [("", rest, GRID)], indexes)
    for letter, side, shape in _SIDES:
        place = middle + side * _LANE
        name = f"{letter}{ball.number}"
        if (ball.states["stuck"] == side).any():
            bar = np.where(ball.states["stuck"] == side, place, np.nan)
            style = rr.SeriesLines(colors=ball.colour, widths=7.0, names=f"stuck {name}")
            rec.log(f"{root}/stuck_{name}", style, static=True)
            rec.send_columns(f"{root}/stuck_{name}", indexes=indexes, columns=rr.Scalars.columns(scalars=bar))
        times = ball.impacts["t"][ball.impacts["side"] == side]
        _marks(rec, f"{root}/{name}", name, times, np.full(len(times), place), ball, shape, clock)


def _marks(
    rec: rr.RecordingStream,
    path: str,
    name: str,
    times: np.ndarray,
    values: np.ndarray,
    ball: _Ball,
    shape: _Shape,
    clock: Clock,
) -> None:
    """Send impacts of a ball on one side as marks on curves; nothing where there are none."""
    if not len(times):
        return
    style = rr.SeriesPoints(colors=ball.colour, markers=shape, marker_sizes=5.0, names=f"impact {name}")
    rec.log(path, style, static=True)
    rec.send_columns(path, indexes=clock.columns(times), columns=rr.Scalars.columns(scalars=values))
