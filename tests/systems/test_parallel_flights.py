"""Balls in parallel cavities: no contact missed or invented, and groups that ride, against DOP853 and brute force."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vines
from vines.dynamics.kernels import rows as col
from vines.systems import Parallel

BALL, X2 = col.ROW, col.ROW + 3


def system(rng, balls, **given):
    """Return a random system; its balls have lengths of their own, so that several may come together."""
    found = {
        "mu": rng.uniform(0.002, 0.1, balls), "beta": rng.uniform(0.5, 1.6, balls), "r": rng.uniform(0.2, 0.95, balls),
        "A": 10 ** rng.uniform(-2, 0.5), "Omega": rng.uniform(0.6, 1.6), "G": rng.uniform(-0.02, 0.02),
    }  # fmt: skip
    return Parallel(**{**found, **given})


def forced(p, t):
    return p.A * (math.sin(t) + p.lam * p.Omega * math.cos(t))


def rate(p, phase, ride):
    """Return the equations of motion; balls of the set `ride` are held on their wall by the forces of contact."""
    held = sum(p.mu[i] for i in ride)

    def of(t, y):
        # Newton for frame and riders together: their weights pull the frame, their mass goes with it.
        a = (forced(p, phase + p.Omega * t) - p.lam * y[1] - y[0] - held * p.G) / (1.0 + held)
        balls = [(y[1], a) if i in ride else (y[3 + 2 * i], -p.G) for i in range(p.balls)]
        return [y[1], a, *(each for ball in balls for each in ball)]

    return of


@pytest.mark.parametrize("balls", [2, 3, pytest.param(8, marks=pytest.mark.full)])
def test_no_contact_is_missed_and_none_invented(balls):
    """In closed form at many more times than the search looks at, every ball is in its cavity; at its contacts it is on
    its wall, and it comes there."""
    rng = np.random.default_rng(balls)
    contacts = 0
    for _ in range(30):
        p = system(rng, balls)
        run = vines.simulate(p, v2=tuple(rng.uniform(-1, 1, balls)), x1=rng.uniform(-0.3, 0.3), periods=15)
        assert run.status == "complete"
        at = run.sample(6000)
        size = 1.0 + np.abs(at["x1"]).max()
        for k, beta in enumerate(p.beta, start=1):
            assert (np.abs(at[f"w_{k}"]) - beta).max() <= 1e-13 * size
        hits = run.impacts
        beta = np.array(p.beta)[hits["ball"] - 1]
        assert hits["x1"] - hits["x2"] == pytest.approx(hits["side"] * beta, abs=1e-13 * size)
        assert (hits["side"] * hits["w_dot"] > 0).all()
        contacts += len(hits)
    assert contacts > 1000


@pytest.mark.parametrize("balls", [2, 3])
def test_every_spell_of_riding_against_dop853(balls):
    """Between rows with riders: motion as integrated, contact forces that push until the release and vanish there."""
    rng = np.random.default_rng(10 + balls)
    spells = groups = releases = 0
    for A, Omega, G in ((0.5, 0.6, 0.0), (1.0, 1.0, 0.0), (1.0, 0.6, 0.0), (0.02, 0.5, 0.01), (3.0, 1.3, 0.01)):
        p = system(rng, balls, r=rng.uniform(0.1, 0.35, balls), A=A, Omega=Omega, G=G)
        rows = vines.simulate(p, v2=tuple(rng.uniform(-1, 1, balls)), periods=8).rows
        for row, after in itertools.pairwise(rows):
            mode = int(row[col.MODE])
            if mode == 0 or after[col.TAU] < 1e-6:
                continue
            ride = [i for i in range(balls) if abs(mode) >> i & 1]
            of = rate(p, row[col.PHASE], ride)
            begin = [row[col.X1], row[col.A_V1], *row[X2 : X2 + 2 * balls]]
            flown = solve_ivp(of, (0, after[col.TAU]), begin, "DOP853", rtol=1e-12, atol=1e-13, max_step=0.1)
            y = flown.y
            assert y[:2, -1] == pytest.approx([after[col.X1], after[col.V1]], abs=1e-10)
            push = np.sign(mode) * np.array([of(t, y[:, k])[1] + p.G for k, t in enumerate(flown.t)])
            assert push[:-1].min() > -1e-9
            free = [i for i in range(balls) if i not in ride]
            if free:
                gaps = np.array([np.abs(y[0] - y[2 + 2 * i]) / p.beta[i] for i in free])
                assert gaps[:, 1:-1].max(initial=0.0) < 1
            if after[col.KIND] == col.RELEASE:
                assert push[-1] == pytest.approx(0.0, abs=1e-9)
                releases += 1
            spells += 1
            groups += len(ride) > 1
    assert spells > 20
    assert groups > 3
    assert releases > 10


SMALL = 3e-6
"""Speed below which the integration takes a ball that is pushed against its wall as riding: its hops are 1e-12 high."""


def struck(p, y, i, ride, wall, side):
    """Let ball i hit, and then the riders, one after the other as they are approached; return those that ride on."""
    y[2 + 2 * i] = y[0] - side * p.beta[i]
    now = [i]
    while now:
        (k,) = now
        w = y[1] - y[3 + 2 * k]
        y[1] -= p.mu[k] * (1 + p.r[k]) * w / (1 + p.mu[k])
        y[3 + 2 * k] = y[1] + p.r[k] * w
        now = [j for j in ride if wall * (y[1] - y[3 + 2 * j]) > 0]
    return [j for j in ride if wall * (y[1] - y[3 + 2 * j]) == 0]


def integrated(p, v2, until):
    """Return impacts faster than 1e-3 as (time, ball, wall), times at which contact is lost, the end, by DOP853."""
    n = p.balls
    y = np.array([0.0, 0.0, *(each for v in v2 for each in (0.0, v))])
    t, ride, wall, hits, released = 0.0, [], 0, [], []
    hop = dict.fromkeys(range(n), 0.0)  # until when a ball that has just left its wall is not asked for it
    while t < until:
        of = rate(p, p.Omega * t, ride)
        marks = [(i, side) for i in range(n) for side in (1, -1) if i not in ride and t >= hop[i]]
        events = []
        for i, side in marks:
            events.append(lambda _, y, i=i, side=side: p.beta[i] - side * (y[0] - y[2 + 2 * i]))
        if ride:
            events.append(lambda s, y, of=of, wall=wall: wall * (of(s, y)[1] + p.G))
        for event in events:
            event.terminal, event.direction = True, -1
        stop = min([until, *(each for each in hop.values() if each > t)])
        done = solve_ivp(of, (0, stop - t), y, "DOP853", rtol=1e-12, atol=1e-13, max_step=0.05, events=events or None)
        first = [k for k, at in enumerate(done.t_events or []) if len(at)]
        t, y = (t + done.t[-1] if first else stop), done.y[:, -1].copy()
        if not first:
            continue
        if first[0] == len(marks):
            released.append(t)
            ride = []
            continue
        i, side = marks[first[0]]
        w = y[1] - y[3 + 2 * i]
        if abs(w) > 1e-3:
            hits.append((t, i, side))
        before = ride
        ride = struck(p, y, i, ride, wall, side)
        for j in [i, *(j for j in before if j not in ride)]:
            own = side if j == i else wall
            push, speed = own * (rate(p, p.Omega * t, ride)(0.0, y)[1] + p.G), abs(y[1] - y[3 + 2 * j])
            if speed < SMALL and push > 0:
                held = 1.0 + sum(p.mu[k] for k in ride)
                y[1] = (y[1] * held + p.mu[j] * y[3 + 2 * j]) / (held + p.mu[j])
                ride, wall = [*ride, j], own
                for k in ride:
                    y[3 + 2 * k] = y[1]
            else:
                hop[j] = t + (min(0.5 * speed / push, 0.01) if push > 0 else 0.01)
    return hits, released, y


@pytest.mark.parametrize(
    ("p", "periods"),
    [
        (Parallel(mu=(0.05, 0.02), beta=(1.0, 1.2), r=(0.25, 0.35), A=1.0, Omega=0.7), 3.3),
        (Parallel(mu=(0.03, 0.02, 0.04), beta=(1.0, 1.3, 0.8), r=(0.2, 0.3, 0.25), A=0.5, Omega=0.6), 2.3),
        (Parallel(mu=(0.03, 0.02, 0.04), beta=(1.0, 1.3, 0.8), r=(0.2, 0.3, 0.25), A=0.5, Omega=0.7, G=0.01), 3.3),
    ],
    ids=["two", "three", "three tilted"],
)
def test_whole_runs_with_chatter_and_riding_against_dop853(p, periods):
    """An integration that knows no closed form and counts the impacts of every chatter down to a speed of 3e-6."""
    v2 = (0.1, -0.3, 0.2)[: p.balls]
    hits, released, end = integrated(p, v2, periods * p.period)
    run = vines.simulate(p, v2=v2, periods=periods)
    fast = run.impacts[np.abs(run.impacts["w_dot"]) > 1e-3]
    assert list(zip(fast["ball"] - 1, fast["side"], strict=True)) == [each[1:] for each in hits]
    assert fast["t"] == pytest.approx([each[0] for each in hits], abs=1e-7)
    lost = run.rows[(run.rows[:, col.KIND] == col.RELEASE) & (run.rows[:, col.TAU] > 0), col.TIME]
    assert len(lost) > 0
    assert lost == pytest.approx(released, abs=1e-7)
    at = run.sample(times=[periods * p.period])
    assert [at["x1"][0], at["v1"][0]] == pytest.approx(end[:2], abs=1e-7)
