"""The standard error of a share of independent starts."""

from __future__ import annotations

import math

from vines.domains import Number, stated

__all__ = ["share_error"]


@stated(share=Number(least=0, most=1), number=Number(least=0))
def share_error(share: float, number: float) -> float:
    """Return the standard error of a share of `number` independent starts.

    That of the binomial law if all shares are as likely before any start is seen: for many starts
    sqrt(share (1 - share)/number), and not 0 where none or all of a few came to the attractor.

    Examples
    --------
    >>> round(share_error(0.06, 1_000_000), 6), round(share_error(1.0, 3), 3)
    (0.000237, 0.163)
    """
    hits = share * number
    return math.sqrt((hits + 1.0) * (number - hits + 1.0) / (number + 3.0)) / (number + 2.0)
