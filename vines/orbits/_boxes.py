"""Where smooth functions may vanish together: subdivision of a box, parts left out by their Chebyshev coefficients."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

__all__ = ["NODES", "common_zeros"]

Floats = npt.NDArray[np.float64]

_ORDER = 8
NODES: Floats = 0.5 - 0.5 * np.cos(np.pi * (np.arange(_ORDER) + 0.5) / _ORDER)
"""Chebyshev nodes in (0, 1) at which the functions are sampled, in each direction."""

_TO_COEFFICIENTS = (
    np.cos(np.pi * np.outer(np.arange(_ORDER), np.arange(_ORDER - 0.5, -0.5, -1)) / _ORDER)
    * (2.0 / _ORDER)
    * np.where(np.arange(_ORDER) == 0, 0.5, 1.0)[:, None]
)
_NOISE = 8.0
"""What rounding adds to the values shows in the last coefficients: so many times the largest of them is allowed for."""

_MOST = 60_000
"""Boxes of one size at most; more are left where the functions vanish on a curve."""


def common_zeros(
    sample: Callable[[Floats, float], Floats],
    tail: Callable[[Floats, float], Floats],
    dimension: int,
    first: int,
    levels: int,
) -> tuple[Floats, float, bool]:
    """Return boxes of the unit cube that may hold a common zero of some functions.

    A box is left out if for one of the functions the constant coefficient of its Chebyshev expansion there exceeds
    the sum of the moduli of all others and a bound of what the expansion does not resolve; others are bisected in each
    direction.

    Parameters
    ----------
    sample : callable
        Takes lower corners, shape (M, dimension), and a width; returns values, shape (M, K**dimension, F), at `NODES`.
    tail : callable
        Takes the same; returns by how much the functions may differ there from their interpolants, shape (M, F);
        -inf where it is known that they do not vanish together.
    dimension : int
        1 or 2.
    first : int
        Boxes in each direction to begin with.
    levels : int
        Bisections.

    Returns
    -------
    low : (M, dimension) float array
        Lower corners of the boxes that are left.
    width : float
    whole : bool
        False if there were too many boxes to go on to the last level.

    Examples
    --------
    A circle and a line that meet once in the unit square:

    >>> def sample(low, width):
    ...     x = (low[:, 0, None, None] + width * NODES[:, None] + 0 * NODES).reshape(len(low), -1)
    ...     y = (low[:, 1, None, None] + width * NODES + 0 * NODES[:, None]).reshape(len(low), -1)
    ...     return np.stack([x**2 + y**2 - 0.5, x - 2 * y + 0.3], axis=-1)
    >>> low, width, whole = common_zeros(sample, lambda low, width: np.zeros((len(low), 2)), 2, 4, 12)
    >>> print(whole, np.unique(np.round(low, 3), axis=0))
    True [[0.561 0.43 ]]
    """
    width = 1.0 / first
    low = np.array(list(itertools.product(range(first), repeat=dimension)), dtype=np.float64) * width
    steps = np.array(list(itertools.product((0.0, 0.5), repeat=dimension)))
    for level in range(levels + 1):
        low = low[_kept(sample(low, width), tail(low, width), dimension)]
        if level == levels or len(low) == 0:
            return low, width, True
        if len(low) * len(steps) > _MOST:
            return low, width, False
        low = np.asarray((low[:, None, :] + width * steps).reshape(-1, dimension))
        width /= 2
    return low, width, True


def _kept(values: Floats, tails: Floats, dimension: int) -> npt.NDArray[np.bool_]:
    """Say of each box whether all functions may vanish in it."""
    boxes, _, functions = values.shape
    grid = values.reshape(boxes, *[_ORDER] * dimension, functions)
    if dimension == 1:
        coefficients = np.einsum("ai,mif->maf", _TO_COEFFICIENTS, grid)
        noise = np.abs(coefficients[:, -2:]).max(axis=1)
    else:
        coefficients = np.einsum("ai,bj,mijf->mabf", _TO_COEFFICIENTS, _TO_COEFFICIENTS, grid, optimize=True)
        size = np.abs(coefficients)
        noise = np.maximum(size[:, -2:].max(axis=(1, 2)), size[:, :, -2:].max(axis=(1, 2)))
    flat = np.abs(coefficients.reshape(boxes, -1, functions))
    return np.all(flat[:, 0] <= flat[:, 1:].sum(axis=1) + tails + _NOISE * noise, axis=1)
