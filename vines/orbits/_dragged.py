"""What the closing equations need to know of a ball that is dragged."""

from __future__ import annotations

import math

from vines.dynamics.drag import DragConstants
from vines.kernels import linked_njit, njit
from vines.orbits._budget import orbit_rows
from vines.orbits._chains import ball_of
from vines.orbits._equations import closing_kernel, closing_unit, prepared
from vines.orbits._flown_closing import flown_closing
from vines.orbits._survey import inspect_row, survey_kernel, survey_rows
from vines.orbits._turnings_of_balls import rides

__all__: list[str] = []


@prepared.register(DragConstants)
@njit
def _prepared(c):
    return c


@closing_unit.register(DragConstants)
@njit
def _closing_unit(c):
    return 1.0, 1.0 + math.hypot(c.free.own.qr, c.free.own.qi)


closing_kernel.register(DragConstants)(flown_closing)
inspect_row.register(DragConstants)(inspect_row.first)
orbit_rows.register(DragConstants)(orbit_rows.first)
rides.register(DragConstants)(rides.first)


@ball_of.register(DragConstants)
@njit
def _ball_of(c, number):
    return c.law.pass1, c.law.pass2, c.law.keep2, 1.0


@survey_kernel.register(DragConstants)
@linked_njit
def _survey(c, duration, side, t, states):
    return survey_rows(c, orbit_rows(c, duration, side, t, states), side)
