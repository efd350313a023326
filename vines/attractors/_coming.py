"""Whether a run that repeats ever better comes to a periodic orbit, and how long it still needs."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._approach import STABLE, UNSTABLE, comes_to_orbit, note_coming
from vines.attractors._multipliers import multipliers
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import tangent_product
from vines.kernels import cold_njit, complex_vector, njit

__all__ = ["comes", "note_decay"]

FITS = 2.0
"""Factor up to which a decay that was seen may differ from that of the linear map for the two to be the same."""


@cold_njit
def comes(c, rows, kept, p, lag, filled, newest, oldest, scale, near, tolerance, verdict):
    """Say whether a run comes to a periodic orbit; if so, note how long it still needs.

    Either its difference to its own repetition halves over the window, or it falls as the linear map of one repetition
    says: next to a slowly attracting orbit that shows in a short window already.

    Parameters
    ----------
    c : Constants
    rows, kept, scale, near, tolerance
        As for `comes_to_orbit`.
    p, lag : int
        Forcing periods and contacts of one repetition.
    filled : int
        Repetitions that can be compared with the one before.
    newest, oldest : float
        Differences of the last and the first of them, the last being the smaller one.
    verdict : ndarray
        REMAINING, REASON and VALUE are set where the run comes to an orbit.
    """
    seen_rate = math.log(oldest / newest) / max((filled - 1.0) * p, 1.0)
    halved = newest < 0.5 * oldest
    seen = comes_to_orbit(c, rows, kept, scale, near, tolerance, verdict)
    if seen == STABLE:
        return halved or _fits(seen_rate, verdict[v.VALUE])
    # What comes near an unstable orbit will leave it again.
    if seen == UNSTABLE:
        return False
    if halved:
        note_decay(verdict, newest, p, seen_rate, tolerance)
        return True
    count = kept.shape[0]
    first, end = kept[count - 1 - lag], kept[count - 1]
    for i in range(first + 1, end + 1):
        if rows[i, col.KIND] == col.STICK:
            # The closing equations do not hold; the map of the run's own repetition is as near.
            Y = tangent_product(c, rows, first, end)
            largest = multipliers(Y, complex_vector(Y.shape[0]))
            left = largest ** (1.0 / p)
            if _fits(seen_rate, left):
                note_decay(verdict, newest, p, -math.log(left), tolerance)
                return True
            break
    return False


@njit
def _fits(rate, left):
    """Say whether a rate of decay that was seen is that of a map which leaves such a part of a distance each period."""
    if not 0.0 < left < 1.0:
        return False
    expected = -math.log(left)
    return expected < FITS * rate and rate < FITS * expected


@njit
def note_decay(verdict, difference, p, rate, tolerance):
    """Note that a run comes to a periodic orbit, repeating after p periods to a difference that falls as exp(-rate t).

    Time is in forcing periods.
    """
    left = difference / -math.expm1(-rate * p)
    note_coming(verdict, max(math.log(left / tolerance) / rate, 0.0), math.exp(-rate))
