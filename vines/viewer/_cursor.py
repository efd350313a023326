"""Where the cursor of a picture stands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rerun.experimental import ViewerClient

from vines.logs import Log
from vines.viewer._clock import CYCLE, SIM_TIME, Clock, ticks
from vines.viewer._rig import is_rig

__all__ = ["set_time"]


def set_time(viewer: ViewerClient, runs: Sequence[Log], t: float) -> None:
    """Put the cursor of a viewer on a time of the first run, on the timeline that the layout shows."""
    if any(map(is_rig, runs)):
        viewer.set_time(SIM_TIME, duration=t, play_state="paused")
        return
    states = runs[0].states
    clock = Clock(states["t"][0].as_py(), states["phase"][0].as_py(), runs[0].parameters.get("Omega", 1.0))
    viewer.set_time(CYCLE, sequence=int(ticks(clock.cycles(np.array(t)))), play_state="paused")
