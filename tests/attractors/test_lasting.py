"""Whether what is seen lasts: chaos that ends, motion that loses nothing, and orbits longer than were looked for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vines.attractors import classify_many, settle, settle_from
from vines.model import Params
from vines.systems import ImpactPair, Parallel

# Chaos from rest, found by 294 random points to be left later on: the first within some hundred periods.
TRANSIENT = Params(mu=0.0127005, A=0.0502123, Omega=1.3635392, r=0.7990077, lam=0.3377916)
LONG = Params(mu=2.327064, A=0.1188799, Omega=0.5763667, r=0.7256402, lam=0.2053700)
PERIOD_48 = Params(mu=0.007796, A=0.010240977443609, Omega=0.9574, r=0.7107, lam=0.1331)


def test_chaos_that_ends_while_it_is_watched_is_not_what_a_run_settles_to() -> None:
    found = settle(TRANSIENT)
    assert (found.regime, found.settled, found.name) == ("periodic", True, "1:1/3T")
    assert found.transient > 400
    many = classify_many(TRANSIENT)
    assert (many.regime[0], many.name[0]) == ("periodic", "1:1/3T")


def test_of_chaos_that_lasts_it_is_said_for_how_long_it_was_watched_and_how_soon_it_may_end() -> None:
    found = settle(LONG)
    assert found.regime == "chaotic"
    assert found.watched >= 64 + 9 * 64
    # At this rate one run in twenty would have stayed for as long.
    assert math.exp(-found.escape_rate * found.watched) == pytest.approx(0.05)
    assert f"watched for {found.watched:g} periods" in str(found)
    # It is left one day (from the state that the issue had, for 10:10/3T).
    later = settle_from(LONG, found.final, settle=100_000, errors=False)
    assert later.regime in ("periodic", "chaotic")


def test_the_limit_of_the_escape_rate_holds_where_the_lifetime_is_known() -> None:
    """A run whose rate of escape is beyond the limit is called chaos with a chance of one in 20 at most."""
    rng = np.random.default_rng(4)
    rates = 10.0 ** rng.uniform(-5.0, -1.0, 20_000)
    lives, watched = rng.exponential(1.0 / rates), 896.0
    stayed = lives > watched
    limit = -math.log(0.05) / watched
    assert np.mean(stayed[rates > limit]) < 0.05


@pytest.mark.parametrize(
    "p",
    [
        Params(mu=0.1, A=0.03, lam=0.0, r=1.0),
        ImpactPair(B=1.5, r=1.0),
        Parallel(mu=(0.1, 0.2), A=0.03, lam=0.0, r=1.0),
    ],
    ids=["VI-NES", "impact pair", "two balls"],
)
def test_where_nothing_is_lost_there_is_no_attractor(p: Params) -> None:
    found = settle(p, settle=20, watch=64, patience=0)
    assert not found.settled
    if found.regime != "unsettled":
        assert "nothing is lost, by damping or in impacts: there is no attractor" in found.reason
    assert math.isnan(found.escape_rate) or found.regime == "chaotic"


def test_many_at_once_know_it_too() -> None:
    many = classify_many({"mu": 0.1, "A": [0.03, 0.03], "lam": [0.0, 0.01], "r": 1.0}, settle=20, watch=64, patience=0)
    assert not many.settled[0]
    assert "nothing is lost" in many.reason[0] or many.regime[0] == "unsettled"


def test_an_orbit_of_48_periods_is_not_called_a_torus_and_can_be_named() -> None:
    found = settle(PERIOD_48, settle=2000)
    assert (found.regime, found.settled) == ("unsettled", False)
    assert "repeats after p = 48 periods, p <= 32 was looked for; largest_p = 48 names it" in found.reason
    named = settle(PERIOD_48, settle=2000, largest_p=48)
    assert (named.regime, named.name, named.recorded) == ("periodic", "16:16/48T", 96.0)
    many = classify_many(PERIOD_48, settle=2000, largest_p=64)
    assert (many.name[0], many.p[0]) == ("16:16/48T", 48)
