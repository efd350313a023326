"""Runs of the simulator: displacements, gap and phase plane, as in the paper's Figs 2, 4, 10 and 11."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import SHOWN, name_axis
from vines.figures._colours import BALLS, COLOURS, FAMILIES
from vines.figures._marks import DOTTED
from vines.figures._style import font

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vines.figures._legend import Entry

__all__ = ["EndsPanel", "GapPanel", "PhasePlanePanel", "RunCurves"]

Floats = npt.NDArray[np.float64]


def _lines() -> tuple[str, ...]:
    """Return the colours of runs that share a phase plane; the first two are those of the paper's Fig. 4(b) and (e)."""
    return COLOURS["R"], FAMILIES["asymmetric"][0], FAMILIES["unequal"][1], FAMILIES["unequal"][0]


_MANY = 40
"""Impacts beyond which they are not marked one by one."""


@dataclass(frozen=True)
class RunCurves:
    """A run in dense samples, two at each impact, and its impacts.

    Attributes
    ----------
    t : (n,) array
        Time since the start of the record [forcing periods].
    x1, x2, w, w_dot : (n,) array
        Displacements, gap and relative velocity, dimensionless.
    hit_t : (k,) array
        Times of the impacts [forcing periods].
    hit_side : (k,) array of int
        +1 on the left end, -1 on the right.
    hit_x2, hit_w_dot : (k,) array
        Place of the ball, and relative velocity just before.
    label : str
        What tells the run from others, such as ``"$A = 0.017$"``.
    length : float
        Half the length of the cavity.
    ball : int
        Number of the ball, which then gives the colour; 0 where balls have no numbers.
    stops : (m, 2) array
        Begin and end of each stop in mid-cavity [forcing periods].
    body, ends : str
        What the ball is called, and the ends of its cavity.
    walls : bool
        Whether there are ends; without, the oscillator is drawn itself.
    """

    t: Floats
    x1: Floats
    x2: Floats
    w: Floats
    w_dot: Floats
    hit_t: Floats
    hit_side: npt.NDArray[np.integer[Any]]
    hit_x2: Floats
    hit_w_dot: Floats
    label: str = ""
    length: float = 1.0
    ball: int = 0
    stops: Floats = field(default_factory=lambda: np.empty((0, 2)))
    body: str = "ball"
    ends: str = "cavity ends"
    walls: bool = True

    @property
    def walls_at(self) -> tuple[float, ...]:
        """Gaps at which there is a wall."""
        return (-self.length, self.length) if self.walls else ()

    @property
    def colour(self) -> str:
        """Colour of a ball with a number."""
        return BALLS[(self.ball - 1) % len(BALLS)]


@dataclass(frozen=True)
class EndsPanel:
    """The two ends of the cavity, x1 - 1 and x1 + 1, and the ball between them, over `periods` forcing periods.

    `balls` are the further balls of the run, each in a cavity and a colour of its own.
    """

    run: RunCurves
    periods: float
    title: str = ""
    y: tuple[float, float] | None = None
    balls: Sequence[RunCurves] = ()

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        for run in (self.run, *self.balls):
            ends, ball = (run.colour, run.colour) if run.ball else (COLOURS["R"], COLOURS["L"])
            for shift in run.walls_at or (0.0,):
                ax.plot(run.t, run.x1 + shift, color=ends, linestyle=DOTTED, linewidth=1.2)
            ax.plot(run.t, run.x2, color=ball, linewidth=1.1)
            ax.plot(run.hit_t, run.hit_x2, **_HIT)
            _stops(ax, run, run.x2)
        several, alone = r"$x_1 \pm \beta_i,\ x_{2,i}$", None if self.run.walls else r"$x_1,\ x_2$"
        _along_time(ax, self.periods, "ends", several if self.run.ball else alone)
        _frame(ax, self.title, self.y)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        if self.run.ball:
            ink = {"color": COLOURS["ink"], "linestyle": DOTTED, "linewidth": 1.4}
            hit: Entry = ("impact", (Line2D([], [], **_HIT),))
            return [*_ball_entries((self.run, *self.balls)), ("ends of its cavity", (Line2D([], [], **ink),)), hit]
        ends = rf"{self.run.ends} $x_1 \pm 1$" if self.run.walls else "oscillator $x_1$"
        return [
            (ends, (Line2D([], [], color=COLOURS["R"], linestyle=DOTTED, linewidth=1.4),)),
            (f"{self.run.body} $x_2$", (Line2D([], [], color=COLOURS["L"], linewidth=1.3),)),
            ("impact", (Line2D([], [], **_HIT),)),
            *_stop_entries([self.run]),
        ]


@dataclass(frozen=True)
class GapPanel:
    """Gap w and relative velocity over `periods` forcing periods; of several balls the velocities are dashed."""

    run: RunCurves
    periods: float
    title: str = ""
    y: tuple[float, float] | None = None
    balls: Sequence[RunCurves] = ()

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        for run in (self.run, *self.balls):
            gap, speed = (run.colour, run.colour) if run.ball else (COLOURS["R"], COLOURS["L"])
            for wall in run.walls_at:
                ax.axhline(wall, color=gap if run.ball else COLOURS["mark"], linewidth=0.5, alpha=0.6)
            ax.plot(run.t, run.w, color=gap, linewidth=1.1)
            ax.plot(run.t, run.w_dot, color=speed, linewidth=1.1, linestyle=_DASHED if run.ball else "-")
            _stops(ax, run, run.w)
        _along_time(ax, self.periods, "gap")
        _frame(ax, self.title, self.y)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        if self.run.ball:
            dashed = {"color": COLOURS["ink"], "linestyle": _DASHED}
            return [
                *_ball_entries((self.run, *self.balls)),
                (r"its relative velocity $\dot w$", (Line2D([], [], **dashed),)),
            ]
        return [
            (r"gap $w$", (Line2D([], [], color=COLOURS["R"], linewidth=1.3),)),
            (r"relative velocity $\dot w$", (Line2D([], [], color=COLOURS["L"], linewidth=1.3),)),
            *_stop_entries([self.run]),
        ]


@dataclass(frozen=True)
class PhasePlanePanel:
    """The (w, w') plane of one run, or of several in colours of their own; an impact is a vertical line at w = ±1."""

    runs: Sequence[RunCurves]
    title: str = ""
    y: tuple[float, float] | None = None

    def draw(self, ax: Axes) -> None:
        """Draw it."""
        walls = {wall for run in self.runs for wall in run.walls_at}
        for wall in walls:
            ax.axvline(wall, color=COLOURS["mark"], linewidth=0.5, alpha=0.6)
        for run, colour in zip(self.runs, self._colours(), strict=True):
            many = len(run.hit_t) > _MANY
            ax.plot(run.w, run.w_dot, color=colour, linewidth=0.6 if many else 1.1, label=run.label)
            if len(run.stops):
                held = np.interp(run.stops[:, 0], run.t, run.w)
                ax.plot(held, np.zeros_like(held), **_STOP)
            if len(self.runs) == 1:
                size = 2.0 if many else 4.5
                for side, name in ((1, "L"), (-1, "R")):
                    mine = run.hit_side == side
                    dot = {"marker": ".", "markersize": 2 * size, "markeredgewidth": 0, "linestyle": "none"}
                    ax.plot(run.length * run.hit_side[mine], run.hit_w_dot[mine], color=COLOURS[name], zorder=3, **dot)
        if len(self.runs) > 1:
            # In the panel, since others of the sheet may have the same colours for other runs.
            # Loops leave no empty corner: what lies under the labels shows through a little.
            ax.legend(
                loc="best",
                handlelength=1.6,
                borderaxespad=2.4,
                frameon=True,
                facecolor="white",
                framealpha=0.85,
                edgecolor="none",
            )
        if all(run.walls for run in self.runs):
            ax.set_xlim(-1.15 * max(walls), 1.15 * max(walls))
        name_axis(ax, "x", "w", SHOWN["w"])
        name_axis(ax, "y", "w_dot", SHOWN["w_dot"])
        _frame(ax, self.title, self.y)

    def entries(self) -> list[Entry]:
        """Return what the legend says of it."""
        from matplotlib.lines import Line2D

        if len(self.runs) > 1:
            return _stop_entries(self.runs)
        dot: dict[str, Any] = {"marker": ".", "markersize": 8, "markeredgewidth": 0, "linestyle": "none"}
        return [
            *(
                (rf"$\dot w$ before an impact on {side}", (Line2D([], [], color=COLOURS[side], **dot),))
                for side in "LR"
            ),
            *_stop_entries(self.runs),
        ]

    def _colours(self) -> Sequence[str]:
        if all(run.ball for run in self.runs) and len({run.ball for run in self.runs}) == len(self.runs):
            return [run.colour for run in self.runs]
        return [COLOURS["ink"]] if len(self.runs) == 1 else [_lines()[k % 4] for k in range(len(self.runs))]


_DASHED: Any = (0, (4, 1.5))


def _ball_entries(runs: Sequence[RunCurves]) -> list[Entry]:
    from matplotlib.lines import Line2D

    return [(f"ball {run.ball}", (Line2D([], [], color=run.colour, linewidth=1.3),)) for run in runs]


_HIT: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 2.6,
    "markerfacecolor": "white",
    "markeredgecolor": COLOURS["ink"],
    "markeredgewidth": 0.7,
    "zorder": 3,
}


_STOP: dict[str, Any] = {
    "linestyle": "none",
    "marker": "s",
    "markersize": 3.6,
    "markerfacecolor": COLOURS["stop"],
    "markeredgewidth": 0,
    "zorder": 3,
}


def _stops(ax: Axes, run: RunCurves, values: Floats) -> None:
    """Draw the part of a curve over time in which the ball stands in mid-cavity."""
    for begin, end in run.stops:
        there = (run.t >= begin) & (run.t <= end)
        ax.plot(run.t[there], values[there], color=COLOURS["stop"], linewidth=3.0, solid_capstyle="butt", zorder=2.5)


def _stop_entries(runs: Sequence[RunCurves]) -> list[Entry]:
    from matplotlib.lines import Line2D

    if not any(len(run.stops) for run in runs):
        return []
    return [("stop in mid-cavity", (Line2D([], [], color=COLOURS["stop"], linewidth=3.0),))]


def _along_time(ax: Axes, periods: float, name: str, text: str | None = None) -> None:
    ax.set_xlim(0, periods)
    name_axis(ax, "x", "t", SHOWN["t"])
    name_axis(ax, "y", name, SHOWN[name] if text is None else text)


def _frame(ax: Axes, title: str, y: tuple[float, float] | None) -> None:
    if title:
        ax.set_title(title, fontsize=font(8.5))
    if y is not None:
        ax.set_ylim(*y)
