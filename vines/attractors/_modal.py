"""What a run of a structure of several modes comes to: its modes stand in the rows, beside x1 and v1."""

from __future__ import annotations

import math

from vines.attractors._approach import nearest_orbit
from vines.attractors._judge import without_impact
from vines.dynamics.modes import ModesConstants
from vines.dynamics.modes.kernels import note
from vines.kernels import cold_njit

__all__: list[str] = []

_as_of_one = without_impact.first


@nearest_orbit.register(ModesConstants)
@cold_njit
def _nearest_orbit(c, rows, kept, p, lag, scale, tolerance):
    # How fast a run comes to an orbit its last repetitions tell.
    return False, math.nan, math.inf, math.inf


@without_impact.register(ModesConstants)
@cold_njit
def _without_impact(c, rows, n, tolerance, verdict):
    note(c, rows[n - 1])
    _as_of_one(c, rows, n, tolerance, verdict)
