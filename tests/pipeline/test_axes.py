"""Axes: exact rationals rounded once, so that grids nest."""

from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vines.errors import DeclarationError
from vines.pipeline._axes import read_axis


def axis(form, *, interval=False):
    return read_axis("A", form, "f.toml: stages.up.vary.A", interval=interval)


def linear(low, high, count):
    return {"from": Decimal(low), "to": Decimal(high), "count": count}


def test_401_801_and_1201_points_share_what_they_can():
    coarse, finer, finest = (set(axis(linear("0.015", "0.023", n)).values()) for n in (401, 801, 1201))
    assert coarse < finer
    assert coarse < finest
    assert len(finer & finest) == 401


def test_a_longer_range_of_the_same_step_keeps_the_values():
    short, long = axis(linear("0.015", "0.023", 401)).values(), axis(linear("0.015", "0.031", 801)).values()
    assert long[:401] == short


@given(st.integers(1, 10**6), st.integers(1, 10**6), st.integers(2, 50), st.integers(2, 5))
def test_logarithmic_grids_nest_too(a, b, count, times):
    if a == b:
        return
    low, high = Decimal(min(a, b)) / 1000, Decimal(max(a, b)) / 1000
    coarse = axis({**linear(low, high, count), "log": True}).values()
    fine = axis({**linear(low, high, (count - 1) * times + 1), "log": True}).values()
    assert fine[::times] == coarse
    assert (coarse[0], coarse[-1]) == (float(low), float(high))
    assert list(fine) == sorted(fine)


def test_values_are_the_declared_decimals():
    assert axis(linear("0.1", "0.5", 5)).values() == (0.1, 0.2, 0.3, 0.4, 0.5)
    stepped = axis({"from": Decimal("0.1"), "to": Decimal("0.5"), "step": Decimal("0.1")})
    assert stepped.canonical() == axis(linear("0.1", "0.5", 5)).canonical()
    assert axis(linear("0.10", "0.50", 5)).canonical() == axis(linear("0.1", "0.5", 5)).canonical()
    assert axis([3, Decimal("0.1"), 2]).values() == (0.1, 2.0, 3.0)
    assert axis(linear("0.5", "0.1", 5)).values() == (0.1, 0.2, 0.3, 0.4, 0.5)


def test_an_interval_has_ends_and_no_values():
    ends = axis({"from": Decimal("0.1"), "to": 1}, interval=True)
    assert (ends.form, [float(end) for end in ends.ends]) == ("range", [0.1, 1.0])


@pytest.mark.parametrize(
    ("form", "words"),
    [
        ("0.1", "write { from"),
        ([], "at least one value"),
        ([1, 1], "twice"),
        ([True], "not a number"),
        ([Decimal("inf")], "finite"),
        ({"from": 0, "to": 1}, "either 'count' or 'step'"),
        ({"from": 0, "to": 1, "count": 3, "step": 1}, "either 'count' or 'step'"),
        ({"from": 0, "too": 1, "count": 3}, "did you mean 'to'"),
        ({"from": 0, "count": 3}, "'to' is missing"),
        ({"from": 0, "to": 1, "count": 0}, "whole number"),
        ({"from": 0, "to": 1, "count": 1}, "cannot be"),
        ({"from": 0, "to": 1, "count": Decimal("2.5")}, "whole number"),
        ({"from": 0, "to": 1, "step": Decimal("0.3")}, "whole number of steps"),
        ({"from": 0, "to": 1, "count": 3, "log": True}, "ends > 0"),
        ({"from": 1, "to": 2, "count": 3, "log": 1}, "allowed: true, false"),
    ],
)
def test_mistakes_are_one_line_with_file_and_key(form, words):
    with pytest.raises(DeclarationError) as caught:
        axis(form)
    assert words in str(caught.value)
    assert str(caught.value).startswith("f.toml: stages.up.vary.A")
    assert "\n" not in str(caught.value)
