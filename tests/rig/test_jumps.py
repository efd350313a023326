"""Velocity jumps by least squares against a motion in closed form."""

import numpy as np
import pytest

from vines.rig import Sampled
from vines.rig._bins import bins_of
from vines.rig._jumps import fit_jumps
from vines.rig._motion import Motion

OMEGA0, LAM, DV, IMPACTS = 55.39, 0.012, 0.0165, 300
S = OMEGA0 * complex(-LAM / 2, np.sqrt(1 - LAM**2 / 4))


@pytest.fixture(scope="module")
def train():
    """Return a motion at resonance with equal jumps to either side twice a period: what is nearest to a forced one."""
    half = np.pi / OMEGA0
    t = 0.4 * half + half * np.arange(IMPACTS)
    dv = DV * np.where(np.arange(IMPACTS) % 2, 1.0, -1.0)
    z = np.zeros(IMPACTS + 1, complex)
    starts = np.concatenate([[0.0], t])
    for j in range(IMPACTS):
        z[j + 1] = z[j] * np.exp(S * (starts[j + 1] - starts[j])) - 1j * dv[j] / S.imag
    return Motion(S, OMEGA0, np.array([0.02 * np.exp(0.3j)]), starts, z, float(t[-1] + half)), dv


@pytest.mark.parametrize("noise", [0.0, 2e-7])
def test_equal_jumps_keep_their_size_beside_a_forced_response(train, noise):
    # Conditions that are to keep the equations solvable must not pull on the free motion: 1e-9 of it cost .5 %.
    motion, dv = train
    t = (np.arange(int(motion.stop * 3200)) + 0.5) / 3200
    signal = motion.at(t) + noise * np.random.default_rng(1).normal(size=len(t))
    bins = bins_of(Sampled("laser", "lo_disp", 3200.0, 0.5 / 3200, signal, np.ones(len(t), bool)))
    fit = fit_jumps(bins, S, OMEGA0, motion.starts[1:], 6e-6, dv)
    ratio = fit.jumps.dv / dv
    u = float((fit.draws.dv / dv).mean(axis=1).std())
    assert abs(ratio.mean() - 1) < 5e-5 + 3 * u
    assert u < 1e-3
