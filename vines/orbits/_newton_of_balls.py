"""Newton's method for a round of balls in parallel that closes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.orbits._release_of_balls import Release, Section, run_closed

__all__ = ["solve_round"]

Floats = npt.NDArray[np.float64]

_HALVINGS = 12
_EPS = 2.220446049250313e-16

_CLOSES = 1e-11
"""Defect, beside rounding, at which a round counts as closed."""


def solve_round(p: Any, section: Section, span: float, z: Floats, mirrored: bool, most: int) -> tuple[Floats, float]:
    """Solve for coordinates that come back after a span, or as their mirror image, by damped Newton steps.

    Parameters
    ----------
    p : Parallel
    section : Section
    span : float
    z : ndarray
        Where to begin.
    mirrored : bool
    most : int
        Rounds that may be run.

    Returns
    -------
    (z, defect)
        Coordinates, and what is left; inf where it does not converge.
    """
    z = z.copy()
    met = run_closed(p, section, span, z, mirrored=mirrored)
    if met is None:
        return z, math.inf
    defect, slope = met[1]
    size, runs = float(np.abs(defect).max()), 1
    while runs < most and size > 0.0:
        try:
            step = -np.linalg.solve(slope, defect)
        except np.linalg.LinAlgError:
            return z, math.inf
        share, better, longest = 1.0, math.inf, float(np.abs(step).max())
        least = 4.0 * _EPS * (span + float(np.abs(z).max()))
        trial = z
        while share > 0.5**_HALVINGS and runs < most:
            trial = z + share * step
            met = run_closed(p, section, span, trial, mirrored=mirrored)
            runs += 1
            if met is not None:
                defect, slope = met[1]
                better = float(np.abs(defect).max())
                if better < size:
                    break
            if share * longest < 16.0 * least:
                break
            share *= 0.5
        if not better < size:
            break
        z, size = trial, better
        if share == 1.0 and longest < least:
            break
    if isinstance(section, Release):
        z[0] %= 2.0 * math.pi
    rounding = 64.0 * _EPS * (span + float(np.abs(z).max())) * (1.0 + float(np.abs(slope).max()))
    return z, (size if size < max(_CLOSES, rounding) else math.inf)
