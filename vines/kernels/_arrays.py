"""Arrays inside kernels, each way to make one compiled once.

numba writes into every function that calls numpy.empty what would format the message of a failure: some 5,000
instructions, more than most kernels have of their own. It is alike with reductions and with assignments of arrays.
"""

from __future__ import annotations

import math

import numpy as np

from vines.kernels._decorators import linked_njit

__all__ = [
    "byte_vector",
    "complex_matrix",
    "complex_vector",
    "copy_values",
    "identity",
    "integer_vector",
    "max_abs",
    "new_cube",
    "new_matrix",
    "new_vector",
    "zero_cube",
    "zero_integers",
    "zero_matrix",
    "zero_vector",
]


@linked_njit
def new_vector(n):
    """Return room for n doubles."""
    return np.empty(n)


@linked_njit
def new_matrix(n, m):
    """Return room for n by m doubles."""
    return np.empty((n, m))


@linked_njit
def new_cube(n, m, k):
    """Return room for n by m by k doubles."""
    return np.empty((n, m, k))


@linked_njit
def zero_vector(n):
    """Return n zeros."""
    return np.zeros(n)


@linked_njit
def zero_matrix(n, m):
    """Return n by m zeros."""
    return np.zeros((n, m))


@linked_njit
def zero_cube(n, m, k):
    """Return n by m by k zeros."""
    return np.zeros((n, m, k))


@linked_njit
def integer_vector(n):
    """Return room for n integers."""
    return np.empty(n, dtype=np.int64)


@linked_njit
def zero_integers(n):
    """Return n integers that are zero."""
    return np.zeros(n, dtype=np.int64)


@linked_njit
def byte_vector(n):
    """Return room for n integers of one byte."""
    return np.empty(n, dtype=np.int8)


@linked_njit
def complex_vector(n):
    """Return room for n complex numbers."""
    return np.empty(n, dtype=np.complex128)


@linked_njit
def complex_matrix(n, m):
    """Return room for n by m complex numbers."""
    return np.empty((n, m), dtype=np.complex128)


@linked_njit
def identity(n):
    """Return the identity of n by n doubles."""
    out = np.zeros((n, n))
    for k in range(n):
        out[k, k] = 1.0
    return out


@linked_njit
def copy_values(out, values):
    """Write a vector over the first places of another one.

    An assignment of arrays would bring the text of its error message into the kernel, which takes seconds to compile.
    """
    for k in range(values.shape[0]):
        out[k] = values[k]


@linked_njit
def max_abs(values):
    """Return the largest absolute value of a vector; nan if there is one in it."""
    largest = 0.0
    for k in range(values.shape[0]):
        size = abs(values[k])
        if size > largest or math.isnan(size):
            largest = size
    return largest
