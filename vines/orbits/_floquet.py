"""Floquet multipliers of a periodic orbit from the Jacobians of its maps (paper, section 4.2).

The maps act on (v1, v2, x2, t) just before an impact: four multipliers, none of them trivial, because the
forcing fixes the origin of time. A symmetric orbit is a fixed point of the half map H = S P, with
S = diag(-1, -1, -1, 1) and P the maps of its first half, so that its multipliers are the squares of those of H
(docs/orbits.md).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["FIXED_TIME", "IMPACT_TO_IMPACT", "half_map", "monodromy", "sorted_multipliers", "squared"]

Floats = npt.NDArray[np.float64]
Multipliers = npt.NDArray[np.complex128]
IMPACT_TO_IMPACT = np.array([-1.0, -1.0, -1.0, 1.0])
"""What the mirror image does to (v1, v2, x2, t)."""

FIXED_TIME = np.array([-1.0])
"""What it does to each number of a disturbance at a fixed time."""


def monodromy(jacobians: Floats) -> Floats:
    """Return the product J_N … J_1 of the Jacobians of consecutive maps, shape (N, d, d) to (d, d)."""
    product = np.eye(jacobians.shape[1])
    with np.errstate(invalid="ignore"):  # an impact at zero speed has no Jacobian
        for J in jacobians:
            product = J @ product
    return product


def half_map(jacobians: Floats, mirror: Floats) -> Floats:
    """Return the Jacobian of H = S P of a symmetric orbit, whose square is its monodromy matrix, S = diag(mirror)."""
    return mirror[:, None] * monodromy(jacobians[: len(jacobians) // 2])


def sorted_multipliers(matrix: npt.NDArray[Any]) -> Multipliers:
    """Return the eigenvalues, the largest modulus first, of a pair the one in the upper half plane first.

    They are infinite where the matrix is: an impact at zero speed has no Jacobian.

    Examples
    --------
    >>> print(sorted_multipliers(np.diag([0.5, -2.0, 0.0, 1.0])).real)
    [-2. 1. 0.5 0. ]
    """
    if not np.isfinite(matrix).all():
        return np.full(len(matrix), complex(np.inf))
    return _sorted(np.linalg.eigvals(matrix).astype(complex))


def squared(half: Multipliers) -> Multipliers:
    """Return the multipliers over the whole period from those of the half map, in the same order of precedence."""
    return _sorted(half**2) if np.isfinite(half).all() else half


def _sorted(values: Multipliers) -> Multipliers:
    return values[np.lexsort((-values.imag, -values.real, -np.abs(values)))]
