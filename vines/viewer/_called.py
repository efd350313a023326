"""What the bodies of a run are called, and what else of its drawing depends on its system."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vines.logs import Log
from vines.model import system_names, with_one_ball
from vines.viewer._style import CAVITY

__all__ = ["NO_STOPS", "Called", "called", "called_in", "stops_of"]

NO_STOPS = np.empty((0, 2))

_ALSO_LOST = {"f": "friction", "delta": "coil", "l2": "dashpot"}
"""Parameters by which energy is lost that logs book with that of the damper."""


@dataclass(frozen=True)
class Called:
    """What is said of one run.

    Attributes
    ----------
    frame, body : str
        The body that is on the base's spring, and the one in it.
    walls : bool
        Whether there are walls.
    barriers : bool
        Whether these are barriers beside a spring, and no cavity of a free ball.
    stops : bool
        Whether friction may stop the ball in mid-cavity.
    lost, stored : str
        What the curve of the damper's loss holds, and that of the potential energy.
    """

    frame: str = "mass"
    body: str = "ball"
    walls: bool = True
    barriers: bool = False
    stops: bool = False
    lost: str = "lost in the damper"
    stored: str = "spring, (x1 − e)²/2"

    @property
    def drawing(self) -> str:
        """How the title of the drawing begins."""
        if not self.barriers:
            return CAVITY
        return f"{'Barriers' if self.walls else self.frame.capitalize()} and {self.body}, to scale"

    @property
    def wall(self) -> str:
        """What one of the walls is."""
        return "barrier" if self.barriers else "end"

    @property
    def ends(self) -> str:
        """The title of the curves of both bodies."""
        if not self.walls:
            return f"{self.frame.capitalize()} x1 and {self.body} x2"
        return f"{'Barriers' if self.barriers else 'Ends of the cavity'} x1 ± 1 and {self.body} x2"

    @property
    def gap(self) -> str:
        """The title of the curve of w."""
        if not self.walls:
            return "Gap w = x1 − x2"
        return "Gap w = x1 − x2: +1 is an impact on L (red), −1 on R (blue)"

    @property
    def lanes(self) -> str:
        """The title of the lanes of impacts."""
        grey = ", grey where it stops in mid-cavity" if self.stops else ""
        return f"Impacts on L (above) and R (below); bars: the {self.body} sticks{grey}"


def called(log: Log) -> Called:
    """Return what the bodies of a run are called, as its system declares them; a ball where that is not known."""
    return Called() if log.balls else called_in(log.system, log.parameters)


def called_in(name: str, given: Mapping[str, float]) -> Called:
    """Return the same of a run of a system, given the numbers of its parameters."""
    if name not in system_names():
        return Called()
    system = with_one_ball(name)
    body = system.between_walls
    also = [meant for name, meant in _ALSO_LOST.items() if given.get(name)]
    springs = any(given.get(name) for name in ("k1", "k3", "alpha"))
    stored = "springs" if springs else "spring and weight" if given.get("G") else Called.stored
    return Called(
        # No two bodies have one name.
        frame="mass" if body != "mass" else system.bodies[0].name,
        body=body,
        walls=given.get("walls", 1.0) > 0,
        barriers="walls" in given,
        stops=system.stops,
        lost=f"lost in damper and {' and '.join(also)}" if also else Called.lost,
        stored=stored,
    )


def stops_of(log: Log) -> np.ndarray:
    """Return begin and end of each stop in mid-cavity, shape (n, 2); the run's end where it still lasts."""
    if log.balls or not log.sticks.num_rows:
        return NO_STOPS
    middle = log.sticks["side"].to_numpy() == 0
    begins, ends = (log.sticks[name].to_numpy()[middle] for name in ("t_start", "t_release"))
    return np.column_stack([begins, np.where(np.isnan(ends), log.states["t"][-1].as_py(), ends)])
