import numpy as np
import pytest

from vines.dynamics import simulate
from vines.model import Params
from vines.orbits import continue_orbit, find_orbit, symmetric_orbits


def random_orbits(seed, count):
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        p = Params(
            mu=10 ** rng.uniform(-2.5, 0),
            A=10 ** rng.uniform(-2, 0.5),
            Omega=rng.uniform(0.3, 2),
            r=rng.uniform(0.2, 0.95),
            lam=rng.uniform(0.005, 0.3),
        )
        found += symmetric_orbits(p, int(rng.choice([1, 3])))
    return found[:count]


def test_the_certificate_agrees_with_dense_sampling(independent):
    admissible = inadmissible = 0
    for orbit in random_orbits(11, 250):
        outside, first = -np.inf, np.inf
        for j in (0, 1):
            # Without the ends, where |w| is one; the speeds of departure and arrival decide there.
            tau = orbit.flight_times[j] * np.linspace(0, 1, 8001)[1:-1]
            w = independent.gap(orbit.params, orbit.states[j], orbit.phase[j], tau)
            outside = max(outside, np.abs(w).max() - 1)
            beyond = np.flatnonzero(np.abs(w) > 1)
            if len(beyond) and not np.isfinite(first):
                first = orbit.t[j] + tau[beyond[0]]
                side = int(np.sign(w[beyond[0]]))
                resolution = tau[1] - tau[0]
        if orbit.admissible:
            admissible += 1
            assert outside < 1e-13
            assert orbit.violation_side == 0
            assert np.isnan(orbit.violation_time)
        elif orbit.min_clearance < -1e-6:
            inadmissible += 1
            assert outside == pytest.approx(-orbit.min_clearance, rel=1e-3, abs=1e-6)
            assert orbit.violation_side == side
            assert first - resolution <= orbit.violation_time + 1e-12
            assert orbit.violation_time <= first + 1e-12
    assert admissible > 60
    assert inadmissible > 40


def test_an_inadmissible_orbit_comes_with_time_and_side_of_the_violation(independent):
    orbit = find_orbit("LR", Params(mu=0.01, A=0.09))
    assert not orbit.admissible
    assert orbit.min_clearance < 0
    j = int(np.searchsorted(orbit.t, orbit.violation_time) - 1)
    at = independent.gap(orbit.params, orbit.states[j], orbit.phase[j], orbit.violation_time - orbit.t[j])
    assert at == pytest.approx(orbit.violation_side, abs=1e-12)
    assert "inadmissible" in str(orbit)


def test_the_simulator_leaves_an_inadmissible_orbit_at_the_violation():
    orbit = find_orbit("LR", Params(mu=0.01, A=0.09))
    run = simulate(orbit.params, **orbit.start(), periods=2)
    first = run.impacts[0]
    assert first["t"] == pytest.approx(orbit.violation_time, abs=1e-9)
    assert first["side"] == orbit.violation_side


def test_grazing_is_where_a_turning_point_touches_the_wall():
    branch = continue_orbit(find_orbit("LR", Params(mu=0.01, A=0.05)), "A", 0.1)
    last = branch.bifurcations[-1]
    assert (branch.ends, last.type) == (("range", "grazing"), "grazing")
    assert 0 < last.orbit.min_clearance < 1e-12
    assert not find_orbit("LR", last.params.replace(A=last.value + 1e-7)).admissible
