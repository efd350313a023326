"""Where numba is led a shorter way it does what Python does: elements, loops, tuples passed whole, closures, copies."""

from __future__ import annotations

from types import FunctionType
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

from vines.kernels import entry_njit, linked_njit, njit


class Inner(NamedTuple):
    x: float
    y: float


class Mixed(NamedTuple):
    inner: Inner
    n: int
    z: complex


def elements(a, b, c, i, small):
    a[i] = b[i, -1] + c[-1, i, 1]
    b[0, i] = a[-1] + a[small]
    b[1, 0], c[i, i, i] = i, 2
    b[-1][i] += 1.0
    return a[i] * b[1, i] - c[i, 0, -1] + a[1:][0]


def rounds(n, m, step):
    found = 0
    for k in range(n):
        found = 3 * found + k
    for k in range(m, n):
        found = 3 * found - k
    for k in range(m, n, step):
        found = 3 * found + 2 * k
    for k in range(n, m, -1):
        found += k
    kept = range(m, n)
    return found, len(kept), sum([k * k for k in kept])


def closures(values, n):
    def twice(x):
        return 2 * x

    total = 0
    for each in [twice(k) for k in range(n)]:
        total += each
    return total + np.array([1.0, 2.0])[1] * values[0]


@pytest.mark.parametrize("order", ["C", "F", "every other"])
def test_elements_are_those_of_numpy(order: str) -> None:
    kernel = numba.njit(elements)
    of = np.random.default_rng(3).normal(size=42)

    def arrays():
        a, b, c = of[:3].copy(), of[3:12].reshape(3, 3).copy(), of[12:39].reshape(3, 3, 3).copy()
        if order == "F":
            return a, np.asfortranarray(b), np.asfortranarray(c)
        return (a, b, c) if order == "C" else (np.repeat(a, 2)[::2], np.repeat(b, 2, axis=1)[:, ::2], c[::-1])

    for i, small in ((0, np.int8(-3)), (-1, np.int8(2)), (1, np.uint8(1)))[: 3 if order == "C" else 2]:
        there, here = arrays(), arrays()
        assert kernel(*there, i, small) == pytest.approx(elements(*here, i, small), rel=1e-15)
        for one, other in zip(there, here, strict=True):
            assert np.array_equal(one, other)


def test_loops_have_the_rounds_of_python() -> None:
    kernel = numba.njit(rounds)
    for n in (-2, 0, 1, 5):
        for m in (-3, 0, 2, 9):
            for step in (1, 2, -1):
                assert kernel(n, m, step) == rounds(n, m, step)


@linked_njit
def _by_symbol(of, more):
    return of.inner.x - 2.0 * of.inner.y + of.n * of.z.imag + more.y


@njit
def _copied(of, k):
    return Mixed(Inner(of.inner.y, of.inner.x), of.n + k, of.z * 1j)


@entry_njit
def _through(of, values):
    for k in range(values.shape[0]):
        of = _copied(of, k)
        values[k] = _by_symbol(of, of.inner)
    return of


def test_tuples_pass_from_kernel_to_kernel_and_to_python() -> None:
    of, values, expected = Mixed(Inner(1.5, -2.0), 3, 1.0 + 2.0j), np.zeros(4), np.zeros(4)
    plain: Any = _through
    assert _through(of, values) == plain.py_func(of, expected)
    assert np.array_equal(values, expected)


def test_closures_and_arrays_of_lists_are_still_taken_apart() -> None:
    # numba asks the module of a kernel whether it is of vines.
    ours = FunctionType(closures.__code__, {**globals(), "__name__": "vines.kernels.of_a_test"}, "ours")
    for function in (closures, ours):
        assert numba.njit(function)(np.array([3.0]), 4) == closures(np.array([3.0]), 4)
