"""Where a laser lost its target: values that stay while the motion goes on, and wild samples that no motion has.

Samples at the end of the range are those of `clipped_samples`; here is what lies inside of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.uncertainty import robust_deviation

__all__ = ["Lost", "lost_signal"]

Flags = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]

_HELD = 6
"""Equal samples in a row, at least, that are a held value."""
_LEAVES = 4.0
"""Steps of the converter by which a value must move on from one that was held, at least."""
_WILD = 30.0
"""Deviations of the second differences that no motion has."""
_WIDTH = 5
"""Samples of the median from which a wild one is told."""


@dataclass(frozen=True, slots=True, eq=False)
class Lost:
    """Samples without signal.

    Attributes
    ----------
    held, wild : ndarray of bool, shape (n,)
        Values that stayed, and single wild ones.
    """

    held: Flags
    wild: Flags


def lost_signal(values: Floats) -> Lost:
    """Return which samples of a displacement or velocity, measured by light, hold no signal.

    Parameters
    ----------
    values : ndarray, shape (n,)
        As recorded, without NaN.

    Notes
    -----
    A held value is a stretch of equal samples from which the next one leaps, by more than neighbours differ elsewhere
    and by some steps of the converter: of a slow motion that was recorded with few bits neighbouring levels differ by
    one. A wild sample differs from the median of five by far more than the motion turns within them.

    Examples
    --------
    >>> t = np.arange(20_000) / 20_000
    >>> sine = np.sin(2 * np.pi * 9 * t) + 1e-4 * np.random.default_rng(1).normal(size=len(t))
    >>> stuck = sine.copy()
    >>> stuck[3000:3200] = stuck[2999]
    >>> stuck[9000] += 0.3
    >>> found = lost_signal(stuck)
    >>> int(found.held.sum()), np.flatnonzero(found.wild).tolist(), int(lost_signal(sine).held.sum())
    (201, [9000], 0)
    """
    none = np.zeros(len(values), bool)
    if len(values) < 4 * _WIDTH or values.max() == values.min():
        return Lost(none, none.copy())
    step = np.diff(values)
    held = _held(values, step)
    # A quarter of a wild sample's leap is in the difference from the mean of its neighbours two away.
    near = np.abs(values[2:-2] - 0.5 * (values[:-4] + values[4:]))
    turn = robust_deviation(values[2:-2] - 0.5 * (values[:-4] + values[4:]))
    wild = none.copy()
    if turn > 0:
        for k in (np.flatnonzero(near > _WILD * turn) + 2).tolist():
            around = np.median(values[k - 2 : k + 3])
            if abs(values[k] - around) > _WILD * turn and not held[k]:
                wild[k] = True
    return Lost(held, wild)


def _held(values: Floats, step: Floats) -> Flags:
    """Return the samples of stretches that stay and then leap."""
    lost = np.zeros(len(values), bool)
    same = np.concatenate([[False], step == 0, [False]])
    edges = np.flatnonzero(np.diff(same.astype(np.int8)))
    first, last = edges[::2], edges[1::2]
    long = last - first + 1 >= _HELD
    first, last = first[long], last[long]
    if not len(first):
        return lost
    moves = np.abs(step[step != 0])
    least = float(moves.min())
    usual = float(np.quantile(moves, 0.99))
    for a, b in zip(first.tolist(), last.tolist(), strict=True):
        leap = abs(float(values[b + 1] - values[b])) if b + 1 < len(values) else np.inf
        if leap > max(_LEAVES * least, 2 * usual):
            lost[a : b + 1] = True
    return lost
