"""The reduced model: against the exact orbits, and its own formulas against what they were derived from."""

import math

import numpy as np
import pytest

from vines.model import Params
from vines.orbits import (
    continue_orbit,
    manifold_amplitude,
    manifold_range,
    reduced_orbits,
    reduced_range,
    symmetric_orbits,
)

CASES = [
    Params(mu=0.01, A=0.017),
    Params(mu=0.01, A=0.014, Omega=1.004),
    Params(mu=0.02, A=0.021, Omega=0.995, r=0.8),
    Params(mu=0.005, A=0.009, r=0.5, lam=0.02),
]
MEASURES = {
    "max_abs_x1": (lambda o: o.max_abs_x1, lambda o: o.measures.max_abs_x1),
    "kinetic_ratio": (lambda o: o.kinetic_ratio, lambda o: o.measures.kinetic_ratio),
    "w_dot": (lambda o: o.w_dot, lambda o: o.w_dot[0]),
    "phase": (lambda o: o.phase, lambda o: o.phase[0]),
    "fast": (lambda o: abs(o.fast_multipliers[0]), lambda o: np.sort(abs(o.half_multipliers))[1]),
}


def scaled(p, eps):
    """Return p with all that the reduction takes for small made smaller by eps."""
    return Params(mu=eps * p.mu, A=eps * p.A, Omega=1 + eps * (p.Omega - 1), r=p.r, lam=eps * p.lam)


@pytest.mark.parametrize("p", CASES)
def test_errors_are_of_first_order(p):
    scales = 0.5 ** np.arange(3, 8)
    for name, (reduced, exact) in MEASURES.items():
        errors = []
        for eps in scales:
            now = scaled(p, eps)
            ours, theirs = reduced(reduced_orbits(now)[0]), exact(symmetric_orbits(now)[0])
            errors.append(abs(ours / theirs - 1))
        # Halving the scale halves the error, the more exactly the smaller it is.
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        assert abs(orders[-1] - 1) < 0.05, (name, orders)


@pytest.mark.parametrize("p", CASES)
def test_slow_eigenvalues_are_the_slow_multipliers_to_second_order(p):
    errors = []
    for eps in (1 / 16, 1 / 32, 1 / 64):
        now = scaled(p, eps)
        slow = np.exp(reduced_orbits(now)[0].slow_eigenvalues * math.pi / now.Omega)
        exact = symmetric_orbits(now)[0].half_multipliers[:2]
        errors.append(max(np.abs(np.sort_complex(slow) - np.sort_complex(exact))))
    assert np.all(np.diff(np.log2(errors)) < -1.8), errors


def test_both_solutions_below_the_amplitude_of_the_cavity():
    p = scaled(Params(mu=0.01, A=0.0085), 0.01)
    reduced, exact = reduced_orbits(p), symmetric_orbits(p)
    assert len(reduced) == len(exact) == 2
    for ours, theirs in zip(reduced, exact, strict=True):
        assert ours.max_abs_x1 == pytest.approx(theirs.measures.max_abs_x1, rel=5e-3)
        assert ours.stable == theirs.stable


def test_range_of_stability_tends_to_that_of_the_exact_orbits():
    errors = []
    for eps in (0.2, 0.1):
        p = scaled(Params(mu=0.01, A=0.017), eps)
        low, high = reduced_range(p)
        branch = continue_orbit(symmetric_orbits(p)[0], "A", 1.2 * high, beyond_grazing=True)
        (breaking,) = (b.value for b in branch.bifurcations if b.type == "symmetry_breaking")
        down = continue_orbit(symmetric_orbits(p)[0], "A", 0.85 * low, beyond_grazing=True)
        first = next(b for b in down.bifurcations)
        errors.append([high / breaking - 1, low / first.value - 1])
    assert np.all(np.abs(errors[1]) < 0.6 * np.abs(errors[0])), errors
    assert np.all(np.abs(errors[1]) < 5e-3), errors


def test_manifold_has_its_fold_where_a_fast_multiplier_is_one_and_breaks_symmetry_at_minus_one():
    for r in (0.3, 0.65, 0.9):
        low, high = manifold_range(r)
        step = 1e-5
        assert manifold_amplitude(low + step, r) == pytest.approx(manifold_amplitude(low - step, r), abs=1e-12)
        for V, multiplier in ((low, 1.0), (high, -1.0)):
            p = Params(mu=1e-4, A=1e-4, r=r, lam=1e-4)
            A = reduced_range(p)[multiplier < 0]
            found = reduced_orbits(p.replace(A=A))
            fast = min(found, key=lambda response, V=V: abs(response.ball_speed - V)).fast_multipliers
            assert min(abs(fast - multiplier)) < 1e-6


def test_slow_eigenvalues_are_those_of_the_slow_flow():
    """Differences of i a' = … in (V, psi), written down again here, at a fixed point."""
    p = Params(mu=0.01, A=0.016, Omega=1.003)
    response = reduced_orbits(p)[0]
    kappa = (1 - p.r) / (1 + p.r)

    def rate(a):
        # V from |a| by bisection on the outer part of the manifold, then 2 i a' = …
        low, high = manifold_range(p.r)[0], 3.0
        for _ in range(80):
            V = (low + high) / 2
            low, high = (V, high) if manifold_amplitude(V, p.r) < abs(a) else (low, V)
        turn = a / complex(1 - math.pi * V / 2, -kappa * V)  # e^{-i psi}
        pull = complex(2 * (p.Omega - 1), -p.lam) * a - 1j * p.A - 4 * p.mu * V / math.pi * turn / abs(turn)
        return pull / 2j

    V, psi = response.ball_speed, response.phase
    a = complex(1 - math.pi * V / 2, -kappa * V) * np.exp(-1j * psi)
    assert abs(rate(a)) < 1e-14
    step = 1e-6
    columns = [(rate(a + d) - rate(a - d)) / (2 * step) for d in (step, 1j * step)]
    found = np.linalg.eigvals([[c.real for c in columns], [c.imag for c in columns]])
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(response.slow_eigenvalues), rel=1e-6)


def test_clearance_is_that_of_a_dense_sample():
    seen = []
    s = np.linspace(0, math.pi, 5001)[1:-1]
    for r in (0.02, 0.3, 0.65):
        for V in np.linspace(0.02, 3, 40):
            p = Params(mu=1e-3, A=1.0, r=r)
            u = complex(1 - math.pi * V / 2, -(1 - r) / (1 + r) * V)
            pull = complex(0, -p.lam) * u - 4 * p.mu * V / math.pi
            found = reduced_orbits(p.replace(A=abs(pull)))
            response = min(found, key=lambda response, V=V: abs(response.ball_speed - V))
            w = (u * np.exp(1j * s)).real + math.pi * V / 2 - V * s
            assert response.admissible == bool(np.all(np.abs(w) < 1)), (r, V)
            seen.append((response.admissible, response.min_clearance < 2))
    assert set(seen) == {(True, True), (True, False), (False, True)}


def test_no_response_below_the_least_amplitude():
    assert reduced_orbits(Params(mu=0.01, A=0.001)) == []
