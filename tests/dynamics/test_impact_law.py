"""The law of impact: momentum and restitution, in kernels as in Python; and it is written in one file only."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import vines
from vines.dynamics._impact_law import (
    after_impact,
    after_impact_kernel,
    impact_law,
    impact_law_kernel,
    reversing,
    reversing_kernel,
)

ROOMS = ("dynamics", "orbits", "attractors")
READERS = {"_lane_state.py", "_flights.py", "_equations.py", "_values.py", "_shortest.py", "_tails.py"}
"""Lanes and closing equations, which take what is exchanged, pass1 and pass2, as a number."""
CHAINS = {
    "_chains.py": "c.law",
    "_balls.py": "law",
    "_capsule.py": "c.law",
    "_dragged.py": "c.law",
    "_modal.py": "c.law",
}
"""Closing equations of any system, linear in the velocities at an impact: they take three coefficients of the law."""

SPEED = st.floats(-10.0, 10.0)


@given(mu=st.floats(1e-6, 10.0), r=st.floats(0.0, 1.0), v1=SPEED, v2=SPEED)
def test_an_impact_keeps_momentum_and_returns_r_of_the_closing_speed(mu: float, r: float, v1: float, v2: float) -> None:
    law = impact_law(mu, r)
    assert impact_law_kernel(mu, r) == law
    after1, after2 = after_impact(law, v1, v2)
    size = 1e-14 * (1.0 + mu) * (1.0 + abs(v1) + abs(v2))
    assert after1 + mu * after2 == pytest.approx(v1 + mu * v2, abs=size)
    assert after2 - after1 == pytest.approx(r * (v1 - v2), abs=size)
    assert after_impact_kernel(law, v1, v2) == pytest.approx((after1, after2), abs=size)
    assert after1 == pytest.approx(v1 - law.pass1 * (v1 - v2), abs=size)
    assert after2 == pytest.approx(v2 + law.pass2 * (v1 - v2), abs=size)
    assert law.pass1 == pytest.approx(law.ratio * law.pass2, abs=size)


@given(mu=st.floats(0.0, 10.0), r=st.floats(0.0, 1.0))
def test_the_ball_is_just_turned_round(mu: float, r: float) -> None:
    law = impact_law(mu, r)
    kappa = reversing(law)
    assert kappa == pytest.approx((1.0 + 2.0 * mu - r) / (1.0 + r), abs=1e-14 * (1.0 + mu) ** 2)
    assert after_impact(law, kappa, -1.0)[1] == pytest.approx(1.0, abs=1e-14 * (1.0 + mu))
    assert reversing_kernel(law) == kappa


def test_arrays_go_through_the_law_as_numbers_do() -> None:
    v1, v2 = np.linspace(-1.0, 1.0, 7), np.linspace(2.0, -3.0, 7)
    law = impact_law(0.05, 0.65)
    assert np.column_stack(after_impact(law, v1, v2)).tolist() == [
        list(after_impact(law, *pair)) for pair in zip(v1.tolist(), v2.tolist(), strict=True)
    ]


def _named(node: ast.AST, name: str) -> bool:
    return (isinstance(node, ast.Name) and node.id == name) or (isinstance(node, ast.Attribute) and node.attr == name)


def _one(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1


def _is_the_law(node: ast.AST) -> bool:
    """Say whether an expression is 1 + r, mu - r, or 1 - r mu."""
    if not isinstance(node, ast.BinOp):
        return False
    left, right = node.left, node.right
    if isinstance(node.op, ast.Add):
        return (_one(left) and _named(right, "r")) or (_named(left, "r") and _one(right))
    if not isinstance(node.op, ast.Sub):
        return False
    if _named(left, "mu") and _named(right, "r"):
        return True
    factors = (right.left, right.right) if isinstance(right, ast.BinOp) and isinstance(right.op, ast.Mult) else ()
    return _one(left) and {name for name in ("mu", "r") for each in factors if _named(each, name)} == {"mu", "r"}


def _written(tree: ast.AST, reader: bool) -> Iterator[str]:
    for node in ast.walk(tree):
        coefficient = ("keep1", "keep2") if reader else ("keep1", "keep2", "pass1", "pass2")
        if _is_the_law(node) or (isinstance(node, ast.Attribute) and node.attr in coefficient):
            yield ast.unparse(node)


def test_no_other_file_writes_the_law() -> None:
    found: dict[str, list[str]] = {}
    for room in ROOMS:
        for path in sorted((Path(vines.__file__).parent / room).glob("*.py")):
            if lines := list(_written(ast.parse(path.read_text()), path.name in READERS)):
                found[path.name] = lines
    assert found.pop("_impact_law.py")
    # The trace of the fast motion's matrix, a closed form in r alone.
    assert found.pop("_reduced.py") == ["1 + r"]
    assert found == {name: [f"{law}.{each}" for each in ("pass1", "pass2", "keep2")] for name, law in CHAINS.items()}


@pytest.mark.parametrize(
    "text", ["v = (1 + p.r) * w", "(mu - r) / mass", "1.0 - r * mu", "1 - self.mu * self.r", "c.law.keep1 * v", "r + 1"]
)
def test_the_search_for_the_law_finds_it(text: str) -> None:
    assert list(_written(ast.parse(text), reader=True))
