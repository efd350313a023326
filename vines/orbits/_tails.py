"""How far the functions that vanish on orbits may lie from their Chebyshev interpolants: bounds, not estimates.

The functions of `sample_kernel` are entire in the coordinates of a box, and determinants. On a polydisc around the box
each entry of the matrix has a bound (that over kicks, velocities of the ball and (a, b, 1), which has no poles), and a
determinant is no larger than the product of the norms of its rows (Hadamard); where a divisor may vanish within the
polydisc the maximum principle moves the bound to a torus on which it does not. A function bounded by M within the
Bernstein ellipses of parameter rho is approximated by its interpolant in K nodes to within 4 M rho^(1-K)/(rho - 1) a
direction (Trefethen, Approximation Theory and Approximation Practice, theorem 8.2).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import Constants

__all__ = ["tails"]

Floats = npt.NDArray[np.float64]

_RADII = (0.3, 0.33, 0.36, 0.39)
"""Radii of the polydisc, in time, of which the one is taken that stays farthest from where a divisor vanishes."""

_LEAST = 0.75
"""Smallest radius, in widths of the box: it has to hold an ellipse around it."""

_LEBESGUE = 2.5
"""More than the Lebesgue constant of eight Chebyshev nodes, 2.3: what one direction does to the error of the other."""


def tails(
    c: Constants, span: float, flip: int, side: npt.NDArray[np.int64], half: bool, low: Floats, width: float, nodes: int
) -> Floats:
    """Return by how much the functions of `sample_kernel` may differ from their interpolants on boxes, shape (M, F).

    Parameters
    ----------
    c, span, flip, side
        As for `linear_kernel`.
    half : bool
        Whether they are divided by 1/2 - y.
    low : (M, N - 1) float array
        Lower corners of the boxes.
    width : float
    nodes : int
        Nodes of the interpolation in each direction.
    """
    dimension = low.shape[1]
    middle = low + 0.5 * width
    radius, gaps = _discs(middle, width, span, half)
    rho = _ellipse(radius, width)
    per_direction = 4.0 * rho ** (1.0 - nodes) / (rho - 1.0)
    share = per_direction.sum(axis=1) if dimension == 1 else per_direction @ np.array([1.0, _LEBESGUE])
    bound = _bounds(c, span, flip, side, half, middle, radius, gaps)
    return bound * share[:, None]


def _discs(middle: Floats, width: float, span: float, half: bool) -> tuple[Floats, dict[float, Floats]]:
    """Return radii of discs around the middle, shape (M, D), and how near their circles or discs come to 0, 1 and 1/2.

    A point outside the disc lies as far from it as from the circle; one inside is kept away from the circle alone.
    """
    points = (0.0, 1.0, 0.5) if half else (0.0, 1.0)
    radii = np.array(_RADII) * max(1.0 / span, _LEAST * width / _RADII[0])
    away = np.stack([np.abs(radii - np.abs(middle[..., None] - point)) for point in points])
    best = away.min(axis=0).argmax(axis=-1)
    radius = radii[best]
    return radius, {point: np.abs(radius - np.abs(middle - point)) for point in points}


def _ellipse(radius: Floats, width: float) -> Floats:
    """Return the parameter of the Bernstein ellipse around an interval that fits into the disc around it."""
    ratio = 2.0 * radius / width
    return ratio + np.sqrt(np.maximum(ratio**2 - 1.0, 0.0))


def _bounds(
    c: Constants,
    span: float,
    flip: int,
    side: npt.NDArray[np.int64],
    half: bool,
    middle: Floats,
    radius: Floats,
    gaps: dict[float, Floats],
) -> Floats:
    """Return bounds of the functions within the discs, shape (M, F)."""
    N = len(side)
    steps = [abs((flip * side[0] if j == N - 1 else side[j + 1]) - side[j]) for j in range(N)]
    if N == 2:
        y, r = middle[:, 0], radius[:, 0]
        least = [span * gaps[0.0][:, 0], span * gaps[1.0][:, 0]]
        most = [span * (y + r), span * (1.0 - y + r)]
        shift = span * r
        divisor = gaps[0.5][:, 0] if half else np.ones_like(y)
    else:
        (y, u), (r, q) = middle.T, radius.T
        rest, over = gaps[1.0][:, 0], 1.0 - y + r
        least = [span * gaps[0.0][:, 0], span * rest * gaps[0.0][:, 1], span * rest * gaps[1.0][:, 1]]
        most = [span * (y + r), span * over * (u + q), span * over * (1.0 - u + q)]
        # How far the times between any two impacts are displaced: y, (1 - y) u and their sum.
        shift = span * np.maximum(r, r * np.maximum(u + q, 1.0 - u + q) + (1.0 - y) * q)
        divisor = rest if steps[1] and steps[2] else np.ones_like(y)
    # A flight between equal walls is multiplied by in the matrix, but not in the functions.
    for step, tau in zip(steps, least, strict=True):
        if not step:
            divisor = divisor * tau
    gamma, damping = c.free.gamma, c.free.half
    s = complex(-damping, gamma)
    weight = abs(1.0 / (1.0 - flip * np.exp(s * span)))
    swing = weight * np.exp((damping + gamma) * shift)
    wave = np.cosh(c.Omega * shift)
    mu, e = c.law.ratio, c.law.pass1
    # Squares of the norms of the rows: over kicks in units of e and velocities of the ball, over a or b, over 1.
    flights = [
        (tau**2 + N * (2.0 * e * swing / gamma) ** 2, (2.0 * wave) ** 2, float(step) ** 2)
        for tau, step in zip(most, steps, strict=True)
    ]
    own, others = (1.0 + e * abs(s) * swing / gamma) ** 2, (N - 1) * (e * abs(s) * swing / gamma) ** 2
    laws = [(1.0 + own + others, (c.Omega * wave) ** 2, 0.0)] * N

    def minor(rows: int, waves: int, one: int) -> Floats:
        """Bound the minor of so many rows of the momentum, over the unknowns and so many of (a, b) and of 1."""
        square = (e**2 + 2.0 * mu**2) ** rows / divisor**2
        for known, sway, constant in (*flights, *laws):
            square = square * (known + waves * sway + one * constant)
        return np.sqrt(square)

    pair = 2.0 * minor(2, 1, 1) ** 2 + (c.free.qr**2 + c.free.qi**2) * minor(2, 2, 0) ** 2
    return np.stack([minor(3, 2, 1), pair, pair, pair] if N == 3 else [pair], axis=1)
