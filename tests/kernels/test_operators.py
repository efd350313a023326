"""What an operator does to plain types is worked out once, and stays right for every combination of them."""

import math

import numpy as np
import pytest
from numba.core.types.functions import BaseFunction

from vines.kernels import fused_njit, njit


def arithmetic(a, b):
    return a + b, a - b, a * b, a / b, a // b, a % b, a < b, a == b, -a, abs(b), max(a, b)


@pytest.mark.parametrize(
    ("a", "b"),
    [
        (7, 2),
        (7, 2.5),
        (7.25, 2),
        (-7.25, 2.5),
        (True, 3),
        (np.float32(1.5), np.float32(2.5)),
    ],
)
@pytest.mark.parametrize("decorator", [njit, fused_njit])
def test_numbers_of_every_type_give_what_python_gives(decorator, a, b):
    @decorator
    def once(a, b):
        return arithmetic_kernel(a, b)

    @decorator
    def again(a, b):
        return arithmetic_kernel(b, a)

    arithmetic_kernel = njit(arithmetic)
    for kernel, expected in ((once, arithmetic(a, b)), (again, arithmetic(b, a))):
        found = kernel(a, b)
        assert found == pytest.approx([float(value) for value in expected], rel=1e-6)
        assert [isinstance(value, bool) for value in found[6:8]] == [True, True]


def test_arrays_literals_and_functions_of_c():
    @njit
    def kernel(values, index):
        values[index] = math.sqrt(values[0] + 2) * 3
        return values[index] + values[-1], values[1:].sum(), (values * 2)[0], complex(1.0, 2.0) * values[0]

    values = np.array([7.0, 1.0, 4.0])
    assert kernel(values, 1) == (13.0, 13.0, 14.0, complex(7.0, 14.0))


def test_each_is_worked_out_once(monkeypatch):
    tried = []
    remembering = BaseFunction.get_call_type
    assert remembering.remembers
    work_out = next(
        cell.cell_contents
        for name, cell in zip(remembering.__code__.co_freevars, remembering.__closure__, strict=True)
        if name == "work_out"
    )
    for name, cell in zip(remembering.__code__.co_freevars, remembering.__closure__, strict=True):
        if name == "work_out":
            monkeypatch.setattr(cell, "cell_contents", lambda *of: tried.append(of[0]) or work_out(*of))

    @njit
    def sums(a, b):
        return a + b + a + b + a + b

    assert sums(1.5, 2.5) == 12.0
    first = len(tried)

    @njit
    def more(a, b):
        return (a + b) + (b + a) + a

    assert more(1.5, 2.5) == 9.5
    assert len(tried) == first
