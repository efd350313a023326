"""The rows of a run with several balls: a channel a body, impacts and sticks with the number of the ball."""

from __future__ import annotations

import numpy as np

from vines.errors import SchemaError
from vines.logs._channels import BALL, BALLS, OF_BALLS, Channel, Rows, as_rows
from vines.schema import numpy_dtype

__all__ = ["ball_rows", "has_balls", "rows_of_ball"]


def has_balls(states: np.ndarray) -> bool:
    """Return whether states have columns of numbered balls."""
    return "x2_1" in (states.dtype.names or ())


def ball_rows(states: np.ndarray, impacts: np.ndarray, sticks: np.ndarray) -> list[Rows]:
    """Return the rows of all channels of a run with several balls.

    Parameters
    ----------
    states : numpy.ndarray, shape (n,), structured
        Samples with the fields of ``vines.v1.Oscillator`` and of each ball those of ``vines.v1.Ball`` with its number,
        as `x2_1`.
    impacts, sticks : numpy.ndarray, shape (n,), structured
        Rows with the fields of ``vines.v1.BallImpact`` and ``BallStick``.

    Raises
    ------
    SchemaError
        If the arrays do not fit the schema.
    """
    every = zip((states, impacts, sticks), OF_BALLS, strict=True)
    rows = [as_rows(array, channel) for array, channel in every]
    names = states.dtype.names or ()
    balls = [channel for channel in BALLS if f"x2_{channel.key}" in names]
    return [*rows, *(as_rows(rows_of_ball(states, channel), channel) for channel in balls)]


def rows_of_ball(states: np.ndarray, channel: Channel) -> np.ndarray:
    """Return the fields of ``vines.v1.Ball`` of one ball, from states that have them with its number."""
    dtype = numpy_dtype(BALL)
    own = np.empty(len(states), dtype)
    for name in dtype.names or ():
        column = name if name == channel.time else f"{name}_{channel.key}"
        if column not in (states.dtype.names or ()):
            raise SchemaError(f"states lack {column}; each ball needs the fields of {BALL} with its number")
        own[name] = states[column]
    return own
