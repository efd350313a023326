"""Formulas: exact, and nothing but formulas."""

import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vines.errors import ParameterError
from vines.model import Expression

decimals = st.decimals(min_value=0, max_value=10, places=25).map(lambda each: f"{each:f}")


@given(decimals, decimals)
def test_decimals_are_exact_however_long(first, second):
    text = f"({first} + {second}*a)/-(3 - 7)"
    assert Expression(text).value({"a": Fraction(2)}) == (Fraction(first) + 2 * Fraction(second)) / 4


@pytest.mark.parametrize(
    "text",
    [
        "",
        "mu_1 +",
        "mu_1 ** 2",
        "mu_1 if 1 else 2",
        "__import__('os')",
        "sin(mu_1)",
        "mu_1.real",
        "'a'",
        "True",
        "1j",
        "0x10",
        "a[0]",
        "a, b",
        "a < b",
        "a // b",
        "lambda: 1",
        "(" * 150 + "1" + ")" * 150,
        "a=1",
        3,
    ],
)
def test_anything_else_is_refused_in_one_line(text):
    with pytest.raises(ParameterError, match="is no formula") as caught:
        Expression(text)
    assert "\n" not in str(caught.value)


def test_what_has_no_value_is_named():
    with pytest.raises(ParameterError, match=re.escape("names 'mu_3': did you mean 'mu_2'?")):
        Expression("mu_3").value({"mu_2": Fraction(1)})
    with pytest.raises(ParameterError, match="divides by 0"):
        Expression("1/(a - a)").value({"a": Fraction(1)})


def test_spaces_do_not_count_and_names_are_told():
    assert Expression(" 0.02-mu_1 ").canonical == Expression("0.02 - mu_1").canonical
    assert Expression("a*(b + a)").names == ("a", "b")
