"""Friction of the ball that turns within a flight, against an ordinary integrator."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vines.rig.ball._ball import Cavity, Course, ball_motion
from vines.rig.fit._jumps import Jumps
from vines.rig.fit._motion import Motion
from vines.rig.fit._slide import push, slide

S, OMEGA, RUB, SIZE = complex(-0.3, 55.0), 55.0, 0.15, 8e-3
"""Free oscillation [1/s], forcing [rad/s], deceleration of the ball [m/s^2], swing of the oscillator [m]."""

T = np.array([0.1, 0.16, 0.5])
"""Impacts [s]: a quick flight, and one in which the oscillator overtakes the ball again and again."""


@pytest.fixture(scope="module")
def motion():
    """Return an oscillator that swings by 8 mm whatever happens at the impacts."""
    return Motion(S, OMEGA, np.array([SIZE + 0j]), np.concatenate([[0.0], T]), np.zeros(4, complex), 0.6)


@pytest.fixture(scope="module")
def flown():
    """Return positions of a ball at the impacts and its velocities there, by small steps."""
    x2, v2 = [0.0], []
    for begin, end, start in ((T[0], T[1], 0.9), (T[1], T[2], 0.05)):

        def rates(t, y):
            return [y[1], -RUB * np.sign(y[1] + SIZE * OMEGA * math.sin(OMEGA * t))]

        found = solve_ivp(rates, (begin, end), [x2[-1], start], max_step=5e-5)
        x2.append(found.y[0, -1])
        v2.append((start, found.y[1, -1]))
    return np.array(x2), v2


def test_velocities_at_the_ends_of_flights_follow_the_sense_of_sliding(motion, flown):
    x2, v2 = flown
    found = slide(motion, x2)
    mean = np.diff(x2) / np.diff(T)
    assert mean + RUB * found.after == pytest.approx([v2[0][0], v2[1][0]], abs=3e-4)
    assert mean - RUB * found.before == pytest.approx([v2[0][1], v2[1][1]], abs=3e-4)
    # Taken as one-sided, the slow flight would be off by the whole of friction times its length.
    assert abs(mean[1] + RUB * 0.17 - v2[1][0]) > 5e-3


def test_the_oscillator_answers_to_friction_as_an_integrator_says(motion, flown):
    x2, _ = flown
    found, omega0, size = slide(motion, x2), abs(S), 4e-6
    grid = np.linspace(T[0], T[2], 2001)[1:-1]
    pushed = push(found, T, grid, S, size)
    for k in range(2):
        cells = found.sense.shape[1]
        edges = np.linspace(T[k], T[k + 1], cells + 1)
        state = np.array([size * found.sense[k, 0], 0.0])
        for i in range(cells):
            force = size * found.sense[k, i]

            def rates(_, y, force=force):
                return [y[1], -(omega0**2) * (y[0] - force) + 2 * S.real * y[1]]

            here = grid[(grid >= edges[i]) & (grid < edges[i + 1])]
            end = solve_ivp(rates, edges[i : i + 2], state, t_eval=[*here, edges[i + 1]], rtol=1e-10, atol=1e-16)
            known = pushed.signal[(grid >= edges[i]) & (grid < edges[i + 1])]
            np.testing.assert_allclose(known, end.y[0, :-1], rtol=0, atol=1e-11)
            state = end.y[:, -1]
        assert (pushed.end[k + 1], pushed.speed[k + 1]) == pytest.approx(tuple(state), rel=1e-6, abs=1e-12)


def test_a_hard_impact_goes_deeper_into_the_wall_than_a_soft_one():
    """A ball between walls that give way: lines before and after a contact meet where its force has its centroid."""
    side, b, touch = np.array([1.0, -1.0, 1.0, -1.0]), 0.015, 6e-5
    deep = np.array([1.5, 0.3, 1.2, 0.4])
    x2 = -side * (b + touch * deep)
    still = Jumps(np.array([0.0, 0.03, 0.08, 0.11]), np.zeros(4), np.zeros(4), np.zeros(4))
    course = Course(np.zeros(3), np.zeros(3), deep)
    found = ball_motion(still, side, Cavity(b, touch=touch), course)
    np.testing.assert_allclose(found.x2, x2)
    np.testing.assert_allclose(found.v2_before, (np.diff(x2) / np.diff(still.t))[:-1])
