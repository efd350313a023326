"""Patterns n:m/pT: the smallest p, and what mirror image, half a period and a shift of time leave alone."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.rig.quantities._pattern import cut_into_periods, find_pattern

PERIODS, TURN = 48, 2 * np.pi
WORDS = st.lists(st.text("LR", min_size=0, max_size=4), min_size=1, max_size=3).filter(any)


def counts(words):
    return [(word.count("L"), word.count("R")) for word in words]


def smallest(words):
    """Return the least number of periods after which the counts come again."""
    told = counts(words)
    return next(p for p in range(1, len(told) + 1) if len(told) % p == 0 and told == told[:p] * (len(told) // p))


def train(words, start=0.0, jitter=None):
    """Return phases and sides of a train that repeats words, impacts of a period an eighth of it apart."""
    phase, side = [], []
    for k in range(PERIODS):
        for j, letter in enumerate(words[k % len(words)]):
            phase.append(start + TURN * (k + 0.2 + j / 8))
            side.append(1.0 if letter == "L" else -1.0)
    phase = np.array(phase)
    return phase + (0.0 if jitter is None else jitter[: len(phase)]), np.array(side)


def shown(phase, side, start=0.0):
    periods = cut_into_periods(phase, side, (start, start + TURN * PERIODS))
    return find_pattern(periods, phase)


@settings(max_examples=60)
@given(words=WORDS, start=st.floats(0, 100 * TURN), seed=st.integers(0, 99))
def test_symmetries_of_the_model_leave_the_pattern_alone(words, start, seed):
    jitter = 0.05 * np.random.default_rng(seed).normal(size=4 * PERIODS)
    phase, side = train(words, jitter=jitter)
    found = shown(phase, side)
    p = smallest(words)
    n, m = (sum(column) for column in zip(*counts(words[:p]), strict=True))
    assert (found.n, found.m, found.p) == (n, m, p)
    assert found.name == (f"{n}:{m}" if p == 1 else f"{n}:{m}/{p}T")
    assert found.holds
    later = shown(phase + start, side, start)
    assert (later.name, later.fraction) == (found.name, found.fraction)
    mirrored = shown(phase + np.pi, -side, np.pi)
    assert (mirrored.n, mirrored.m, mirrored.p) == (m, n, p)
    assert mirrored.fraction == found.fraction


def test_times_that_alternate_double_the_period():
    phase, side = train(["LR"])
    rng = np.random.default_rng(1)
    doubled = phase + 0.2 * np.where(np.arange(len(phase)) // 2 % 2, 1.0, -1.0) + 0.03 * rng.normal(size=len(phase))
    assert shown(doubled, side).name == "2:2/2T"
    assert shown(phase + 0.2 * rng.normal(size=len(phase)), side).name == "1:1"


def test_a_pattern_holds_in_95_percent_of_the_periods_or_is_mixed():
    words = ["LR"] * PERIODS
    for k in (5, 20):
        words[k] = "LLR"
    assert shown(*train(words)).name == "1:1"
    words[33] = "LLR"
    found = shown(*train(words))
    assert (found.name, found.holds) == ("mixed", False)
    assert found.fractions["2:1"] > 0.06
    assert shown(np.zeros(0), np.zeros(0)).name == "none"
