"""Brent's method gives what scipy gives, bit for bit, and fails where scipy fails."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import root_scalar

from vines.orbits._root import bracketed_root

NUMBERS = st.floats(-3, 3, allow_subnormal=False)
SHAPES = {
    "cubic": lambda x, c: (x - c[0]) * (1 + (x - c[1]) ** 2),
    "flat": lambda x, c: (x - c[0]) ** 5 + 1e-9 * (x - c[0]),
    "waves": lambda x, c: math.sin(9 * (x - c[0])) + 0.3 * (x - c[1]),
    "step": lambda x, c: math.copysign(1.0, x - c[0]),
    "steep": lambda x, c: math.expm1(20 * (x - c[0])),
    "nan on the way": lambda x, c: math.nan if abs(x - c[0]) < 0.4 else x - c[0],
    "nan on one side": lambda x, c: math.sqrt(x - c[0]) - 0.1 if x > c[0] else math.nan if x > c[1] else -1.0,
    "two levels": lambda x, c: math.floor(4 * (x - c[0])) + 0.5,
}


@pytest.mark.parametrize("shape", SHAPES)
@given(c=st.tuples(NUMBERS, NUMBERS), a=NUMBERS, b=NUMBERS, xtol=st.sampled_from([1e-15, 1e-14, 1e-3]))
def test_the_root_and_the_path_to_it_are_those_of_scipy(shape, c, a, b, xtol):
    def ours(x):
        mine.append(x)
        return SHAPES[shape](x, c)

    def theirs(x):
        other.append(x)
        return SHAPES[shape](x, c)

    mine, other = [], []
    try:
        root = root_scalar(theirs, bracket=(a, b), method="brentq", xtol=xtol, rtol=1e-14).root
    except ValueError:
        with pytest.raises(ValueError, match="different signs"):
            bracketed_root(ours, a, b, xtol=xtol, rtol=1e-14)
        return
    assert bracketed_root(ours, a, b, xtol=xtol, rtol=1e-14) == root
    assert mine == other
