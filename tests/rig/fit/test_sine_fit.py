"""The four-parameter fit of IEEE 1057: the closed form without noise, the Cramér–Rao bound with it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.errors import RigError
from vines.rig.fit._bins import Bins
from vines.rig.fit._sine_fit import sine_fit

RATE, LENGTH = 3200.0, 3200


def block_means(omega, harmonics):
    """Return means over blocks, in closed form, of sum Re[c_n exp(i n omega t)]."""
    edges = np.arange(LENGTH + 1) / RATE
    whole = sum((c * np.exp(1j * n * omega * edges) / (1j * n * omega)).real for n, c in enumerate(harmonics, 1))
    return Bins(0.5 * (edges[1:] + edges[:-1]), np.diff(whole) * RATE, 1 / RATE)


@settings(max_examples=20)
@given(
    f=st.floats(7.0, 60.0),
    size=st.floats(1e-4, 1.0),
    phase=st.floats(-3.0, 3.0),
    second=st.floats(0.0, 0.05),
    third=st.floats(0.0, 0.03),
    offset=st.floats(-2.0, 2.0),
)
def test_closed_form_is_met_to_rounding(f, size, phase, second, third, offset):
    true = size * np.exp(1j * phase) * np.array([1.0, second * 1j, third])
    bins = block_means(2 * np.pi * f, true)
    fit = sine_fit(Bins(bins.t, bins.mean + offset * size, bins.width))
    assert fit.f == pytest.approx(f, rel=1e-9)
    np.testing.assert_allclose(fit.harmonics, true, atol=1e-8 * size)
    assert fit.residual < 1e-9 * size


def test_scatter_and_stated_uncertainty_are_those_of_the_cramer_rao_bound():
    """Kay, Fundamentals of Statistical Signal Processing, 3.11: N samples of A cos(omega t + phi) in white noise."""
    f, size, sigma, runs = 8.8, 2e-4, 1e-6, 200
    rng = np.random.default_rng(1057)
    clean = block_means(2 * np.pi * f, [size])
    middle = 0.5 * (clean.t[0] + clean.t[-1])
    angle = 2 * np.pi * f * middle
    found, stated = [], []
    for _ in range(runs):
        noisy = Bins(clean.t, clean.mean + sigma * rng.normal(size=LENGTH), clean.width)
        fit = sine_fit(noisy, harmonics=1, near=f)
        turned = fit.harmonics[0] * np.exp(2j * np.pi * fit.f * middle - 1j * angle)
        found.append((fit.f - f, abs(turned) - size, np.angle(turned)))
        stated.append((fit.u_f, fit.u_amplitude, fit.u_phase))
    n = LENGTH
    bound = np.array([
        np.sqrt(24 * (sigma / size) ** 2 / (n * (n**2 - 1))) * RATE / (2 * np.pi),
        np.sqrt(2 * sigma**2 / n),
        np.sqrt(2 * (sigma / size) ** 2 / n),
    ])  # fmt: skip
    # A standard deviation of 200 draws is known to 5 %; the widening for clumped residuals may add as much.
    np.testing.assert_allclose(np.std(found, axis=0) / bound, 1.0, atol=0.2)
    np.testing.assert_allclose(np.median(stated, axis=0) / bound, 1.05, atol=0.07)


def test_hum_that_is_not_fitted_widens_the_uncertainty():
    clean = block_means(2 * np.pi * 8.8, [1.0])
    rng = np.random.default_rng(3)
    white = 0.01 * rng.normal(size=LENGTH)
    wandering = np.convolve(rng.normal(size=LENGTH + 63), np.full(64, 0.01 / 8.0), "valid")
    u = [sine_fit(Bins(clean.t, clean.mean + noise, clean.width), near=8.8).u_f for noise in (white, wandering)]
    assert u[1] > 4 * u[0]


def test_what_is_no_sine_is_refused():
    clean = block_means(2 * np.pi * 1.5, [1.0])
    with pytest.raises(RigError, match="less than two periods"):
        sine_fit(clean, near=1.5)
