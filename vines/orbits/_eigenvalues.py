"""Eigenvalues of a small matrix inside a kernel, where a call of LAPACK would take longer than all the rest."""

from __future__ import annotations

import cmath

import numpy as np

from vines.kernels import complex_vector, linked_njit, new_vector, njit

__all__ = ["eigenvalues_kernel"]

_EPS = 2.220446049250313e-16
_SWEEPS = 200


@njit
def _size(z):
    return abs(z.real) + abs(z.imag)


@linked_njit
def eigenvalues_kernel(H, out):
    """Fill `out`, shape (n,), with the eigenvalues of H, shape (n, n), complex, which is overwritten.

    Reduction to Hessenberg form by elimination with pivots, then QR sweeps with Wilkinson's shift and deflation (Golub
    and Van Loan, chapter 7). In no order; nan if the sweeps do not converge.
    """
    n = H.shape[0]
    for m in range(1, n - 1):
        pivot = m
        for i in range(m + 1, n):
            if _size(H[i, m - 1]) > _size(H[pivot, m - 1]):
                pivot = i
        if pivot != m:
            for j in range(n):
                H[pivot, j], H[m, j] = H[m, j], H[pivot, j]
            for i in range(n):
                H[i, pivot], H[i, m] = H[i, m], H[i, pivot]
        if H[m, m - 1] != 0.0:
            for i in range(m + 1, n):
                factor = H[i, m - 1] / H[m, m - 1]
                if factor != 0.0:
                    H[i, m - 1] = 0.0
                    for j in range(m, n):
                        H[i, j] -= factor * H[m, j]
                    for k in range(n):
                        H[k, m] += factor * H[k, i]
    high = n - 1
    low = 0
    cosines = new_vector(n)
    sines = complex_vector(n)
    for sweep in range(_SWEEPS):
        while high >= 0:
            low = high
            while low > 0 and _size(H[low, low - 1]) > _EPS * (_size(H[low, low]) + _size(H[low - 1, low - 1])):
                low -= 1
            if low < high - 1:
                break
            if low == high:
                out[high] = H[high, high]
                high -= 1
            else:
                one, other = _pair(H[low, low], H[low, high], H[high, low], H[high, high])
                out[low], out[high] = one, other
                high -= 2
        if high < 0:
            return
        one, other = _pair(H[high - 1, high - 1], H[high - 1, high], H[high, high - 1], H[high, high])
        shift = one if _size(one - H[high, high]) < _size(other - H[high, high]) else other
        if sweep % 10 == 9:
            # A shift that has nothing to do with the matrix breaks cycles.
            shift = H[high, high] + 0.75 * _size(H[high, high - 1])
        for k in range(low, high + 1):
            H[k, k] -= shift
        for k in range(low, high):
            a, b = H[k, k], H[k + 1, k]
            length = np.sqrt(a.real**2 + a.imag**2 + b.real**2 + b.imag**2)
            if length == 0.0:
                cosines[k], sines[k] = 1.0, 0.0
                continue
            # The rotation [c s*; -s c] with c real after a phase is taken out of a.
            modulus = np.sqrt(a.real**2 + a.imag**2)
            turn = a / modulus if modulus > 0.0 else complex(1.0, 0.0)
            cosine, sine = modulus / length, b * turn.conjugate() / length
            cosines[k], sines[k] = cosine, sine
            for j in range(k, high + 1):
                x, y = H[k, j], H[k + 1, j]
                H[k, j] = cosine * x + sine.conjugate() * y
                H[k + 1, j] = cosine * y - sine * x
        for k in range(low, high):
            cosine, sine = cosines[k], sines[k]
            for i in range(low, min(k + 2, high) + 1):
                x, y = H[i, k], H[i, k + 1]
                H[i, k] = cosine * x + sine * y
                H[i, k + 1] = cosine * y - sine.conjugate() * x
        for k in range(low, high + 1):
            H[k, k] += shift
    for k in range(high + 1):
        out[k] = complex(np.nan, np.nan)


@njit
def _pair(a, b, c, d):
    """Return the eigenvalues of [[a, b], [c, d]], both without cancellation in their distances to d."""
    half = 0.5 * (a - d)
    root = cmath.sqrt(half * half + b * c)
    if half.real * root.real + half.imag * root.imag < 0.0:
        root = -root
    far = half + root
    near = -b * c / far if far != 0.0 else complex(0.0, 0.0)
    return d + far, d + near
