"""The fundamental of a channel is there also where something rings louder."""

import numpy as np

from vines.rig.ingest._tone import find_tone

RATE, SECONDS = 12800.0, 12.0


def channel(forcing):
    rng = np.random.default_rng(3)
    t = np.arange(round(RATE * SECONDS)) / RATE
    loud = np.zeros(len(t))
    for hit in rng.uniform(0.0, SECONDS, 200):
        since = np.maximum(t - hit, 0.0)
        loud += rng.choice([-1.0, 1.0]) * np.exp(-6.0 * since) * np.sin(2 * np.pi * 112.0 * since)
    return find_tone(forcing * np.sin(2 * np.pi * 8.8 * t) + loud, np.ones(len(t), bool), RATE, 0.0, 8.8)


def test_a_forcing_below_modes_that_ring_is_steady():
    tone = channel(0.3)
    assert not tone.clear
    assert tone.steady


def test_a_channel_that_only_rings_is_not():
    tone = channel(0.0)
    assert not tone.clear
    assert not tone.steady
