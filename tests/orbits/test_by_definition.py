"""Bifurcations by what defines them, in mpmath: the orbit closes, and its map has the multiplier that is said.

Nothing of the package takes part but the values that are checked: impact maps are those of `conftest`, solved for the
next impact in 40 digits; the derivative of the map over a period comes from central differences. One step of Newton's
method in all unknowns at once, from our values, then says how far these are from the solution.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mpmath as mp
import pytest

from vines.model import Params
from vines.orbits import (
    Orbit,
    continue_orbit,
    find_orbit,
    follow_cascade,
    follow_curve,
    switch_branch,
)

P = Params(mu=0.01, A=0.017)
STEP = mp.mpf("1e-12")
DIGITS = 40


class Exactly:
    """Parameters in the precision of mpmath, as the independent model takes them."""

    def __init__(self, values: dict[str, Any]) -> None:
        self.values = values
        self.Omega = values["Omega"]

    def as_dict(self) -> dict[str, Any]:
        return self.values


def _returns(independent: Any, orbit: Orbit, values: dict[str, Any], z: Sequence[Any]) -> list[Any]:
    """Return what (v1, v2, x2, t) before the first impact has become a period of the orbit later, less that period."""
    q = Exactly(values)
    sides = [int(side) for side in orbit.side]
    later = [*orbit.t[1:], orbit.t[0] + orbit.period]
    now = list(z)
    for side, other, began, ended in zip(sides, [*sides[1:], sides[0]], orbit.t, later, strict=True):
        now = independent.map_to(q, side, other, now, float(ended - began))
    now[3] -= 2 * mp.pi * orbit.word.p / q.Omega
    return now


def _monodromy(independent: Any, orbit: Orbit, values: dict[str, Any], z: Sequence[Any]) -> Any:
    J = mp.matrix(4, 4)
    for j in range(4):
        up, down = ([*z[:j], z[j] + sign * STEP, *z[j + 1 :]] for sign in (1, -1))
        one, other = (_returns(independent, orbit, values, each) for each in (up, down))
        for i in range(4):
            J[i, j] = (one[i] - other[i]) / (2 * STEP)
    return J


def _characteristic(J: Any, rho: int) -> Any:
    return mp.det(J - rho * mp.eye(4))


def _has(*multipliers: int) -> Callable[[Any], list[Any]]:
    return lambda J: [_characteristic(J, rho) for rho in multipliers]


def _double_one(J: Any) -> list[Any]:
    """Return the characteristic polynomial and its derivative at 1: two multipliers 1."""
    h = mp.mpf("1e-6")
    slope = (mp.det(J - (1 + h) * mp.eye(4)) - mp.det(J - (1 - h) * mp.eye(4))) / (2 * h)
    return [_characteristic(J, 1), slope]


def _off(independent: Any, orbit: Orbit, names: Sequence[str], conditions: Callable[[Any], list[Any]]) -> list[float]:
    """Return by how much a step of Newton's method moves the parameters of these names, relative to them."""
    with mp.workdps(DIGITS):
        own = {name: mp.mpf(value) for name, value in orbit.params.as_dict().items()}
        _, v1, x2, v2 = (mp.mpf(float(value)) for value in orbit.states[0])
        start = [v1, v2, x2, mp.mpf(float(orbit.t[0])), *(own[name] for name in names)]

        def equations(unknown: Sequence[Any]) -> list[Any]:
            values = own | dict(zip(names, unknown[4:], strict=True))
            z = list(unknown[:4])
            closes = [after - before for after, before in zip(_returns(independent, orbit, values, z), z, strict=True)]
            return [*closes, *conditions(_monodromy(independent, orbit, values, z))]

        n = len(start)
        here = equations(start)
        J = mp.matrix(n, n)
        h = mp.mpf("1e-9")
        for j in range(n):
            moved = equations([*start[:j], start[j] + h, *start[j + 1 :]])
            for i in range(n):
                J[i, j] = (moved[i] - here[i]) / h
        step = mp.lu_solve(J, -mp.matrix(here))
        return [abs(float(step[4 + k] / own[name])) for k, name in enumerate(names)]


CONDITION = {"fold": _has(1), "symmetry_breaking": _has(1), "period_doubling": _has(-1)}


def test_the_doublings_of_a_cascade(independent: Any) -> None:
    branches = follow_cascade(find_orbit("LR", P), "A", 0.024, depth=2)
    doublings = [b for branch in branches for b in branch.bifurcations if b.type == "period_doubling"]
    words = sorted({str(b.orbit.word) for b in doublings}, key=len)
    assert words[:2] == ["LR", "LRLR/2T"]
    for word in words[:2]:
        b = next(each for each in doublings if str(each.orbit.word) == word)
        [off] = _off(independent, b.orbit, ["A"], CONDITION["period_doubling"])
        assert off < 1e-9, word


def test_the_3_to_1_family(independent: Any) -> None:
    orbit = find_orbit("LLLR", P.replace(mu=0.1, A=0.2))
    found = [
        b
        for stop in (0.05, 0.6)
        for b in continue_orbit(orbit, "A", stop, within=(0.05, 0.6), beyond_grazing=True).bifurcations
        if b.type in CONDITION
    ]
    assert found
    for b in found[:3]:
        [off] = _off(independent, b.orbit, ["A"], CONDITION[b.type])
        assert off < 1e-8, b


@pytest.fixture(scope="module")
def pair() -> Any:
    up = continue_orbit(find_orbit("LR", P), "A", 0.03)
    broken = next(b for b in up.bifurcations if b.type == "symmetry_breaking")
    return continue_orbit(switch_branch(broken)[0], "A", 0.03)


def test_a_curve_of_doublings_in_amplitude_and_restitution(independent: Any, pair: Any) -> None:
    doubling = next(b for b in pair.bifurcations if b.type == "period_doubling")
    curve = follow_curve(doubling, ("A", "r"), box={"A": (0.015, 0.03), "r": (0.5, 0.8)}, step=0.05)
    assert len(curve.orbits) >= 5
    for orbit in (curve.orbits[0], curve.orbits[len(curve.orbits) // 2], curve.orbits[-1]):
        [off] = _off(independent, orbit, ["A"], CONDITION["period_doubling"])
        assert off < 1e-9


def test_a_point_of_codimension_two(independent: Any) -> None:
    two = continue_orbit(find_orbit("LLR", P.replace(A=0.023)), "A", 0.0205, within=(0.0205, 0.1), step=0.005)
    fold = next(b for b in two.bifurcations if b.type == "fold")
    [met] = follow_curve(fold, box={"A": (0.002, 0.2), "mu": (0.001, 0.2)}).special
    assert met.type == "resonance_1_1"
    assert max(_off(independent, met.orbit, ["A", "mu"], _double_one)) < 1e-6
