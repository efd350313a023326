"""Derivatives of orbits by parameters and by forces that the model lacks, against an integrator and known numbers."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vines.model import Params
from vines.orbits import all_orbits, find_orbit
from vines.rig.verdict._sensitivity import pushed, sensitivity


def fly(p, state, t, side, force, size):
    """Return the state (v1, v2, x2, t) just before the next impact on `side`, by a Runge-Kutta method with events."""

    def slope(t, y):
        x1, v1, _, v2 = y
        push = size * (1.0 if force == "tilt" else np.sign(v1 - v2))
        e, e_dot = p.A * np.sin(p.Omega * t), p.A * p.Omega * np.cos(p.Omega * t)
        back = -p.mu * push if force == "friction" else 0.0
        return [v1, -x1 - p.lam * v1 + e + p.lam * e_dot + back, v2, push]

    def reached(t, y):
        return y[0] - y[2] - side

    reached.__dict__.update(terminal=True, direction=float(side))
    end = solve_ivp(slope, (t, t + 20.0), state, events=reached, rtol=1e-11, atol=1e-13, max_step=0.01)
    _, v1, x2, v2 = end.y_events[0][0]
    return np.array([v1, v2, x2, end.t_events[0][0]])


def hit(p, before, side):
    """Return x1, v1, x2, v2 just after an impact."""
    v1, v2, x2, _ = before
    w = v1 - v2
    return [x2 + side, v1 - p.mu * (1 + p.r) * w / (1 + p.mu), x2, v2 + (1 + p.r) * w / (1 + p.mu)]


@pytest.mark.parametrize("force", ["tilt", "friction"])
@pytest.mark.parametrize(("word", "A"), [("LR", 0.015), ("LLR", 0.0245)])
def test_a_pushed_orbit_closes_to_second_order(word, A, force):
    p = Params(mu=0.01, A=A)
    orbit = find_orbit(word, p)
    change = pushed(orbit, force)
    own = np.column_stack([orbit.states[:, 1], orbit.states[:, 3], orbit.states[:, 2], orbit.t])
    size = 1e-5
    for k in range(len(own)):
        after = (k + 1) % len(own)
        begin = own[k] + size * change[k]
        end = fly(p, hit(p, begin, int(orbit.side[k])), begin[3], int(orbit.side[after]), force, size)
        expected = own[after] + size * change[after] + np.array([0.0, 0.0, 0.0, orbit.period * (after == 0)])
        assert np.max(np.abs(end - expected)) < 2e-3 * size * np.max(np.abs(change))


def test_a_1_to_1_orbit_answers_as_the_survey_of_the_rig_measured():
    # facts: 1:1 at A = .015, mu = .0084; change of phase [deg], max|x1| and K2/K1 [%].
    p = Params(mu=0.0084, A=0.015)
    orbit = find_orbit("LR", p)
    by = sensitivity(orbit)
    for name, step, turn, largest, ratio in (
        ("Omega", 1e-3, 4.8, -9.8, 13.7), ("A", 0.01 * p.A, -0.29, 1.8, -2.1), ("mu", 0.01 * p.mu, 0.38, -1.2, 2.5),
        ("r", 0.01, -0.31, 0.55, -0.3), ("friction", 0.005 * 9.80665 / (0.015 * 55.39**2), 0.07, -0.1, 0.15),
    ):  # fmt: skip
        assert np.degrees(by[name].phase * step) == pytest.approx([turn, turn], abs=0.04, rel=0.12)
        assert 100 * by[name].max_abs_x1 * step / orbit.measures.max_abs_x1 == pytest.approx(
            largest, abs=0.06, rel=0.12
        )
        assert 100 * by[name].kinetic_ratio * step / orbit.measures.kinetic_ratio == pytest.approx(
            ratio, abs=0.16, rel=0.12
        )


def test_near_a_pitchfork_a_tilt_turns_a_symmetric_orbit_far():
    far, near = (find_orbit("LR", Params(mu=0.01, A=A)) for A in (0.015, 0.018))
    assert near.symmetric
    turned = [np.abs(sensitivity(one)["tilt"].phase).max() for one in (far, near)]
    assert turned[1] > 100 * turned[0]


def test_mirrored_orbits_answer_alike():
    one, other = (o for o in all_orbits("LR", Params(mu=0.01, A=0.0193)) if o.stable)
    a, b = sensitivity(one), sensitivity(other)
    assert a["A"].phase == pytest.approx(b["A"].phase[::-1], rel=1e-4)
    assert a["tilt"].phase == pytest.approx(-b["tilt"].phase[::-1], rel=1e-4)
    assert a["friction"].max_abs_x1 == pytest.approx(b["friction"].max_abs_x1, rel=1e-3)
