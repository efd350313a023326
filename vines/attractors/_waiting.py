"""For how long a run that has not settled is let go on before it is looked at again."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["next_wait"]

Floats = npt.NDArray[np.float64]


def next_wait(remaining: npt.ArrayLike, spare: npt.ArrayLike, *, few_lengths: bool) -> Floats:
    """Return the next wait: 5 % more than is left, in whole forcing periods, but no more than is allowed.

    Parameters
    ----------
    remaining : array_like
        Estimated forcing periods that are left.
    spare : array_like
        Forcing periods that may still be waited.
    few_lengths : bool
        Whether to wait up to the next of 32, 48, 64, 96, 128, … forcing periods: runs that wait equally long keep
        the lanes full.

    Examples
    --------
    >>> next_wait([10.0, 100.0, 900.0], 400.0, few_lengths=False)
    array([ 12., 106., 400.])
    >>> next_wait([10.0, 100.0, 900.0], 400.0, few_lengths=True)
    array([ 32., 128., 400.])
    """
    least = 1.05 * np.asarray(remaining, dtype=np.float64) + 1.0
    wait = _up_to_few(least) if few_lengths else np.ceil(least)
    return np.where(remaining > np.asarray(spare), spare, wait)


def _up_to_few(least: Floats) -> Floats:
    least = np.maximum(least, 32.0)
    power = 2.0 ** np.floor(np.log2(least))
    return np.where(least <= power, power, np.where(least <= 1.5 * power, 1.5 * power, 2.0 * power))
