"""Settled or not, and how much longer: against decays whose end is known."""

import numpy as np
import pytest

from vines.rig.watch import settling
from vines.rig.watch._settling import slope

RNG = np.random.default_rng(5)


def decay(seconds, tau, size=0.8, noise=0.0, end=41.0 - 8.0j):
    t = np.arange(float(seconds))
    scatter = RNG.normal(size=(2, len(t)))
    return t, end * (1 - size * np.exp(-t / tau)) + noise * abs(end) * (scatter[0] + 1j * scatter[1])


@pytest.mark.parametrize("tau", [2.0, 3.0, 6.0])
@pytest.mark.parametrize("known", [True, False])
def test_the_wait_is_that_of_the_decay(tau, known):
    """Until .8 exp(-t/tau) is one per cent: within a step of the closed form, whether the memory is stated or not."""
    seconds = 8
    found = settling(*decay(seconds, tau), tau if known else None)
    left = tau * np.log(0.8 / 0.01) - (seconds - 1)
    assert not found.settled
    assert found.wait == pytest.approx(left, abs=1.0)
    assert settling(*decay(round(tau * 7), tau), tau if known else None).settled


def test_noise_is_no_transient_and_hides_none_that_is_larger():
    t, z = decay(60, 3.0, noise=0.003)
    assert settling(t, z, 3.0).settled
    assert not settling(t[:9], z[:9], 3.0).settled


def test_what_goes_on_one_way_is_told_and_a_drift_is_not_waited_for():
    t = np.arange(60.0)
    fast, slow = (41.0 * (1 + rate * t / 60) + 0j for rate in (-0.3, -0.02))
    told = settling(t, fast + 1e-3 * RNG.normal(size=60), 3.0)
    assert (told.settled, told.wait) == (False, None)
    assert "falls still" in told.why
    assert settling(t, slow + 1e-3 * RNG.normal(size=60), 3.0).settled


def test_a_motion_that_does_not_repeat_is_steady_nevertheless():
    told = settling(*decay(60, 3.0, noise=0.1), 3.0)
    assert told.settled
    assert "no period is like the next" in told.why


def test_early_is_too_short_to_tell():
    assert settling(*decay(5, 3.0), 3.0).why == "too short to tell"
    assert settling(np.zeros(0), np.zeros(0, complex)).why == "too short to tell"
    assert not settling(np.arange(20.0), np.zeros(20, complex)).settled


def test_slopes_are_covered_by_their_uncertainty():
    t = np.arange(100.0)
    pulls = []
    for _ in range(200):
        rate, u = slope(t, 0.3 * t + RNG.normal(size=100))
        pulls.append((rate - 0.3) / u)
    assert 0.8 < np.std(pulls) < 1.25
