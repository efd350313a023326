"""Orbits of balls in parallel that stick: against the simulator, differences of it, one ball, and the VI-NES."""

from __future__ import annotations

import numpy as np
import pytest

import vines
from vines import Params, find_orbit
from vines.dynamics import tangent_map
from vines.errors import OrbitNotFound, ParameterError, StateError
from vines.model import Word
from vines.orbits import continue_orbit, follow_curve, mirror_image, switch_branch
from vines.orbits._release_of_balls import Moment, Release, run_round
from vines.orbits._sticking_of_balls import Begun, balls_orbit
from vines.orbits._sticking_search_of_balls import sections_of
from vines.systems import Parallel

VI_NES = Params(mu=0.0256654, Omega=1.02946, r=0.347164, lam=0.0959532, A=0.5)
"""Where docs/sticking.md follows L*R*."""

ONE = Parallel(mu=(VI_NES.mu,), A=VI_NES.A, Omega=VI_NES.Omega, r=VI_NES.r, lam=VI_NES.lam)
TILTED = ONE.replace(G=0.01)
UNEQUAL = Parallel(mu=(0.017, 0.104), beta=(0.82, 1.43), r=0.3, A=1.627, Omega=0.743, lam=0.1, G=0.03)
"""Both balls chatter on one wall at a time, and the one that rides is kicked off by each impact of the other."""

ONE_STICKS = Parallel(mu=(0.062, 0.125), beta=(0.63, 1.14), r=(0.36, 0.29), A=0.892, Omega=0.713, lam=0.1)
KICKED = Parallel(mu=(0.01821, 0.01327, 0.06714), r=(0.3738, 0.1698, 0.101), A=0.2164, Omega=1.132, lam=0.3, G=0.03)
"""The ball that rides is always kicked off, and never let go."""

LEVEL = Parallel(mu=(0.162, 0.26), beta=(0.81, 1.14), r=(0.31, 0.12), A=1.01, Omega=0.695, lam=0.1)
EQUAL = Parallel(mu=(0.04, 0.04, 0.04), r=0.38, A=2.54, Omega=0.72, lam=0.1)
"""Three equal balls that ride together, and are let go together."""

SYSTEMS = {"tilted": TILTED, "unequal": UNEQUAL, "one": ONE_STICKS, "kicked": KICKED, "level": LEVEL, "equal": EQUAL}


def settled(p, **options):
    return vines.settle(p, lyapunov=False, errors=False, **options)


@pytest.fixture(scope="module", params=SYSTEMS.values(), ids=SYSTEMS.keys())
def met(request):
    attractor = settled(request.param)
    assert "*" in attractor.word
    return attractor, find_orbit(attractor.word, request.param)


def test_the_word_of_an_attractor_gives_its_orbit(met):
    attractor, orbit = met
    assert (str(orbit.word), orbit.stable, orbit.admissible) == (attractor.word, True, True)
    assert orbit.symmetric == attractor.symmetric
    assert orbit.measures.kinetic_ratio == pytest.approx(attractor.measures.kinetic_ratio, rel=1e-10)
    assert orbit.residual < 1e-12
    assert abs(orbit.energy_imbalance) < 1e-12
    # Those of the tangent map over the recorded run, which knows of no section.
    if attractor.multipliers is not None:
        assert np.poly(orbit.multipliers) == pytest.approx(np.poly(attractor.multipliers), abs=1e-10)


def test_it_closes_in_the_simulator(met):
    _, orbit = met
    hits = vines.simulate(
        orbit.params, **orbit.start(), periods=2.0 * orbit.word.p * (1 + 1e-9), ties="in_turn"
    ).impacts
    states = np.stack([hits[name] for name in ("x1", "v1", "x2", "v2")], axis=1)
    for k, (t, state) in enumerate(zip(orbit.t, orbit.states, strict=True)):
        later = t + orbit.period * (2 if k == 0 else 1)
        away = np.maximum(abs(hits["t"] - later), np.abs(states - state).max(axis=1))
        assert away.min() < 1e-11  # 1.3e-12 was met
    # From contact to contact, through chatters, spells and releases.
    sizes = np.abs(np.linalg.eigvals(np.linalg.multi_dot([np.eye(len(orbit.multipliers)), *orbit.jacobians[::-1]])))
    assert np.sort(sizes)[::-1] == pytest.approx(np.abs(orbit.multipliers), abs=1e-8)


def test_multipliers_are_those_of_differences_of_the_simulator(met):
    _, orbit = met
    section, z = orbit.release
    span, h = orbit.period, 1e-6
    slopes = np.empty((len(z), len(z)))
    for j in range(len(z)):
        ends = [run_round(orbit.params, section, span, z + s * h * np.eye(len(z))[j], section) for s in (1.0, -1.0)]
        change = (ends[0].end - ends[1].end) / (2 * h)
        if isinstance(section, Release):
            change[0] = (ends[0].lasts - ends[1].lasts) / (2 * h) + (1 / orbit.params.Omega if j == 0 else 0.0)
            change *= orbit.params.Omega if j == 0 else 1.0
        slopes[:, j] = change
    ours = orbit.multipliers[: len(z)]
    assert np.poly(np.linalg.eigvals(slopes)) == pytest.approx(np.poly(ours).real, abs=1e-7)


def test_who_is_always_kicked_off_has_a_section_in_flight():
    orbit = find_orbit(settled(KICKED).word, KICKED)
    assert isinstance(orbit.release[0], Moment)
    assert np.isinf(orbit.spells["falls"]).all()


def test_one_ball_is_the_vi_nes():
    ours, theirs = find_orbit("L*R*", ONE), find_orbit("L*R*", VI_NES)
    assert ours.t == pytest.approx(theirs.t, abs=1e-13)
    assert ours.states == pytest.approx(theirs.states, abs=1e-13)
    assert ours.multipliers == pytest.approx(theirs.multipliers, abs=1e-12)
    assert ours.half_multipliers == pytest.approx(theirs.half_multipliers, abs=1e-12)
    # A spell of several balls begins at the merge, of one where its chatter accumulates.
    for name in theirs.spells.dtype.names:
        within = 1e-4 if name in ("t_start", "phase_start") else 1e-10
        assert ours.spells[name] == pytest.approx(theirs.spells[name], abs=within), name
    assert find_orbit("L*R*", TILTED.replace(G=1e-9)).t == pytest.approx(theirs.t, abs=1e-7)
    near = find_orbit("L*R*", ONE.replace(A=0.51), guess=[ours.spells["t_release"][0], ours.spells["v1"][0]])
    assert near.t == pytest.approx(find_orbit("L*R*", ONE.replace(A=0.51), guess=ours).t, abs=1e-12)


def test_a_ball_without_mass_changes_nothing():
    alone = find_orbit("L*R*", TILTED)
    beside = Parallel(
        mu=(VI_NES.mu, 0.0), beta=(1.0, 1.3), r=VI_NES.r, A=VI_NES.A, Omega=VI_NES.Omega, lam=VI_NES.lam, G=0.01
    )
    orbit = find_orbit(settled(beside).word, beside)
    mine = np.array(orbit.word.balls) == 1
    assert orbit.t[mine] == pytest.approx(alone.t, abs=1e-11)
    assert orbit.states[mine] == pytest.approx(alone.states, abs=1e-11)


def test_equal_balls_that_are_struck_at_once_are_one_ball():
    """The law of ties keeps them together: orbit and multipliers are those of one ball with all the mass."""
    one = Parallel(mu=(0.12,), r=0.38, A=2.54, Omega=0.72, lam=0.1)
    alone = find_orbit("L*R*", one)
    run = vines.simulate(EQUAL, periods=400, v2=(0.1, 0.1, 0.1), ties="together")
    assert run.measures(last=1).ties > 0
    assert run.measures(last=1).kinetic_ratio == pytest.approx(alone.measures.kinetic_ratio, rel=1e-9)
    period = vines.simulate(EQUAL, periods=1, ties="together", **{k: v for k, v in run.final.items() if k != "phase"})
    sizes = np.sort(np.abs(np.linalg.eigvals(tangent_map(period))))[::-1]
    assert sizes[:2] == pytest.approx(np.abs(alone.multipliers[:2]), abs=1e-9)


def test_settle_strikes_balls_that_were_let_go_together_one_after_the_other():
    """Sticking takes every difference of equal balls away; the least one that there is would order their impacts."""
    in_turn, together = settled(EQUAL), settled(EQUAL, ties="together")
    assert in_turn.measures.ties > 0
    assert together.measures.ties > 0
    # Cavities that differ by a millionth order them by length; the law of ties is another motion.
    nearly = settled(EQUAL.replace(beta_1=1 - 2e-6, beta_2=1 - 1e-6))
    assert nearly.measures.ties == 0
    assert nearly.measures.kinetic_ratio == pytest.approx(in_turn.measures.kinetic_ratio, rel=1e-6)
    assert abs(together.measures.kinetic_ratio / in_turn.measures.kinetic_ratio - 1) > 2e-3
    with pytest.raises(StateError, match="ties is 'apart'"):
        vines.settle(EQUAL, ties="apart")


def test_a_family_ends_where_its_chatter_does():
    branch = continue_orbit(find_orbit("L*R*", TILTED), "A", 0.3)
    assert branch.ends == ("range", "incomplete_chatter")
    end = branch.bifurcations[-1].value
    assert find_orbit("L*R*", TILTED.replace(A=end + 1e-6), guess=branch.orbits[-1]).stable
    with pytest.raises(OrbitNotFound):
        find_orbit("L*R*", TILTED.replace(A=end - 1e-6), guess=branch.orbits[-1])
    assert continue_orbit(find_orbit("L*R*", ONE), "A", 0.4).bifurcations[-1].value == pytest.approx(
        0.44865639866870555, abs=1e-9
    )


def test_bifurcations_of_one_ball_are_those_of_the_vi_nes_and_go_on_where_it_is_tilted():
    p = Params(mu=0.0784564, A=0.171193, Omega=1.33447, r=0.302436, lam=0.0900701)
    q = Parallel(mu=(p.mu,), A=p.A, Omega=p.Omega, r=p.r, lam=p.lam)
    (theirs, _), (found, _) = (continue_orbit(find_orbit("LR*/3T", each), "A", 0.34).bifurcations for each in (p, q))
    assert found.type == theirs.type == "period_doubling"
    assert found.value == pytest.approx(theirs.value, abs=1e-13)
    (doubled,) = switch_branch(found)
    assert (str(doubled.word), doubled.stable) == ("LR*LR*/6T", True)
    curve = follow_curve(found, ("A", "G"), box={"A": (0.15, 0.2), "G": (0.0, 0.002)}, step=0.3)
    for orbit in (curve.orbits[0], curve.orbits[-1]):
        assert np.abs(orbit.multipliers + 1).min() < 1e-9
        assert orbit.residual < 1e-12
    farther = curve.orbits[int(np.argmax(curve.values[:, 1]))]
    assert farther.params.G > 1e-3
    before, after = (farther.params.replace(A=farther.params.A + change) for change in (-2e-4, 2e-4))
    assert find_orbit("LR*/3T", before, guess=farther).stable
    assert not find_orbit("LR*/3T", after, guess=farther).stable


def test_a_curve_of_two_balls_of_which_one_sticks():
    """On either side of it runs settle to the period, and to twice it."""
    p = Parallel(mu=(0.0784564, 1e-3), beta=(1.0, 0.8), r=(0.302436, 0.6), A=0.18, Omega=1.33447, lam=0.0900701)
    orbit = find_orbit("L1*L2R2L2R2R1L2R2/3T", p)
    [found] = continue_orbit(orbit, "A", 0.185).bifurcations
    curve = follow_curve(found, ("A", "G"), box={"A": (0.17, 0.19), "G": (0.0, 0.002)}, step=0.3)
    assert (curve.type, curve.ends) == ("period_doubling", ("box", "box"))
    farther = curve.orbits[int(np.argmax(curve.values[:, 1]))]
    assert farther.params.G > 1e-3
    assert farther.residual < 1e-12
    assert np.abs(farther.multipliers + 1).min() < 1e-9
    start = {name: value for name, value in farther.start().items() if name != "t"}
    for change, period in ((-1e-3, 3), (1e-3, 6)):
        beside = farther.params.replace(A=farther.params.A + change)
        assert settled(beside, phi=farther.phase[0], settle=3000, **start).p == period


def test_what_is_struck_at_once_leaves_as_the_simulator_has_it():
    run = vines.simulate(EQUAL, periods=400, v2=(0.1, 0.1, 0.1), ties="together")
    section, z = next(sections_of(run, "together", 2))
    hits = balls_orbit(Word("L1*L2*L3*R1*R2*R3*"), EQUAL, Begun(section, z)).impacts
    for three in (hits[:3], hits[3:]):
        gained = sum(mu * (hit["v2_after"] - hit["v2"]) for mu, hit in zip(EQUAL.mu, three, strict=True))
        assert np.ptp(three["t"]) == np.ptp(three["v1"]) == 0.0
        assert three["v1_after"] == pytest.approx(three["v1"] - gained, abs=1e-12)
        assert three["v2_after"] == pytest.approx(three["v1_after"] + 0.38 * three["w_dot"], abs=1e-12)


def test_mirror_images_and_what_is_refused():
    orbit = find_orbit("L*R*", ONE)
    assert mirror_image(orbit).t == pytest.approx(orbit.t, abs=1e-12)
    with pytest.raises(ParameterError, match="has to be an orbit"):
        find_orbit(settled(UNEQUAL).word, UNEQUAL, guess=[0.1, 0.2])
    end = continue_orbit(orbit, "A", 0.4).bifurcations[-1]
    with pytest.raises(OrbitNotFound, match="are followed, not of incomplete_chatter"):
        follow_curve(end, ("A", "mu_1"), box={"A": (0.4, 0.5), "mu_1": (0.02, 0.03)})
