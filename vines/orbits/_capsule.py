"""What the closing equations need to know of the impact pair: a driven frame takes no kicks."""

from __future__ import annotations

import math

from vines.dynamics.impact_pair import PairConstants
from vines.kernels import linked_njit, njit
from vines.orbits._budget import orbit_rows
from vines.orbits._chains import ball_of, chain_closing, gravity, response, steady
from vines.orbits._equations import closing_kernel, closing_unit, prepared
from vines.orbits._survey import inspect_row, survey_kernel, survey_rows

__all__: list[str] = []


@prepared.register(PairConstants)
@njit
def _prepared(c):
    return c


@closing_unit.register(PairConstants)
@njit
def _closing_unit(c):
    return 1.0, 1.0 + c.B


closing_kernel.register(PairConstants)(chain_closing)


@steady.register(PairConstants)
@njit
def _steady(c, t):
    x, v = c.B * math.sin(t), c.B * math.cos(t)
    return x, v, -x


@response.register(PairConstants)
@njit
def _response(c, duration, tau):
    return 0.0, 0.0, 0.0


@ball_of.register(PairConstants)
@njit
def _ball_of(c, number):
    return c.law.pass1, c.law.pass2, c.law.keep2, 1.0


@gravity.register(PairConstants)
@njit
def _gravity(c):
    return c.G


inspect_row.register(PairConstants)(inspect_row.first)
orbit_rows.register(PairConstants)(orbit_rows.first)


@survey_kernel.register(PairConstants)
@linked_njit
def _survey(c, duration, side, t, states):
    return survey_rows(c, orbit_rows(c, duration, side, t, states), side)
