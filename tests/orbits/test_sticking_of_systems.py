"""Orbits that stick with a coil, friction or a spring: against the simulator, DOP853 with events, and the VI-NES."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vines
from vines import Params, find_orbit
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Word
from vines.orbits import all_orbits, continue_orbit, follow_curve, mirror_image, switch_branch
from vines.orbits._release_of_balls import run_round
from vines.systems import CubicBarriers, Drag, Friction

VI_NES = Params(mu=0.0256654, Omega=1.02946, r=0.347164, lam=0.0959532, A=0.5)
"""Where docs/sticking.md follows L*R*."""

TRIPLE = Params(mu=0.0784564, A=0.171193, Omega=1.33447, r=0.302436, lam=0.0900701)
"""LR*/3T, whose period doubles at A = .18047."""

SPRING = CubicBarriers(**TRIPLE.as_dict(), k1=0.001, k3=0.002, l2=0.002)

SYSTEMS = {
    "drag": Drag(**TRIPLE.as_dict(), delta=0.005),
    "friction": Friction(mu=0.22, A=0.0643, Omega=0.7426, r=0.0909, lam=0.2297, f=0.034, G=0.05),
    "cubic": CubicBarriers(mu=0.017, A=0.251, Omega=1.26, r=0.12, lam=0.16, k1=-0.11, k3=0.16, l2=0.08),
}


def of_the_vi_nes(orbit):
    """Return time and v1 of the first release of an orbit, which a guess has."""
    return [orbit.spells["t_release"][0], orbit.spells["v1"][0]]


@pytest.fixture(scope="module")
def model():
    """Return the orbit of the VI-NES."""
    return find_orbit("L*R*", VI_NES)


@pytest.fixture(scope="module")
def triple():
    """Return time and v1 of its release."""
    return of_the_vi_nes(find_orbit("LR*/3T", TRIPLE))


@pytest.fixture(scope="module", params=SYSTEMS.values(), ids=SYSTEMS.keys())
def met(request):
    attractor = vines.settle(request.param, lyapunov=False, errors=False)
    assert "*" in attractor.word
    return attractor, find_orbit(attractor.word, request.param)


@pytest.mark.parametrize("system", [Drag, Friction, CubicBarriers])
def test_with_nothing_on_the_ball_it_is_the_vi_nes(system, model):
    theirs = model
    ours = find_orbit("L*R*", system(**VI_NES.as_dict()), guess=of_the_vi_nes(theirs))
    assert ours.t == pytest.approx(theirs.t, abs=1e-13)
    assert ours.states == pytest.approx(theirs.states, abs=1e-12)
    assert ours.multipliers == pytest.approx(theirs.multipliers, abs=1e-12)
    assert ours.half_multipliers == pytest.approx(theirs.half_multipliers, abs=1e-12)
    assert ours.min_clearance == pytest.approx(theirs.min_clearance, abs=1e-12) or system is Friction
    # A spell begins at the merge, of the VI-NES where its chatter accumulates.
    for name in theirs.spells.dtype.names:
        within = 1e-4 if name in ("t_start", "phase_start") else 1e-10
        assert ours.spells[name] == pytest.approx(theirs.spells[name], abs=within), name
    image = mirror_image(ours)
    assert image.t == pytest.approx(ours.t, abs=1e-12)


def test_the_word_of_an_attractor_gives_its_orbit(met):
    attractor, orbit = met
    assert (str(orbit.word), orbit.stable, orbit.admissible) == (attractor.word, True, True)
    assert orbit.symmetric == attractor.symmetric
    assert orbit.measures.kinetic_ratio == pytest.approx(attractor.measures.kinetic_ratio, rel=1e-10)
    assert orbit.residual < 1e-12
    assert abs(orbit.energy_imbalance) < 1e-12
    # Those of the tangent map over the recorded run, which knows of no release.
    assert np.poly(orbit.multipliers) == pytest.approx(np.poly(attractor.multipliers), abs=1e-10)


def test_it_closes_in_the_simulator(met):
    _, orbit = met
    run = vines.simulate(orbit.params, **orbit.start(), periods=orbit.word.p * (1 + 1e-9))
    events = run.events
    for t, state in zip(orbit.t[1:], orbit.states[1:], strict=True):
        nearest = events[np.argmin(np.abs(events["t"] - t))]
        assert abs(nearest["t"] - t) < 1e-11
        assert [nearest[name] for name in ("x1", "v1", "x2", "v2")] == pytest.approx(state, abs=1e-11)
    product = np.linalg.multi_dot([np.eye(4), *orbit.jacobians[::-1]])
    assert np.poly(product) == pytest.approx(np.poly(orbit.multipliers), abs=1e-8)


def test_slopes_are_differences_of_the_simulator(met):
    _, orbit = met
    section, z = orbit.release
    span, h = orbit.period, 1e-6
    slopes = np.empty((2, 2))
    for j in range(2):
        ends = [run_round(orbit.params, section, span, z + s * h * np.eye(2)[j], section) for s in (1.0, -1.0)]
        change = np.array([ends[0].lasts - ends[1].lasts, ends[0].end[1] - ends[1].end[1]]) / (2 * h)
        # A start at a later phase comes back later by as much.
        slopes[:, j] = [1 + change[0] * orbit.params.Omega, change[1] * orbit.params.Omega] if j == 0 else change
    assert np.poly(slopes) == pytest.approx(np.poly(orbit.multipliers[:2]).real, abs=1e-7)


def pushed(p, w, u, sense):
    """Return the force on the ball over its mass."""
    if isinstance(p, Drag):
        return p.delta * u
    if isinstance(p, Friction):
        return p.f * sense
    return p.k1 * w + p.k3 * w**3 + p.l2 * u


def round_of(p, side, phase, x1, v1, lasts):
    """Return time and v1 of the last release within a time, by DOP853; the ball was let go at a phase.

    Impacts of a chatter are followed down to 1e-6, and the masses join in their common motion.
    """
    G, t, releases = getattr(p, "G", 0.0), 0.0, []
    y, rides, sense = np.array([x1, v1, x1 - side, v1]), 0, -side
    after, fine = 0.0, 0.05

    def force(t):
        return p.A * (math.sin(p.Omega * t + phase) + p.lam * p.Omega * math.cos(p.Omega * t + phase))

    def draw(t, y):
        return force(t) - p.lam * y[1] - y[0]

    def rates(t, y):
        if rides:
            a = (draw(t, y) - p.mu * G) / (1 + p.mu)
            return [y[1], a, y[1], a]
        g = pushed(p, y[0] - y[2], y[1] - y[3], sense)
        return [y[1], draw(t, y) - p.mu * g, y[3], g - G]

    def let_go(t, y):
        # What the wall has to do beside what acts on a ball that does not move against it.
        a = (draw(t, y) - p.mu * G) / (1 + p.mu)
        return rides * (a + G - pushed(p, float(rides), 0.0, -rides))

    def slower(t, y):
        return sense * (y[1] - y[3]) if isinstance(p, Friction) and t > after else 1.0

    def left(t, y):
        return 1 - (y[0] - y[2]) if t > after or side > 0 else 1.0

    def right(t, y):
        return 1 + (y[0] - y[2])

    while t < lasts:
        events = [let_go] if rides else [left, right, slower]
        for event in events:
            event.terminal, event.direction = True, -1
        run = solve_ivp(rates, (t, lasts), y, "DOP853", events=events, rtol=1e-12, atol=1e-14, max_step=fine)
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status == 0:
            break
        fine = 0.05
        if rides:
            releases.append((t, y[1]))
            rides, sense = 0, -rides
            y[3] = y[1] - sense * 1e-15
            continue
        if len(run.t_events) > 2 and len(run.t_events[2]):
            sense = -sense
            y[3] = y[1] - sense * 1e-15
            continue
        wall = 1 if len(run.t_events[0]) else -1
        common, closing = (y[1] + p.mu * y[3]) / (1 + p.mu), y[1] - y[3]
        push = wall * (draw(t, y) + G - (1 + p.mu) * pushed(p, float(wall), 0.0, wall))
        if abs(closing) * p.r < 1e-6 and push > 0:
            middle = (y[0] + p.mu * y[2]) / (1 + p.mu)
            y[:] = middle + p.mu * wall / (1 + p.mu), common, middle - wall / (1 + p.mu), common
            rides = wall
            continue
        y[1] = common - p.mu * p.r * closing / (1 + p.mu)
        y[3] = common + p.r * closing / (1 + p.mu)
        y[2] = y[0] - wall
        sense = -wall
        fine = min(0.05, 0.2 * p.r * abs(closing) / max(abs(push), 0.1))
    return releases[-1]


@pytest.mark.parametrize(
    "p",
    [
        pytest.param(Drag(**TRIPLE.as_dict(), delta=0.005), id="drag", marks=pytest.mark.full),
        pytest.param(Friction(**TRIPLE.as_dict(), f=0.002, G=1e-4), id="friction"),
        pytest.param(
            CubicBarriers(**TRIPLE.as_dict(), k1=0.001, k3=0.002, l2=0.002), id="cubic", marks=pytest.mark.full
        ),
    ],
)
def test_an_unstable_orbit_by_dop853(p, triple):
    farther = continue_orbit(find_orbit("LR*/3T", p, guess=triple), "A", 0.195, step=0.5).orbits[-1]
    assert farther.max_multiplier > 1.05
    [spell] = farther.spells
    found = round_of(
        farther.params, spell["side"], spell["phase_release"], spell["x1"], spell["v1"], farther.period + 0.1
    )
    assert found == pytest.approx((farther.period, spell["v1"]), abs=1e-11)


def test_the_doubled_family_and_a_curve_of_it(triple):
    orbit = find_orbit("LR*/3T", SYSTEMS["drag"], guess=triple)
    [found] = continue_orbit(orbit, "A", 0.186, step=0.2).bifurcations
    assert found.type == "period_doubling"
    assert found.multiplier == pytest.approx(-1, abs=1e-9)
    [doubled] = switch_branch(found)
    assert (str(doubled.word), doubled.stable) == ("LR*LR*/6T", True)
    at = {name: value for name, value in doubled.start().items() if name != "t"}
    attractor = vines.settle(doubled.params, phi=doubled.phase[0], lyapunov=False, errors=False, **at)
    assert attractor.word == "LR*LR*/6T"
    assert attractor.measures.kinetic_ratio == pytest.approx(doubled.measures.kinetic_ratio, rel=1e-9)
    # With less and less drag the curve comes to the doubling of the VI-NES.
    curve = follow_curve(found, ("A", "delta"), box={"A": (0.17, 0.19), "delta": (0.0, 0.006)}, step=0.3)
    end = curve.orbits[int(np.argmin(curve.values[:, 1]))]
    assert end.params.delta == 0.0
    assert pytest.approx(0.1804684960845155, abs=1e-12) == end.params.A


@pytest.mark.parametrize(
    ("p", "within"),
    [
        pytest.param(Drag(**VI_NES.as_dict(), delta=0.1), 1e-7, id="drag", marks=pytest.mark.full),
        pytest.param(Friction(**VI_NES.as_dict(), f=0.02, G=0.01), 1e-6, id="friction", marks=pytest.mark.full),
    ],
)
def test_a_family_ends_where_its_chatter_does(p, within, model):
    orbit = find_orbit("L*R*", p, guess=of_the_vi_nes(model))
    branch = continue_orbit(orbit, "A", 0.43, step=0.5)
    assert branch.ends == ("range", "incomplete_chatter")
    end = branch.bifurcations[-1].value
    assert find_orbit("L*R*", p.replace(A=end + within), guess=branch.orbits[-1]).stable
    with pytest.raises(OrbitNotFound):
        find_orbit("L*R*", p.replace(A=end - within), guess=branch.orbits[-1])


@pytest.mark.full
def test_a_word_of_one_wall_with_friction_and_what_is_refused():
    p = Friction(mu=0.1738, A=0.729, Omega=0.5817, r=0.0706, lam=0.0468, f=0.1522, G=0.05)
    attractor = vines.settle(p, lyapunov=False, errors=False)
    [orbit] = all_orbits("L*", p)
    assert attractor.word == "L*"
    assert orbit.measures.kinetic_ratio == pytest.approx(attractor.measures.kinetic_ratio, rel=1e-10)
    with pytest.raises(ParameterError, match="time and v1 of the release after its first star, two numbers"):
        find_orbit("L*", p, guess=[1.0])
    with pytest.raises(ParameterError, match="its mirror image is no motion unless G = 0"):
        mirror_image(orbit)
    with pytest.raises(OrbitNotFound, match="other contacts come; give a nearer guess"):
        find_orbit(Word("L*R*"), p, guess=of_the_vi_nes(orbit))


@pytest.mark.parametrize(
    ("p", "word"),
    [
        pytest.param(
            CubicBarriers(
                mu=0.0832541678091031, A=0.09955997164301418, Omega=1.3924837101637264, r=0.38406076174665843,
                lam=0.023995884946685083, k1=-0.13276926315450427, k3=0.0620557040089588, l2=0.1,
            ),
            "R*/6T",
            id="a flight that is begun afresh",
        ),
        pytest.param(
            Friction(
                mu=0.03648242708900988, A=0.209799500962498, Omega=1.5402907046571659, r=0.19686264432487993,
                lam=0.06212793996152215, f=0.09677358668436523, G=0.05,
            ),
            "L*/4T",
            id="a ball that turns more than once",
        ),
    ],
)  # fmt: skip
def test_a_chatter_is_one_contact_whatever_lies_between_its_impacts(p, word):
    assert vines.settle(p, lyapunov=False, errors=False).word == word
