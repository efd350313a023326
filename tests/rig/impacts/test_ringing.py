"""Modes of the frame: poles by the flights alone, and what rings on from impacts before the record."""

import numpy as np
import pytest

from vines.rig.fit import Bins
from vines.rig.impacts._resonances import resonances
from vines.rig.impacts._ringing import less_modes, modes_felt, rung
from vines.rig.recording import Sampled

F = 8.8156
MODES = ((38.0, 0.008), (112.0, 0.008), (310.0, 0.01))
POLES = [2 * np.pi * f * complex(-z, np.sqrt(1 - z * z)) for f, z in MODES]


def impacts(rng):
    """Return impacts that are nearly periodic, from three seconds before the record on."""
    t = np.arange(-3.0, 12.0, 0.5 / F)
    return t + 5e-4 * rng.normal(size=len(t)), 0.014 * np.where(np.arange(len(t)) % 2, 1.0, -1.0)


@pytest.fixture
def rings():
    """Return times, a base that moves by a harmonic and feels modes, what these are, and the impacts of the record."""
    rng = np.random.default_rng(3)
    hits, dv = impacts(rng)
    t = np.arange(12 * 3200) / 3200
    felt = sum((0.5j / abs(s) * rung(t, hits, dv, s)[0]).real for s in POLES)
    inside = hits > 0
    return t, 2e-4 * np.sin(2 * np.pi * F * t), felt, 1e-7 * rng.normal(size=len(t)), hits[inside], dv[inside]


def test_poles_follow_from_flights_whatever_rang_before(rings):
    t, moved, felt, noise, hits, _ = rings
    found = resonances(Bins(t, 40 * moved + felt + noise, 1 / 3200), hits)
    for s in POLES:
        assert np.abs(found - s).min() < 2e-3 * abs(s)


def test_what_rings_on_from_before_the_record_is_taken_off_as_well(rings):
    t, moved, felt, noise, hits, dv = rings
    channel = Sampled("base", "base_disp", 3200.0, 0.0, moved + felt + noise, np.ones(len(t), bool))
    found = modes_felt(channel, 2 * np.pi * F, POLES, hits, dv)
    assert len(found) == 3
    left = less_modes(channel, found, hits, dv).values - moved
    assert np.std(felt[:1600]) > 20 * np.std(noise)
    assert np.std(left[:1600]) < 1.1 * np.std(noise)
    assert (
        modes_felt(
            Sampled("base", "base_disp", 3200.0, 0.0, moved + noise, channel.valid), 2 * np.pi * F, POLES, hits, dv
        )
        == ()
    )
