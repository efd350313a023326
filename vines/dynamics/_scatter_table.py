"""Parameters of many runs with scatter, for kernels that run them for themselves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import constants_at
from vines.dynamics._scatter_constants import AHEAD, COLOURS, ScatterConstants, scatter_constants
from vines.dynamics._scatter_motion import piece_at, place_of
from vines.dynamics._window import width_of
from vines.kernels import by_type, doubles_at, njit

__all__ = ["ScatterTable", "colour_at"]


class ScatterTable(NamedTuple):
    """Runs with scatter: their parameters, what is drawn, their streams, and the address of `ROOM` doubles.

    Draws begin at time 0. The runs share the room, so one is taken after the other.
    """

    values: npt.NDArray[np.float64]
    numbers: npt.NDArray[np.float64]
    streams: npt.NDArray[np.int64]
    room: int


width_of.register(ScatterTable)(width_of.first)


@constants_at.register(ScatterTable)
@njit
def _constants_at(table, k):
    return scatter_constants(table.values[k], table.numbers[k], table.streams[k], 0.0, table.room)


@by_type(ScatterConstants)
@njit
def colour_at(c, t):
    """Return the coloured force at a time that is a whole number of its steps, in units of A; 0 if there is none."""
    if not c.colour.size > 0.0:
        return 0.0
    place = place_of(c, piece_at(c, t))
    return doubles_at(c.room + 8 * COLOURS, AHEAD)[place // 2] / c.A
