"""The search for the best stable orbit: along branches, then in all free parameters at once."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound
from vines.model import V2, Params, Word
from vines.orbits._all import all_orbits
from vines.orbits._box import Box
from vines.orbits._branch import Branch
from vines.orbits._chart import Chart
from vines.orbits._continuation import continue_orbit
from vines.orbits._general import refine
from vines.orbits._orbit import Orbit
from vines.orbits._symmetric import symmetric_orbits

__all__ = ["Search"]

Floats = npt.NDArray[np.float64]

_INSIDE = 2e-6
"""How far inside the limit of the multipliers an optimum at a bifurcation is put, so that it is stable."""

_ACTIVE = 1e-4
"""A limit counts as active if the multipliers would pass it when it were lower by this part."""

_DIFFERENCE = 1e-5
"""Step of the differences in chart coordinates; orbits are exact to 1e-13, so slopes are to 1e-8."""

_SMALLEST = 1e-5
_ATTEMPTS = 25
_ROUNDING = 1e-8
_CANDIDATES = 4
_SEED_POINTS = 24
_PAIRS = tuple(itertools.combinations(range(4), 2))


class Search:
    """One search for the best orbit."""

    def __init__(self, word: Word, objective: str, box: Box, largest: float) -> None:
        self.word, self.objective, self.box, self.largest = word, objective, box, largest

    def cost(self, orbit: Orbit) -> float:
        """Return what is to be least."""
        if self.objective == "kinetic_ratio":
            return -orbit.measures.kinetic_ratio
        return self.box.b(orbit.params) * orbit.measures.max_abs_x1

    def allowed(self, orbit: Orbit) -> bool:
        """Say whether it is admissible, and stable with the multipliers inside their limit, in the box."""
        inside = np.abs(self.box.place(orbit.params) - 0.5).max() <= 0.5 + _ROUNDING
        return bool(inside and orbit.admissible and orbit.max_multiplier < self.largest)

    def slacks(self, orbit: Orbit, inside: float) -> Floats:
        """Return what has to be positive: fold, period doubling or loss of symmetry, Neimark-Sacker, grazing.

        As in docs/orbits.md, "Bifurcations", but of the multipliers divided by the radius that they are kept in.
        """
        half = orbit.half_multipliers
        radius = self.largest * (1 - inside)
        m = orbit.multipliers / radius if half is None else half / math.sqrt(radius)
        pairs = np.prod([1 - m[i] * m[j] for i, j in _PAIRS])
        grazing = min(orbit.min_clearance, float(np.min(orbit.side * orbit.w_dot)))
        return np.array([np.prod(1 - m).real, np.prod(1 + m).real, pairs.real, grazing - 1e-8])

    def active(self, orbit: Orbit) -> tuple[str, ...]:
        """Return the constraints that hold the orbit."""
        doubling = "period_doubling" if orbit.half_multipliers is None else "symmetry_breaking"
        slacks = self.slacks(orbit, _ACTIVE)
        slacks[3] -= 1e-6
        types = ("fold", doubling, "neimark_sacker", "grazing")
        held = [kind for kind, slack in zip(types, slacks, strict=True) if slack <= 0]
        places = list(zip(self.box.over, self.box.place(orbit.params), strict=True))
        held += [f"least {name}" for name, u in places if u < 1e-6]
        held += [f"largest {name}" for name, u in places if u > 1 - 1e-6]
        return tuple(held)

    def run(self) -> Orbit:
        """Return the best orbit.

        Raises
        ------
        OrbitNotFound
            If there is none that is allowed.
        """
        seeds = self._seeds()
        candidates = [orbit for seed in seeds for orbit in self._along(seed)]
        if not candidates:
            ranges = ", ".join(f"{name} = {low:g} … {high:g}" for name, (low, high) in self.box.over.items())
            limit = f" with multipliers below {self.largest:g}" if self.largest < 1 else ""
            raise OrbitNotFound(
                f"no stable admissible {self.word} orbit{limit} was met over {ranges} from {len(seeds)} orbits "
                "followed there; widen the ranges or begin at parameters where one is stable"
            )
        best = min((self._improve(orbit) for orbit in self._best_of(candidates)), key=self.cost)
        for _ in range(8):
            again = min((self._improve(o) for o in self._best_of(self._along(best))), key=self.cost, default=best)
            if not self.cost(again) < self.cost(best) - 1e-10:
                break
            best = again
        return best

    def _seeds(self) -> list[Orbit]:
        """Return all orbits at the start, or at the first of some points spread over the box that has one."""
        from scipy.stats import qmc

        spread = qmc.Halton(len(self.box.over), scramble=False).random(_SEED_POINTS + 1)[1:]
        found: list[Orbit] = []
        for p in itertools.chain([self.box.start()], map(self.box.params, spread)):
            here = [orbit for orbit in all_orbits(self.word, p) if orbit.residual < 1e-8]
            found += here
            if any(self.allowed(orbit) for orbit in here):
                break
        return found

    def _best_of(self, candidates: list[Orbit]) -> list[Orbit]:
        """Return the best few, no two of which are close by."""
        kept: list[Orbit] = []
        for orbit in sorted(candidates, key=self.cost):
            u = self.box.place(orbit.params)
            if all(np.abs(u - self.box.place(other.params)).max() > 0.02 for other in kept):
                kept.append(orbit)
            if len(kept) == _CANDIDATES:
                break
        return kept

    def _along(self, orbit: Orbit) -> list[Orbit]:
        """Return the best orbit of each allowed stretch of the branches through an orbit, in each free parameter."""
        found = [orbit] if self.allowed(orbit) else []
        for name, low, high in self.box.lines():
            here = getattr(orbit.params, name)
            inside = min(max(here, low), high)
            for stop in (low, high):
                if abs(stop - inside) < 1e-9 * (high - low):
                    continue
                try:
                    branch = continue_orbit(
                        orbit, name, stop, within=(min(low, here), max(high, here)), beyond_grazing=True, max_points=400
                    )
                except OrbitNotFound:  # lost next to a degenerate point: what was on the way is reached from elsewhere
                    continue
                found += self._stretches(branch)
        return found

    def _stretches(self, branch: Branch) -> list[Orbit]:
        groups = itertools.groupby(branch.orbits, key=self.allowed)
        return [min(group, key=self.cost) for good, group in groups if good]

    def _improve(self, orbit: Orbit) -> Orbit:
        """Return the local optimum near an allowed orbit, within regions that shrink where an attempt fails."""
        reach = 0.3
        for _ in range(_ATTEMPTS):
            try:
                other = self._attempt(orbit, reach)
            except OrbitNotFound:
                other = None
            gain = self.cost(orbit) - self.cost(other) if other is not None and self.allowed(other) else -math.inf
            if other is None or gain <= 0:
                reach /= 4
                if reach < _SMALLEST:
                    break
                continue
            orbit = other
            if gain < 1e-13:
                break
        return self._at_ends(orbit)

    def _attempt(self, orbit: Orbit, reach: float) -> Orbit:
        """Return where SLSQP ends within `reach` of an orbit, in the coordinates of its chart."""
        from scipy.optimize import minimize  # half a second to load, and only an optimum needs it

        chart = Chart(orbit, self.box)
        free = len(self.box.over)

        def values(xi: Floats) -> Floats:
            """Return cost, slacks, and room to the lower and upper ends of the ranges."""
            there = chart.orbit(xi)
            u = self.box.place(there.params)
            return np.concatenate([[self.cost(there)], self.slacks(there, _INSIDE), u, 1 - u])

        def slopes(xi: Floats) -> Floats:
            key = xi.tobytes()
            if key not in known:
                steps = _DIFFERENCE * np.eye(free)
                known[key] = np.stack([_difference(values, xi, step) for step in steps], axis=1)
            return known[key]

        known: dict[bytes, Floats] = {}
        result = minimize(
            lambda xi: values(xi)[0],
            np.zeros(free),
            jac=lambda xi: slopes(xi)[0],
            bounds=[(-reach, reach)] * free,
            constraints={"type": "ineq", "fun": lambda xi: values(xi)[1:], "jac": lambda xi: slopes(xi)[1:]},
            method="SLSQP",
            options={"maxiter": 60, "ftol": 1e-14},
        )
        return chart.orbit(result.x)

    def _at_ends(self, orbit: Orbit) -> Orbit:
        """Return the orbit exactly at the ends of the ranges that it has reached to rounding."""
        u = self.box.place(orbit.params)
        ends = np.where(np.abs(u - np.round(np.clip(u, 0, 1))) < _ROUNDING, np.round(np.clip(u, 0, 1)), u)
        if np.array_equal(u, ends):
            return orbit
        try:
            exact = _neighbour(orbit, self.box.params(ends))
        except OrbitNotFound:
            return orbit
        return exact if self.allowed(exact) else orbit


def _difference(function: Callable[[Floats], Floats], xi: Floats, step: Floats) -> Floats:
    """Return the central difference of a function, one-sided where the model ends."""
    ends = []
    for sign in (-1, 1):
        try:
            ends.append((sign, function(xi + sign * step)))
        except OrbitNotFound:
            ends.append((0, function(xi)))
    (left, before), (right, after) = ends
    if left == right:
        raise OrbitNotFound("the orbits end on either side of a point of the search; take smaller steps")
    return (after - before) / ((right - left) * float(np.abs(step).max()))


def _neighbour(orbit: Orbit, p: Params) -> Orbit:
    """Return the orbit of the same family at parameters nearby."""
    if orbit.symmetric and len(orbit.word) == 2:
        found = symmetric_orbits(p, orbit.word.p)
        if not found:
            raise OrbitNotFound(f"the symmetric {orbit.name} orbit is gone at {p}; look nearer to {orbit.params}")
        return min(found, key=lambda other: abs(other.states[0, 3] - orbit.states[0, V2]))
    return refine(orbit.word, p, orbit)
