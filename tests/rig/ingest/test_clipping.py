"""Clipping against signals of which it is known where they were cut off."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vines.rig.ingest._clipping import clipped_samples, flat_ends


def record(bits, samples, amplitude, phase, clip=np.inf, noise=0.0):
    """Return eight periods of a sine as a recorder of a range of 1 keeps it, and where it was cut off."""
    t = np.arange(round(8 * samples)) / samples
    sine = amplitude * np.sin(2 * np.pi * t + phase) + noise * np.random.default_rng(0).normal(size=len(t))
    step = 2.0 / 2**bits
    return np.round(np.clip(sine, -clip, clip) / step) * step, np.abs(sine) > clip + step


@given(
    bits=st.integers(8, 12),
    samples=st.floats(500, 5000),
    amplitude=st.floats(0.1, 0.95),
    phase=st.floats(0, 6.28),
    noise=st.sampled_from([0.0, 0.3, 1.0, 3.0]),
)
def test_the_quantised_top_of_a_sine_is_no_clipping(bits, samples, amplitude, phase, noise):
    values, _ = record(bits, samples, amplitude, phase, noise=noise * 2.0 / 2**bits)
    # By the chance of where samples fall a top of a few samples may look cut off.
    assert flat_ends(values).mean() < 2e-3


@given(
    bits=st.integers(8, 24),
    samples=st.floats(200, 5000),
    amplitude=st.floats(0.5, 0.95),
    phase=st.floats(0, 6.28),
    depth=st.floats(0.7, 0.95),
)
def test_a_sine_that_is_cut_off_is_clipped(bits, samples, amplitude, phase, depth):
    values, cut = record(bits, samples, amplitude, phase, clip=depth * amplitude)
    lost = flat_ends(values)
    # Of a stretch that the record begins or ends in, fewer samples than make it flat may be there.
    assert lost[2:-2][cut[2:-2]].all()
    assert lost.sum() <= cut.sum() + 0.2 * len(values)


@pytest.mark.parametrize("limit", [1.0, 0.94])
def test_the_end_of_the_range_is_always_clipped(limit):
    values, _ = record(8, 1000, 0.95, 0.1)
    assert clipped_samples(values, limit).sum() == (np.abs(values) >= 0.9999 * limit).sum()


def test_a_digital_line_is_not_clipped():
    assert not flat_ends(np.repeat([0.0, 5.0, 0.0, 5.0], 100)).any()
