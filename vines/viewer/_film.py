"""What a film shows: each ball in its cavity, to scale, and the gaps over time with a cursor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vines.logs import Log
from vines.packages import need
from vines.viewer._called import called, stops_of
from vines.viewer._clock import Clock
from vines.viewer._scene import DRIVEN

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Film"]

_LEFT, _RIGHT, _MASS, _BASE, _SPRING = "#d62728", "#1f77b4", "#444444", "#2ca02c", "#888888"
_BALLS = ("#e69f00", "#cc79a7", "#009e73", "#56b4e9", "#8c564b", "#7f7f7f", "#bcbd22", "#17becf")
_STOPPED = "#8f949c"
_RADIUS = 0.09
"""Of the drawn ball, b; the ends are drawn as much further out, so that they touch exactly at an impact."""
_TRACK = 1.0
"""Height of a track, b."""


class Film:
    """Draws a run at one time after the other.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        Where it draws.
    run : Log
        With states.
    times : numpy.ndarray, shape (n,)
        Times of the frames.
    """

    def __init__(self, figure: Figure, run: Log, times: np.ndarray):
        need("matplotlib")
        from matplotlib.patches import Circle

        states = run.states
        t = states["t"].to_numpy()
        tables = dict(run.balls) or {1: states}
        clock = Clock(float(t[0]), states["phase"][0].as_py(), run.parameters.get("Omega", 1.0))
        self._cycles = clock.cycles(times)
        self._x1, self._base = (np.interp(times, t, states[name].to_numpy()) for name in ("x1", "base"))
        self._x2 = [np.interp(times, t, table["x2"].to_numpy()) for table in tables.values()]
        halves = [run.parameters.get(f"beta_{ball}", 1.0) for ball in tables]
        longest = max(halves)
        reach = float(np.abs(self._x1).max())
        self._mount = -(reach + longest + 0.9)
        sprung, names = run.system not in DRIVEN, called(run)
        self._stopped = [(times >= begin) & (times <= end) for begin, end in stops_of(run)]
        above, below = figure.subplots(2, 1, height_ratios=[0.9 + 0.5 * len(tables), 1.2])
        left = self._mount - 0.3 if sprung else -(reach + longest + 0.4)
        above.set(xlim=(left, reach + longest + 0.4), ylim=(-len(tables) * _TRACK + 0.5, 0.55))
        above.set(aspect="equal", yticks=[], xlabel="displacement / b", title=run.name)
        self._moving = []
        self._springs = []
        self._balls = []
        for k, (ball, half) in enumerate(zip(tables, halves, strict=True)):
            y, inner = -k * _TRACK, half + _RADIUS
            colour = _BALLS[(ball - 1) % len(_BALLS)]
            for side, of_side in ((-1, _LEFT), (1, _RIGHT)) if names.walls else ():
                x = np.full(2, side * (inner + 0.04))
                self._moving.append((above.plot(x, [y - 0.3, y + 0.3], color=of_side, lw=5)[0], x))
            for edge in (-0.34, 0.34):
                x = np.array([-inner - 0.08, inner + 0.08])
                self._moving.append((above.plot(x, [y + edge, y + edge], color=_MASS, lw=3)[0], x))
            disc = Circle((0.0, y), _RADIUS, color=colour, zorder=5)
            above.add_patch(disc)
            self._balls.append((disc, y))
            if not sprung:
                continue
            coil = y + 0.12 * np.concatenate([[0.0, 0.0], (-1.0) ** np.arange(11), [0.0, 0.0]])
            self._springs.append((above.plot(np.zeros(15), coil, color=_SPRING, lw=1)[0], -inner - 0.08))
        self._x3, self._beside = None, None
        if run.nes.num_rows:
            self._x3 = np.interp(times, t, run.nes["x3"].to_numpy())
            (self._beside,) = above.plot([0.0, 0.0], [-0.46, -0.46], marker="s", markevery=[1], color=_BALLS[1], lw=1)
        (self._wall,) = above.plot([0.0, 0.0], [-len(tables) * _TRACK + 0.6, 0.4], color=_BASE, lw=5, visible=sprung)
        shown = (t >= times[0]) & (t <= times[-1])
        cycles = clock.cycles(t[shown])
        for (ball, table), half in zip(tables.items(), halves, strict=True):
            name = f"ball {ball}" if run.balls else "w"
            colour = _BALLS[(ball - 1) % len(_BALLS)]
            below.plot(cycles, table["w"].to_numpy()[shown] / half, color=colour, lw=1.2, label=name)
        for side, of_side in ((1, _LEFT), (-1, _RIGHT)) if names.walls else ():
            below.axhline(side, color=of_side, lw=1)
        self._cursor = below.axvline(cycles[0] if len(cycles) else 0.0, color="black", lw=1)
        below.set(xlabel="forcing cycles", ylabel="w/β" if run.balls else "w = (x1 − x2)/b")
        widest = 1.0 if names.walls else max(1.0, float(np.abs(states["w"].to_numpy()).max()))
        below.set(ylim=(-1.15 * widest, 1.15 * widest))
        below.set(xlim=(self._cycles[0], self._cycles[-1]))
        if run.balls:
            place = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.2}
            below.legend(ncols=len(tables), fontsize="small", frameon=False, **place)

    def show(self, k: int) -> None:
        """Put everything where it is in frame `k`."""
        x1 = self._x1[k]
        for line, x in self._moving:
            line.set_xdata(x + x1)
        for number, ((disc, y), x2) in enumerate(zip(self._balls, self._x2, strict=True)):
            disc.set_center((x2[k], y))
            if self._stopped:
                disc.set_color(_STOPPED if any(there[k] for there in self._stopped) else _BALLS[number])
        if self._beside is not None and self._x3 is not None:
            # A mass on a spring beside the ball, under the middle of the cavity.
            self._beside.set_xdata([x1, self._x3[k]])
        wall = self._mount + self._base[k]
        self._wall.set_xdata([wall, wall])
        for line, end in self._springs:
            line.set_xdata(
                wall + (x1 + end - wall) * np.concatenate([[0.0, 0.1], np.linspace(0.14, 0.86, 11), [0.9, 1.0]])
            )
        self._cursor.set_xdata([self._cycles[k]] * 2)
