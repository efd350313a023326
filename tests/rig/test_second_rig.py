"""The second synthetic rig: its integrator beside another one, and what is said of its runs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.second_rig import draw_rig
from benchmarks.second_rig._integrator import NAMES, N, damping_ratio, rates, run, stiffness
from benchmarks.second_rig._motion import parameters
from benchmarks.second_rig._score import score

pytestmark = pytest.mark.full


@pytest.mark.parametrize("physics", ["rolling", "cubic", "shaker"])
def test_flight_is_that_of_another_integrator(physics):
    p = parameters(draw_rig(1, physics), np.random.default_rng(1)) | {"left": 1.0, "right": 1.0}
    values = np.array([p[name] for name in NAMES])
    start = np.array([0.004, 0.2, 0.001, 0.4, 0.1, 1e-4, 0.0, 0.0, 0.0])
    out, rows, y = np.empty((401, N)), np.empty((1, 11)), start.copy()
    assert run(y, 0.0, values, 5e-4, 400, np.array([[0.65, 0.0]]), 1e-10, out, rows, 0) == 0

    def slope(t, state):
        into = np.empty(N)
        rates(t, state, 0.0, 0.0, values, into)
        return into

    other = solve_ivp(slope, (0, 0.2), start, "DOP853", rtol=1e-11, atol=1e-13, max_step=1e-3).y[:, -1]
    assert out[-1, :7] == pytest.approx(other[:7], abs=1e-8)


@pytest.mark.parametrize("r", [0.3, 0.65, 0.9])
def test_a_contact_has_the_restitution_and_the_length_that_were_asked_for(r):
    stiff, ratio = stiffness(2e-4, r, 1.0), damping_ratio(r)
    dashpot = 2 * ratio * np.sqrt(stiff)

    def pushed(t, y):
        return (y[1], -(stiff * y[0] + dashpot * y[1]))

    def ends(t, y):
        return stiff * y[0] + dashpot * y[1]

    ends.terminal, ends.direction = True, -1
    found = solve_ivp(pushed, (0, 1), (0.0, 1.0), "DOP853", events=ends, rtol=1e-10, atol=1e-14)
    assert found.t[-1] == pytest.approx(2e-4, rel=1e-6)
    assert found.y[1, -1] == pytest.approx(-r, rel=1e-6)


@pytest.mark.long(60)
@pytest.mark.parametrize("physics", ["rolling", "soft", "cubic", "shaker", "table"])
def test_what_the_model_does_not_have_is_named(physics):
    found = score(5101, physics, duration=25.0, verdict=False)
    assert found.named, found.reason
    assert found.verdict == ("accepted" if physics == "table" else "not accepted")
