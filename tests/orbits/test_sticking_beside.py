"""Orbits that stick of a ball in a frame with a cubic spring, a mass on a spring or modes: DOP853, and the VI-NES."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vines
from vines import Params, find_orbit
from vines.errors import ParameterError
from vines.orbits import continue_orbit, follow_curve, mirror_image, switch_branch
from vines.orbits._release_of_balls import run_round
from vines.systems import Duffing, Hybrid, Modes

VI_NES = Params(mu=0.0256654, Omega=1.02946, r=0.347164, lam=0.0959532, A=0.5)
"""Where docs/sticking.md follows L*R*."""

TRIPLE = Params(mu=0.0784564, A=0.171193, Omega=1.33447, r=0.302436, lam=0.0900701)
"""LR*/3T, whose period doubles at A = .18047."""

SYSTEMS = {
    "duffing": Duffing(mu=0.122, A=1.01, Omega=0.888, r=0.409, lam=0.0643, alpha=1.08),
    "hybrid": Hybrid(mu=0.014, A=0.168, Omega=1.38, r=0.37, lam=0.0135, mu_n=0.093, k1=0.32, k3=0.27, l2=0.021),
    "modes": Modes(
        mu=0.0478, A=0.8, Omega=0.716, r=0.149, omega=(1, 2.26), lam=(0.111, 0.251), phi=(1, 0.84), gamma=(1, -0.59)
    ),
}


@pytest.fixture(scope="module", params=SYSTEMS.values(), ids=SYSTEMS.keys())
def met(request):
    attractor = vines.settle(request.param, lyapunov=False, errors=False)
    assert "*" in attractor.word
    return attractor, find_orbit(attractor.word, request.param)


def test_the_word_of_an_attractor_gives_its_orbit(met):
    attractor, orbit = met
    assert (str(orbit.word), orbit.stable, orbit.admissible) == (attractor.word, True, True)
    assert orbit.symmetric == attractor.symmetric
    assert orbit.measures.kinetic_ratio == pytest.approx(attractor.measures.kinetic_ratio, rel=1e-10)
    assert orbit.residual < 1e-11
    assert abs(orbit.energy_imbalance) < 1e-11
    # Those of the tangent map over the recorded run, which knows of no release.
    assert np.poly(orbit.multipliers) == pytest.approx(np.poly(attractor.multipliers), abs=1e-9)
    assert np.poly(np.linalg.multi_dot([np.eye(len(orbit.multipliers)), *orbit.jacobians[::-1]])) == pytest.approx(
        np.poly(orbit.multipliers), abs=1e-8
    )
    image = mirror_image(orbit)
    assert mirror_image(image).t == pytest.approx(orbit.t, abs=1e-11)


def test_slopes_are_differences_of_the_simulator(met):
    _, orbit = met
    section, z = orbit.release
    n, span, h = len(z), orbit.period, 1e-6
    slopes = np.empty((n, n))
    for j in range(n):
        ends = [run_round(orbit.params, section, span, z + s * h * np.eye(n)[j], section) for s in (1.0, -1.0)]
        change = np.array([ends[0].lasts - ends[1].lasts, *(ends[0].end - ends[1].end)[1:]]) / (2 * h)
        # A start at a later phase comes back later by as much.
        slopes[:, j] = (change + np.eye(n)[0] / orbit.params.Omega) * orbit.params.Omega if j == 0 else change
    assert np.poly(slopes) == pytest.approx(np.poly(orbit.multipliers[:n]).real, abs=1e-7)


class Frame:
    """A frame by its own equations: coordinates s, their rates with a mass that rides, and what a blow does to them."""

    def __init__(self, p):
        self.p = p
        self.shapes = np.array(getattr(p, "phi", (1.0,)))
        self.ratio = p.mu * float(self.shapes @ self.shapes)

    def base(self, t):
        p = self.p
        sine, cosine = np.sin(p.Omega * t), np.cos(p.Omega * t)
        return p.A * sine, p.A * p.Omega * cosine, -p.A * p.Omega**2 * sine

    def enter(self, t, at):
        p = self.p
        if not isinstance(p, Modes):
            return np.array([at["x1"], at["v1"], *(at[name] for name in ("x3", "v3") if name in at)])
        e, rate, _ = self.base(t)
        far = np.array([at[f"q_{k}"] for k in range(2, p.modes + 1)]) - np.array(p.gamma[1:]) * e
        fast = np.array([at[f"q_dot_{k}"] for k in range(2, p.modes + 1)]) - np.array(p.gamma[1:]) * rate
        first = (at["x1"] - e - self.shapes[1:] @ far) / p.phi[0], (at["v1"] - rate - self.shapes[1:] @ fast) / p.phi[0]
        return np.array([first[0], *far, first[1], *fast])

    def place(self, t, s):
        if not isinstance(self.p, Modes):
            return s[0], s[1]
        e, rate, _ = self.base(t)
        n = self.p.modes
        return e + self.shapes @ s[:n], rate + self.shapes @ s[n:]

    def rates(self, t, s, rides):
        p = self.p
        e, rate, bend = self.base(t)
        if isinstance(p, Modes):
            n, omega, lam, gamma = p.modes, np.array(p.omega), np.array(p.lam), np.array(p.gamma)
            free = -lam * s[n:] - omega**2 * s[:n] - gamma * bend
            a = (bend + self.shapes @ free) / (1 + rides * self.ratio)
            return np.array([*s[n:], *(free - rides * p.mu * self.shapes * a)]), a
        push, more = e + p.lam * rate - s[0] - p.lam * s[1], []
        if isinstance(p, Duffing):
            push -= p.alpha * s[0] ** 3
        else:
            spring = p.k1 * (s[0] - s[2]) + p.k3 * (s[0] - s[2]) ** 3 + p.l2 * (s[1] - s[3])
            push, more = push - p.mu_n * spring, [s[3], spring]
        a = push / (1 + rides * p.mu)
        return np.array([s[1], a, *more]), a

    def blow(self, s, change):
        out = s.copy()
        if isinstance(self.p, Modes):
            out[self.p.modes :] += self.shapes * change / (self.shapes @ self.shapes)
        else:
            out[1] += change
        return out


def flown(p, t, at, lasts):
    """Return x1, v1, x2, v2 a time after a state of flight, by DOP853; chatters are followed down to 1e-6."""
    frame, end, rides, wall, fine = Frame(p), t + lasts, 0, 0, 0.05
    s, x2, v2 = frame.enter(t, at), at["x2"], at["v2"]
    ratio = frame.ratio
    while True:
        began, x20, v20 = t, x2, v2

        def gap(t, s, began=began, x20=x20, v20=v20):
            return frame.place(t, s)[0] - x20 - v20 * (t - began)

        def left(t, s, gap=gap, wall=wall, began=began):
            return 1 - gap(t, s) if t > began or wall != 1 else 1.0

        def right(t, s, gap=gap, wall=wall, began=began):
            return 1 + gap(t, s) if t > began or wall != -1 else 1.0

        def let_go(t, s, rides=rides):
            return rides * frame.rates(t, s, abs(rides))[1]

        events = [let_go] if rides else [left, right]
        for event in events:
            event.terminal, event.direction = True, -1
        run = solve_ivp(
            lambda t, s, rides=rides: frame.rates(t, s, abs(rides))[0], (t, end), s, "DOP853", events=events,
            rtol=1e-12, atol=1e-14, max_step=fine,
        )  # fmt: skip
        t, s = run.t[-1], run.y[:, -1].copy()
        x1, v1 = frame.place(t, s)
        x2, v2 = (x1 - rides, v1) if rides else (x20 + v20 * (t - began), v20)
        if run.status == 0:
            return np.array([x1, v1, x2, v2])
        if rides:
            wall, rides, fine = rides, 0, 0.05
            continue
        wall = 1 if len(run.t_events[0]) else -1
        closing, push = v1 - v2, wall * frame.rates(t, s, 0)[1]
        x2 = x1 - wall
        if p.r * abs(closing) < 1e-6 and push > 0:
            s, rides, fine = frame.blow(s, -ratio / (1 + ratio) * closing), wall, 0.05
            continue
        s = frame.blow(s, -(1 + p.r) * ratio / (1 + ratio) * closing)
        v2 += (1 + p.r) / (1 + ratio) * closing
        fine = min(0.05, 0.2 * p.r * abs(closing) / max(abs(push), 0.1))


@pytest.mark.parametrize(
    "name", ["modes", pytest.param("hybrid", marks=pytest.mark.full), pytest.param("duffing", marks=pytest.mark.full)]
)
def test_it_closes_in_dop853(name):
    p = SYSTEMS[name]
    orbit = find_orbit(vines.settle(p, lyapunov=False, errors=False).word, p)
    # From the middle of a long flight of ours, where nothing is decided, once round.
    run = vines.simulate(p, **orbit.start(), periods=orbit.word.p)
    ends = np.append(run.events["t"][1:], run.t_end)
    k = int(np.argmax((ends - run.events["t"]) * (run.rows[:, 11] == 0)))
    middle = 0.5 * (run.events["t"][k] + ends[k])
    begun = vines.simulate(p, **orbit.start(), periods=(middle - orbit.t[0]) / p.period).final
    state = [begun[name] for name in ("x1", "v1", "x2", "v2")]
    assert flown(p, middle, begun, orbit.period) == pytest.approx(state, abs=1e-9)


@pytest.mark.parametrize(
    "p",
    [
        Duffing(**VI_NES.as_dict()),
        Hybrid(**VI_NES.as_dict(), k1=0.5, k3=0.2, l2=0.2),
        Modes(mu=VI_NES.mu, A=VI_NES.A, Omega=VI_NES.Omega, r=VI_NES.r, lam=VI_NES.lam),
    ],
    ids=["duffing", "hybrid", "modes"],
)
def test_the_limit_is_the_vi_nes(p):
    theirs = find_orbit("L*R*", VI_NES)
    guess = None if isinstance(p, Hybrid) else [theirs.spells["t_release"][0], theirs.spells["v1"][0]]
    ours = find_orbit("L*R*", p, guess=guess)
    assert ours.t == pytest.approx(theirs.t, abs=1e-12)
    assert ours.states[:, :4] == pytest.approx(theirs.states, abs=1e-11)
    # The mass moves as the oscillator makes it, with two multipliers of its own.
    passive = [each for each in ours.multipliers if each != 0][2:]
    assert len(passive) == (2 if isinstance(p, Hybrid) else 0)
    assert np.poly(ours.multipliers) == pytest.approx(np.poly([*theirs.multipliers, *passive]), abs=1e-11)
    for name in theirs.spells.dtype.names:
        within = 1e-4 if name in ("t_start", "phase_start") else 1e-10
        assert ours.spells[name] == pytest.approx(theirs.spells[name], abs=within), name


@pytest.mark.parametrize(
    ("p", "parameter"),
    [
        (Duffing(**TRIPLE.as_dict(), alpha=0.003), "alpha"),
        (Hybrid(**TRIPLE.as_dict(), mu_n=0.0005, k1=0.5, k3=0.2, l2=0.2), "mu_n"),
        (
            Modes(
                mu=TRIPLE.mu, A=TRIPLE.A, Omega=TRIPLE.Omega, r=TRIPLE.r, omega=(1, 2.3), lam=(TRIPLE.lam, 0.2),
                phi=(1, 0.01), gamma=(1, 0.1),
            ),
            "phi_2",
        ),
    ],
    ids=["duffing", "hybrid", "modes"],
)  # fmt: skip
@pytest.mark.full
def test_the_doubled_family_and_a_curve_of_it(p, parameter):
    orbit = find_orbit("LR*/3T", p)
    [found] = continue_orbit(orbit, "A", 0.186, step=0.2).bifurcations
    assert found.type == "period_doubling"
    assert found.multiplier == pytest.approx(-1, abs=1e-9)
    [doubled] = switch_branch(found)
    assert (str(doubled.word), doubled.stable) == ("LR*LR*/6T", True)
    # As what is not of the VI-NES vanishes the curve comes to its doubling.
    most = p.as_dict()[parameter] * 1.01
    curve = follow_curve(found, ("A", parameter), box={"A": (0.17, 0.19), parameter: (0.0, most)}, step=0.3)
    end = curve.orbits[int(np.argmin(curve.values[:, 1]))]
    assert end.params.as_dict()[parameter] == 0.0
    assert pytest.approx(0.1804684960845155, abs=1e-10) == end.params.A


def test_a_family_ends_where_its_chatter_does_and_what_is_refused():
    p = Hybrid(**VI_NES.as_dict(), mu_n=0.001, k1=0.5, k3=0.2, l2=0.2)
    branch = continue_orbit(find_orbit("L*R*", p), "A", 0.43, step=0.5)
    assert branch.ends == ("range", "incomplete_chatter")
    with pytest.raises(ParameterError, match="has to be an orbit; it is"):
        find_orbit("L*R*", p, guess=[0.0, 1.0])
