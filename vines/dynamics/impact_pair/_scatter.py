"""The impact pair with a restitution that is drawn at each impact: its kernels are those of the pair without."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._advance import advance, begin, law_of
from vines.dynamics._constants import constants_at
from vines.dynamics._contact import next_contact
from vines.dynamics._flight import (
    ball_flown,
    drift,
    flight,
    flown,
    forced_fifth,
    free_ball,
    launched,
    phase_after,
    pull,
    rate_alone,
    relative,
)
from vines.dynamics._impact_law import ImpactLaw, impact_law_kernel
from vines.dynamics._random import normal
from vines.dynamics._scatter_table import colour_at
from vines.dynamics._sticking import holds_for, next_release
from vines.dynamics._window import width_of, write_end
from vines.dynamics.impact_pair._constants import Capsule, PairConstants, pair_constants
from vines.kernels import fused_njit, njit

__all__ = ["PairScatterTable", "ScatterPair"]


class ScatterPair(NamedTuple):
    """As `PairConstants`, with a restitution of the standard deviation `sigma_r`, drawn as of `ScatterConstants`."""

    mu: float
    Omega: float
    r: float
    lam: float
    B: float
    G: float
    period: float
    window: float
    near: float
    correction: float
    law: ImpactLaw
    free: Capsule
    stuck: Capsule
    sigma_r: float
    key: int
    stream: int


class PairScatterTable(NamedTuple):
    """Runs of the pair with scatter: B, G, r, the standard deviation of r, the seed, and their streams."""

    values: npt.NDArray[np.float64]
    sigma_r: float
    key: int
    streams: npt.NDArray[np.int64]


width_of.register(PairScatterTable)(width_of.first)


@constants_at.register(PairScatterTable)
@njit
def _constants_at(table, k):
    c = pair_constants(table.values[k, 0], table.values[k, 1], table.values[k, 2])
    return ScatterPair(
        c.mu, c.Omega, c.r, c.lam, c.B, c.G, c.period, c.window, c.near, c.correction, c.law, c.free, c.stuck,
        table.sigma_r, table.key, table.streams[k],
    )  # fmt: skip


for _name in (
    advance,
    ball_flown,
    begin,
    drift,
    flight,
    flown,
    forced_fifth,
    free_ball,
    holds_for,
    launched,
    next_contact,
    next_release,
    phase_after,
    pull,
    rate_alone,
    relative,
    write_end,
):
    _name.register(ScatterPair)(_name.bodies[PairConstants])


@law_of.register(ScatterPair)
@fused_njit
def _law_of(c, closing, number):
    if c.sigma_r > 0.0:
        r = c.r + c.sigma_r * normal(c.key, c.stream, 2 * int(number))
        return impact_law_kernel(0.0, min(max(r, 0.0), 1.0))
    return c.law


@colour_at.register(ScatterPair)
@njit
def _colour_at(c, t):
    return 0.0
