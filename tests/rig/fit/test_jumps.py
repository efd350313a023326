"""Velocity jumps from a motion that scipy integrated, and from one in closed form: sizes, times, uncertainties."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vines.errors import RigError
from vines.rig import Sampled
from vines.rig.fit import JumpModel, Train
from vines.rig.fit._bins import Bins, bins_of
from vines.rig.fit._motion import Motion

OMEGA0, LAM, OMEGA, E = 55.4, 0.012, 55.0, 2.2e-4
ROOT = OMEGA0 * complex(-LAM / 2, np.sqrt(1 - LAM**2 / 4))
WIDTH = 1 / 3200
DV, COUNT = 0.0165, 300


def motion(y, t):
    """Return the rate of x1, v1 and of the integral of x1: oscillator on a base that moves by E sin(omega t)."""
    e, de = E * np.sin(OMEGA * t), E * OMEGA * np.cos(OMEGA * t)
    return [y[1], -LAM * OMEGA0 * (y[1] - de) - OMEGA0**2 * (y[0] - e), y[0]]


@pytest.fixture(scope="module")
def integrated():
    """Return impacts of a motion of 6 s, and means over blocks of its x1 and of its acceleration."""
    rng = np.random.default_rng(12)
    times = np.cumsum(rng.uniform(0.03, 0.09, 90))
    sizes = np.where(np.arange(90) % 2, 1.0, -1.0) * rng.uniform(2e-3, 1.2e-2, 90)
    edges = np.arange(round((times[-1] + 0.05) / WIDTH)) * WIDTH
    state, begin = np.array([6e-3, 0.1, 0.0]), 0.0
    v, whole, before = np.empty(len(edges)), np.empty(len(edges)), []
    for until, size in zip([*times, edges[-1] + WIDTH], [*sizes, 0.0], strict=True):
        here = (edges >= begin) & (edges < until)
        done = solve_ivp(
            lambda t, y: motion(y, t), (begin, until), state, "DOP853", [*edges[here], until], rtol=1e-11, atol=1e-15
        )
        v[here], whole[here] = done.y[1, :-1], done.y[2, :-1]
        state = done.y[:, -1]
        before.append(state[:2].copy())
        state[1] += size
        begin = until
    middle = 0.5 * (edges[1:] + edges[:-1])
    signals = {0: Bins(middle, np.diff(whole) / WIDTH, WIDTH), 2: Bins(middle, np.diff(v) / WIDTH, WIDTH)}
    return times, sizes, np.array(before[:-1]), signals


def test_displacement_gives_jumps_and_moves_times_that_are_20_us_off(integrated):
    times, sizes, before, signals = integrated
    given = times + np.random.default_rng(1).uniform(-2e-5, 2e-5, len(times))
    fit = JumpModel(signals[0], ROOT, OMEGA).fit(Train.alike(given, sizes, 3e-5), draws=0)
    np.testing.assert_allclose(fit.jumps.t, times, rtol=0, atol=1e-7)
    np.testing.assert_allclose(fit.jumps.dv, sizes, rtol=0, atol=3e-7)
    np.testing.assert_allclose(fit.jumps.x, before[:, 0], rtol=0, atol=5e-8)
    np.testing.assert_allclose(fit.jumps.v_before, before[:, 1], rtol=0, atol=5e-6)
    # Forced response of the base alone, by hand.
    damp = 1j * LAM * OMEGA / OMEGA0
    forced = -1j * E * (1 + damp) / (1 - (OMEGA / OMEGA0) ** 2 + damp)
    assert abs(fit.motion.c[0] - forced) < 1e-6 * abs(forced)
    assert np.abs(fit.motion.c[1:]).max() < 1e-6 * abs(forced)
    assert fit.fair.all()


def test_acceleration_gives_the_same_jumps_where_times_are_known(integrated):
    times, sizes, _, signals = integrated
    fit = JumpModel(signals[2], ROOT, OMEGA, 2).fit(Train.alike(times, sizes, 1e-7), draws=0)
    np.testing.assert_allclose(fit.jumps.dv, sizes, rtol=0, atol=3e-7)


def test_stated_uncertainties_are_those_of_the_noise(integrated):
    times, sizes, _, signals = integrated
    rng = np.random.default_rng(2)
    noisy = Bins(signals[0].t, signals[0].mean + 1e-6 * rng.normal(size=len(signals[0].t)), WIDTH)
    given = Train.alike(times + 1e-5 * rng.normal(size=len(times)), sizes, 1e-5)
    fit = JumpModel(noisy, ROOT, OMEGA).fit(given, draws=200)
    assert fit.residual == pytest.approx(1e-6, rel=0.05)
    assert fit.noise == pytest.approx(1e-6, rel=0.05)
    assert np.sqrt(np.mean(((fit.jumps.dv - sizes) / fit.u_dv) ** 2)) == pytest.approx(1.0, abs=0.3)
    u_t = fit.draws.t.std(axis=0)
    assert np.sqrt(np.mean(((fit.jumps.t - times) / u_t) ** 2)) == pytest.approx(1.0, abs=0.3)


def test_draws_are_those_of_the_seed(integrated):
    times, sizes, _, signals = integrated
    train = Train.alike(times, sizes, 1e-5)
    one, again, other = (JumpModel(signals[0], ROOT, OMEGA, seed=seed).fit(train, draws=4) for seed in (0, 0, 1))
    np.testing.assert_array_equal(one.draws.dv, again.draws.dv)
    assert np.all(one.draws.dv != other.draws.dv)
    np.testing.assert_array_equal(one.jumps.dv, other.jumps.dv)


def test_a_missing_impact_spoils_its_neighbours_only(integrated):
    times, sizes, _, signals = integrated
    keep = ~np.isin(np.arange(len(times)), [20, 55])
    noisy = Bins(signals[0].t, signals[0].mean + 1e-6 * np.random.default_rng(3).normal(size=len(signals[0].t)), WIDTH)
    fit = JumpModel(noisy, ROOT, OMEGA).fit(Train.alike(times[keep], sizes[keep], 1e-5), draws=0)
    assert 2 <= np.count_nonzero(~fit.fair) <= 6
    assert fit.residual == pytest.approx(1e-6, rel=0.05)
    away = np.abs(np.subtract.outer(times[keep], times[~keep])).min(axis=1) > 0.2
    np.testing.assert_allclose(fit.jumps.dv[away], sizes[keep][away], rtol=0, atol=5e-5)


def test_what_cannot_be_fitted_is_refused(integrated):
    times, sizes, _, signals = integrated
    model = JumpModel(signals[0], ROOT, OMEGA)
    train = Train.alike(times, sizes, 1e-6)
    for bad in (train.merged(train.only(np.array([3]))), train.later(-1.0)):
        with pytest.raises(RigError, match="at times of their own, inside the record"):
            model.fit(bad)
    many = np.linspace(0.01, times[-1], 4000)
    with pytest.raises(RigError, match="4000 impacts leave only"):
        model.fit(Train.alike(many, np.ones(4000), 1e-6))


@pytest.fixture(scope="module")
def train():
    """Return a motion at resonance with equal jumps to either side twice a period: what is nearest to a forced one."""
    half = np.pi / OMEGA0
    t = 0.4 * half + half * np.arange(COUNT)
    dv = DV * np.where(np.arange(COUNT) % 2, 1.0, -1.0)
    z = np.zeros(COUNT + 1, complex)
    starts = np.concatenate([[0.0], t])
    for j in range(COUNT):
        z[j + 1] = z[j] * np.exp(ROOT * (starts[j + 1] - starts[j])) - 1j * dv[j] / ROOT.imag
    return Motion(ROOT, OMEGA0, np.array([0.02 * np.exp(0.3j)]), starts, z, float(t[-1] + half)), dv


@pytest.mark.parametrize("noise", [0.0, 2e-7])
def test_equal_jumps_keep_their_size_beside_a_forced_response(train, noise):
    # Conditions that are to keep the equations solvable must not pull on the free motion: 1e-9 of it cost .5 %.
    motion, dv = train
    t = (np.arange(int(motion.stop * 3200)) + 0.5) / 3200
    signal = motion.at(t) + noise * np.random.default_rng(1).normal(size=len(t))
    bins = bins_of(Sampled("laser", "lo_disp", 3200.0, 0.5 / 3200, signal, np.ones(len(t), bool)))
    fit = JumpModel(bins, ROOT, OMEGA0).fit(Train.alike(motion.starts[1:], dv, 6e-6))
    ratio = fit.jumps.dv / dv
    u = float((fit.draws.dv / dv).mean(axis=1).std())
    assert abs(ratio.mean() - 1) < 5e-5 + 3 * u
    assert u < 1e-3
