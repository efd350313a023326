"""Gaussian elimination inside kernels: LAPACK takes a second to compile into each kernel that calls it."""

from __future__ import annotations

from vines.kernels import linked_njit

__all__ = ["eliminate"]


@linked_njit
def eliminate(matrix, right):
    """Solve matrix x = right in place by Gaussian elimination with partial pivoting.

    Parameters
    ----------
    matrix : (N, N) float array
        Its place is used.
    right : (N, M) float array
        Receives x, if the matrix is regular; M may be 0.

    Returns
    -------
    (regular, determinant)
        The determinant may underflow where the matrix is regular.
    """
    N = matrix.shape[0]
    columns = right.shape[1]
    det = 1.0
    for k in range(N):
        pivot = k
        for i in range(k + 1, N):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if not abs(matrix[pivot, k]) > 0.0:
            return False, 0.0
        if pivot != k:
            det = -det
            for j in range(N):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            for j in range(columns):
                right[k, j], right[pivot, j] = right[pivot, j], right[k, j]
        det *= matrix[k, k]
        for i in range(k + 1, N):
            factor = matrix[i, k] / matrix[k, k]
            for j in range(k + 1, N):
                matrix[i, j] -= factor * matrix[k, j]
            for j in range(columns):
                right[i, j] -= factor * right[k, j]
    for k in range(N - 1, -1, -1):
        for j in range(columns):
            total = right[k, j]
            for i in range(k + 1, N):
                total -= matrix[k, i] * right[i, j]
            right[k, j] = total / matrix[k, k]
    return True, det
