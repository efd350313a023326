"""Symmetric orbits at many points at once against those one by one."""

import numpy as np
import pytest

from vines.errors import ParameterError
from vines.model import Params
from vines.orbits import symmetric_orbits, symmetric_table
from vines.orbits._eigenvalues import eigenvalues_kernel


def test_it_is_the_closed_form_at_random_points():
    rng = np.random.default_rng(3)
    n = 60
    mu, A, Omega = 10 ** rng.uniform(-2.3, 0, n), 10 ** rng.uniform(-2, 0, n), rng.uniform(0.6, 1.6, n)
    r, lam = rng.uniform(0.3, 0.9, n), rng.uniform(0, 0.2, n)
    for period in (1, 3):
        table = symmetric_table(mu, A, Omega, r, lam, period=period)
        for k in range(n):
            orbits = symmetric_orbits(Params(mu[k], A[k], Omega[k], r[k], lam[k]), period)
            assert table["exists"][k].sum() == len(orbits)
            for row, orbit in zip(table[k], orbits, strict=False):
                assert row["admissible"] == orbit.admissible
                assert row["stable"] == orbit.stable
                assert row["x1"] == pytest.approx(orbit.states[0, 0], abs=1e-13)
                assert row["w_dot"] == pytest.approx(orbit.w_dot[0], rel=1e-13)
                assert np.cos(row["phase"] - orbit.phase[0]) == pytest.approx(1, abs=1e-15)
                assert row["max_multiplier"] == pytest.approx(orbit.max_multiplier, rel=1e-9)
                assert row["kinetic_ratio"] == pytest.approx(orbit.measures.kinetic_ratio, rel=1e-10)
                assert row["max_abs_x1"] == pytest.approx(orbit.measures.max_abs_x1, rel=1e-12)
                assert row["min_clearance"] == pytest.approx(orbit.min_clearance, abs=1e-12)
                for z in row["half_multipliers"] ** 2:
                    assert np.abs(orbit.multipliers - z).min() < 1e-10 * max(1, orbit.max_multiplier)


def test_its_eigenvalues_have_a_backward_error_of_rounding():
    rng = np.random.default_rng(0)
    matrices = [rng.normal(size=(4, 4)) * 10 ** rng.uniform(-2, 2, size=(4, 1)) for _ in range(200)]
    shift = np.roll(np.eye(4), 1, axis=0)
    for M in (*matrices, shift, np.triu(matrices[0]), np.zeros((4, 4)), np.eye(4), np.round(matrices[1])):
        values = np.empty(4, dtype=complex)
        eigenvalues_kernel(M.astype(complex), values)
        size = np.linalg.norm(M) + 1e-300
        assert abs(values.sum() - np.trace(M)) <= 2e-14 * size
        for z in values:
            assert np.linalg.svd(M - z * np.eye(4))[1][-1] <= 2e-14 * size


def test_parameters_broadcast_and_are_checked():
    assert symmetric_table(np.full((3, 1), 0.01), np.linspace(0.01, 0.02, 4)).shape == (3, 4, 2)
    assert symmetric_table([], []).shape == (0, 2)
    for bad in ({"mu": -1.0}, {"A": np.nan}, {"lam": -0.1}, {"r": 2.0}, {"lam": 0.0, "Omega": 1.0}, {"period": 2}):
        with pytest.raises(ParameterError):
            symmetric_table(**{"mu": 0.01, "A": 0.02, **bad})
