"""What the model does not have is measured where it is there, and not where it isn't."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from vines.rig import Recording, RunInfo, Sampled, Uncertain
from vines.rig.fit import Bins, Motion, root
from vines.rig.impacts import rung
from vines.rig.quantities._limits import Ringing, contact_time, reaction

RATE, SECONDS, OMEGA = 3200.0, 30.0, 55.0


def recording(**channels):
    one = Uncertain(1.0, 0.0)
    info = RunInfo("one", "2026-01-05T09:00:00Z", "dwell", None, None, 0.0, one, one, one, True, (20.0, 20.0))
    return Recording(
        info,
        {name: Sampled(name, name, RATE, 0.0, y, np.ones(len(y), bool)) for name, y in channels.items()},
        "none",
    )


def base(follows, role="disp"):
    """Return the run of a base with a part of the oscillator's motion, which scatters in a band."""
    rng = np.random.default_rng(4)
    t = np.arange(round(SECONDS * RATE)) / RATE
    band = butter(2, (10, 90), "bandpass", fs=RATE, output="sos")
    x1 = 8e-3 * np.sin(OMEGA * t) + 2e-5 * np.asarray(sosfilt(band, rng.normal(size=len(t))))
    e = 2e-4 * np.sin(OMEGA * t + 1) + 5e-7 * np.sin(3 * OMEGA * t) + follows * x1 + 1e-8 * rng.normal(size=len(t))
    found = SimpleNamespace(fit=SimpleNamespace(omega=OMEGA, f=OMEGA / 2 / np.pi))
    return reaction(recording(**{f"base_{role}": e, f"lo_{role}": x1}), found)


@pytest.mark.parametrize("follows", [0.01, 0.003])
def test_a_base_that_gives_way_is_measured(follows):
    found = base(follows)
    assert found.value == pytest.approx(follows, rel=0.05)
    assert found.u < 0.1 * follows


def test_a_base_that_does_not_is_not():
    found = base(0.0)
    assert found.value < 1e-3 + 3.5 * found.u
    assert found.value < 2e-3
    assert reaction(recording(lo_disp=np.zeros(100)), SimpleNamespace()) is None


def test_a_mode_that_the_base_feels_is_no_reaction():
    rng = np.random.default_rng(6)
    t = np.arange(round(SECONDS * RATE)) / RATE
    hits = np.sort(rng.uniform(0.0, SECONDS, 520))
    dv = 0.015 * rng.choice([-1.0, 1.0], len(hits))
    free, mode = (2 * np.pi * f * complex(-z, 1.0) for f, z in ((8.7, 0.006), (38.0, 0.008)))
    x1 = (rung(t, hits, dv, free)[0] / free).real
    e = 2e-4 * np.sin(OMEGA * t) + 0.3 * (rung(t, hits, dv, mode)[0] / mode).real + 1e-8 * rng.normal(size=len(t))
    found = SimpleNamespace(fit=SimpleNamespace(omega=OMEGA, f=OMEGA / 2 / np.pi))
    run = recording(base_disp=e, lo_disp=x1)

    # As it was found: a little off, and with jumps that are not quite those.
    ringing = Ringing((1.0005 * mode,), hits, 1.01 * dv)
    assert reaction(run, found).value > 0.01
    known = reaction(run, found, ringing)
    assert known.value - 3.5 * known.u < 1e-3
    gives = reaction(recording(base_disp=e + 0.004 * x1, lo_disp=x1), found, ringing)
    assert gives.value == pytest.approx(0.004, rel=0.15)


def soft(length, noise=3e-7):
    """Return a response whose displacement is that of half-sine contacts of a length."""
    s = root(OMEGA, 0.012)
    t = np.arange(0.0, SECONDS, 1 / RATE) + 0.5 / RATE
    hits = np.arange(0.05, SECONDS - 0.05, 0.0571)
    dv = 0.015 * np.where(np.arange(len(hits)) % 2, 1.0, -1.0)
    z = np.zeros(len(hits) + 1, complex)
    for k, at in enumerate(hits):
        before = z[k] * np.exp(s * (at - (hits[k - 1] if k else 0.0)))
        z[k + 1] = before + dv[k] / (1j * s.imag)
    motion = Motion(s, OMEGA, np.array([6e-3 + 0j]), np.concatenate([[0.0], hits]), z, SECONDS)
    x1 = motion.at(t)
    for at, size in zip(hits, dv, strict=True):
        # Twice the integral of a half-sine of area 1, less the corner.
        near = slice(*np.searchsorted(t, (at - length, at + length)))
        u = np.clip((t[near] - at) / length, -0.5, 0.5)
        x1[near] += size * length * (0.5 * u + 0.25 - np.cos(np.pi * u) / (2 * np.pi) - np.maximum(u, 0.0))
    x1 += noise * np.random.default_rng(2).normal(size=len(t))
    fit = SimpleNamespace(motion=motion, jumps=SimpleNamespace(dv=dv), offset=0.0)
    return SimpleNamespace(fit=fit, bins=Bins(t, x1, 1 / RATE), order=0, pushed=None)


@pytest.mark.parametrize("length", [1.0e-3, 1.7e-3])
def test_a_soft_contact_is_measured(length):
    found = contact_time(recording(), soft(length))
    assert found.value == pytest.approx(length, rel=0.08)
    assert found.u < 0.1 * length


def test_a_hard_contact_is_none():
    found = contact_time(recording(), soft(1e-4))
    assert found.value - 3.5 * found.u < 6e-4
    assert found.value < 6e-4
