"""Floquet multipliers of a tangent map over one repetition, and what it does to a disturbance again and again."""

from __future__ import annotations

from vines.kernels import cold_njit, complex_matrix, njit
from vines.orbits.kernels import eigenvalues_kernel

__all__ = ["carry_on", "multipliers", "square_of"]


@cold_njit
def multipliers(Y, roots):
    """Fill `roots`, shape (n,), with the eigenvalues of a tangent map, the largest first; return its modulus."""
    n = Y.shape[0]
    H = complex_matrix(n, n)
    for i in range(n):
        for j in range(n):
            H[i, j] = complex(Y[i, j], 0.0)
    eigenvalues_kernel(H, roots)
    for i in range(1, n):
        root = roots[i]
        k = i
        while k > 0 and abs(roots[k - 1]) < abs(root):
            roots[k] = roots[k - 1]
            k -= 1
        roots[k] = root
    return abs(roots[0])


@njit
def carry_on(powers, k, away, later):
    """Fill `later` with what the map number k of `powers` makes of a disturbance; return its largest part."""
    size = 0.0
    for i in range(away.shape[0]):
        total = 0.0
        for j in range(away.shape[0]):
            total += powers[k, i, j] * away[j]
        later[i] = total
        size = max(size, abs(total))
    return size


@njit
def square_of(powers, k):
    """Make map number k + 1 of `powers` the square of number k."""
    n = powers.shape[1]
    for i in range(n):
        for j in range(n):
            total = 0.0
            for m in range(n):
                total += powers[k, i, m] * powers[k, m, j]
            powers[k + 1, i, j] = total
