"""Cheap runs of a rig, made at the level of impacts: closed form between impacts, sensors at a few kilohertz.

The oscillator answers to the base and its harmonics and to the ball's friction; the ball is slowed by friction and
pulled by a tilt; a contact lasts, so that the ball turns beyond where it touches; restitution falls with speed and
scatters. Every error that a reconstruction allows for is drawn, of the size that is stated or allowed:

| error | drawn | reaches |
|---|---|---|
| sensor of the oscillator | gain .2 %; delay 2 us; noise .25 to 2.5 um a sample; linearity .02 to .1 % of the \
range, by a wave over the range in any phase | b, w', max|x1|, mu by momentum, tilt, exponent of r |
| sensor of the base | gain .2 %, alignment 2 us, noise 30 nm | E, A, phase, impact phase |
| clock | runs off by 2 us over the record | f, phase |
| temperature | ring-downs up to 2 K apart, each read to .1 K, as is the run; omega0 falls by .015 +- .005 % \
a kelvin | omega0, Omega |
| damping | 1e-4 | lam |
| scales, gauge | masses 5e-4, b 50 um | mu, b, A |
| contact | centroid of its force 55 +- 16 us after the touch, longer for soft impacts | b, r |
| friction, tilt | friction stated to 15 %, tilt to .01 m/s^2 | friction, tilt, r |
| base | second harmonic .2 to 3 %, third .1 to 1 % | forced response |
| impacts | times 6 us, sizes of the pulses 3 % | all |
| the motion itself | 60 s of one that scatters and wanders | r, sigma_r, w', K2/K1, max|x1|, impacts and their phase |
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from vines.rig import Recording, RingDown, RunInfo, Sampled, Uncertain
from vines.rig.fit import Motion

Floats = npt.NDArray[np.float64]
Impacts = tuple[Floats, Floats]
"""Times [s] and velocity jumps of the oscillator [m/s]."""

RATE, STEPS = 3200.0, 250
"""Samples a second; steps a forcing period between which contacts are looked for."""

LENGTH = 60.0
"""Of a record [s], as of a real dwell."""

T, SIDE, X1, V1, V1_AFTER, V2, V2_AFTER, GAP = range(8)
"""Columns of impacts; GAP is |x1 - x2| at the impact."""


@dataclass(frozen=True, eq=False)
class Rig:
    """A rig with its true numbers, SI.

    Attributes
    ----------
    s : complex
        Of the free oscillation [1/s].
    omega : float
        Of the forcing [rad/s].
    e, c : ndarray of complex, shape (3,)
        Harmonics of the base and of the forced response [m], e(t) = Re sum e_n exp(i n omega t).
    true : dict
        omega0, lam, Omega, E, phi, mu, b_hard, r, sigma_r, exponent, speed, friction, tilt, contact (delay of a
        contact's force after the touch at `speed` [s]).
    """

    s: complex
    omega: float
    e: npt.NDArray[np.complex128]
    c: npt.NDArray[np.complex128]
    true: dict[str, float]


def draw(rng: np.random.Generator) -> Rig:
    """Draw a rig over the ranges of real ones (Table 1 of the paper, 1:1 and what lies near it)."""

    def even(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    def log(low: float, high: float) -> float:
        return math.exp(even(math.log(low), math.log(high)))

    b = 0.015 + 1e-4 * even(-1, 1)
    true = {
        "omega0": 55.39, "lam": 0.012, "Omega": even(0.99, 1.01), "E": 0.015 * even(0.012, 0.022),
        "phi": even(0, 2 * np.pi),
        "mu": log(0.006, 0.02), "b_hard": b, "r": even(0.55, 0.75), "sigma_r": log(0.005, 0.04),
        "exponent": even(0.0, 0.2), "speed": 0.9, "friction": 9.80665 * log(0.001, 0.01), "tilt": 0.01 * rng.normal(),
        "contact": max(5.5e-5 + 1.6e-5 * rng.normal(), 1e-5),
    }  # fmt: skip
    omega0, lam = true["omega0"], true["lam"]
    omega = true["Omega"] * omega0
    s = omega0 * complex(-0.5 * lam, math.sqrt(1.0 - 0.25 * lam * lam))
    n = np.arange(1, 4)
    size: Floats = true["E"] * np.array([1.0, log(0.002, 0.03), log(0.001, 0.01)])
    turn = n * true["phi"] + np.array([-0.5 * np.pi, even(0, 2 * np.pi), even(0, 2 * np.pi)])
    e = (size * np.exp(1j * turn)).astype(np.complex128)
    drive = 1j * lam * omega0 * n * omega
    return Rig(s, omega, e, e * (omega0**2 + drive) / (omega0**2 - (n * omega) ** 2 + drive), true)


@dataclass(frozen=True, eq=False)
class Run:
    """Motion of a rig.

    Attributes
    ----------
    rows : ndarray, shape (K, 8)
        Impacts, columns T … GAP.
    motion : Motion
        Of the oscillator, in parts between impacts and turns of the friction, without `rest`.
    rest : ndarray, shape (P,)
        Where friction holds the oscillator in each part [m].
    """

    rows: Floats
    motion: Motion
    rest: Floats

    def position(self, t: Floats) -> Floats:
        """Return x1 [m]."""
        part = np.maximum(np.searchsorted(self.motion.starts, t, side="right") - 1, 0)
        return self.motion.at(t) + self.rest[part]


def run_of(rig: Rig, periods: int, rng: np.random.Generator) -> Run:
    """Return a run from rest."""
    p = rig.true
    rows, parts = _simulate(
        rig.s, rig.omega, rig.c, p["mu"], p["b_hard"], p["r"], p["sigma_r"], p["exponent"], p["speed"], p["contact"],
        p["friction"], p["tilt"], periods, rng.normal(size=60_000),
    )  # fmt: skip
    stop = float(rows[-1, T]) if len(rows) else 0.0
    z = parts[:, 1] + 1j * parts[:, 2]
    return Run(rows, Motion(rig.s, rig.omega, rig.c, parts[:, 0].copy(), z, stop), parts[:, 3].copy())


@numba.njit(cache=False)
def _state(s, omega, c, z, t0, rest, t):
    """Return x1 and v1."""
    x, v = rest, 0.0
    turn = np.exp(1j * omega * t)
    power = 1.0 + 0.0j
    for n in range(len(c)):
        power *= turn
        f = c[n] * power
        x += f.real
        v += (1j * (n + 1) * omega * f).real
    g = z * np.exp(s * (t - t0))
    return x + g.real, v + (s * g).real


@numba.njit(cache=False)
def _free(s, omega, c, rest, t, x1, v1):
    """Return the free part z of a flight that starts at t with x1 and v1."""
    x, v = _state(s, omega, c, 0.0j, t, rest, t)
    px, pv = x1 - x, v1 - v
    return complex(px, -(pv - s.real * px) / s.imag)


@numba.njit(cache=False)
def _simulate(s, omega, c, mu, b, r, sigma, exponent, speed, contact, friction, tilt, periods, draws):
    rows, parts = np.empty((12 * periods + 100, 8)), np.empty((40 * periods + 100, 4))
    count, pieces = 0, 0
    h = 2.0 * math.pi / omega / STEPS
    push = mu * friction / abs(s) ** 2
    t, t0, z, rest = 0.0, 0.0, 0.0j, 0.0
    x2, v2 = 0.0, 0.08
    x1, v1 = _state(s, omega, c, z, t0, rest, t)
    z = _free(s, omega, c, rest, 0.0, 0.0, 0.0)
    x1, v1 = 0.0, 0.0
    beyond = False
    for _ in range(periods * STEPS):
        left, events = h, 0
        while left > 0.0:
            way = 1.0 if v2 > v1 else -1.0
            if rest != way * push:
                # Friction has turned: it holds the oscillator at another place.
                rest, t0 = way * push, t
                z = _free(s, omega, c, rest, t, x1, v1)
                parts[pieces] = (t, z.real, z.imag, rest)
                pieces += 1
            a = tilt - friction * way
            end, ball, fast = left, x2 + v2 * left + 0.5 * a * left * left, v2 + a * left
            new1, newv = _state(s, omega, c, z, t0, rest, t + left)
            touch = abs(new1 - ball) >= b
            if beyond and not touch:
                beyond = False
            if not touch or (beyond and (newv - fast) * (new1 - ball) < 0.0):
                x1, v1, x2, v2, t, left = new1, newv, ball, fast, t + left, 0.0
                continue
            if not beyond:
                low, high = 0.0, left
                for _ in range(50):
                    mid = 0.5 * (low + high)
                    new1, newv = _state(s, omega, c, z, t0, rest, t + mid)
                    if abs(new1 - (x2 + v2 * mid + 0.5 * a * mid * mid)) < b:
                        low = mid
                    else:
                        high = mid
                w = newv - (v2 + a * high)
                # Straight lines before and after the contact meet so much later; softer contacts last longer.
                end = high + contact * (max(abs(w), 1e-3) / speed) ** -0.2
            x1, v1 = _state(s, omega, c, z, t0, rest, t + end)
            x2, v2 = x2 + v2 * end + 0.5 * a * end * end, v2 + a * end
            t, left, beyond = t + end, left - end, True
            side = 1.0 if x1 > x2 else -1.0
            w = v1 - v2
            events += 1
            if w * side <= 0.0 or events > 20:
                continue
            e = min(max(r * (abs(w) / speed) ** (-exponent) + sigma * draws[count % len(draws)], 0.0), 0.99)
            after1, after2 = v1 - mu * (1.0 + e) * w / (1.0 + mu), v2 + (1.0 + e) * w / (1.0 + mu)
            if count < len(rows):
                rows[count] = (t, side, x1, v1, after1, v2, after2, abs(x1 - x2))
                count += 1
            t0, v1, v2 = t, after1, after2
            z = _free(s, omega, c, rest, t, x1, v1)
            parts[pieces] = (t, z.real, z.imag, rest)
            pieces += 1
    return rows[:count], parts[:pieces]


def recorded(rig: Rig, run: Run, begin: float, rng: np.random.Generator) -> tuple[Recording, list[RingDown], Impacts]:
    """Return what sensors, scales and ring-downs say of a stretch of a run, and what is heard of its impacts.

    Every stated uncertainty is that of the error drawn here; its size is that of a good laboratory.
    """
    p = rig.true
    t = (np.arange(round(LENGTH * RATE), dtype=np.float64) + 0.5) / RATE
    noise = 10 ** rng.uniform(-6.6, -5.6)
    late, base_late, wander = 2e-6 * rng.normal(size=3)
    # The recorder's clock runs off over the record by as much as alignment is uncertain.
    elapsed = begin + t + wander * (t / LENGTH - 0.5)
    # Samples are means over blocks of a faster record: by Gauss's rule of two points.
    half = 1 / RATE / math.sqrt(12.0)
    base = 0.5 * sum(_harmonic(rig.e, rig.omega, elapsed + base_late + shift) for shift in (-half, half))
    base = base * (1 + 2e-3 * rng.normal()) + 3e-8 * rng.normal(size=len(t))
    x1 = 0.5 * sum(run.position(elapsed + late + shift) for shift in (-half, half))
    gain = 1 + 2e-3 * rng.normal()
    span = next(each for each in (0.005, 0.01, 0.02, 0.05, 0.1) if np.abs(x1).max() < 0.9 * each)
    # Linearity of .02 to .1 % of the range, by a law that no fit knows: a wave over the range, in any phase.
    wave = 0.5 * span * rng.uniform(2e-4, 1e-3) * np.sin(2 * np.pi * x1 / span + rng.uniform(0, 2 * np.pi))
    body = gain * (x1 + wave) + noise * rng.normal(size=len(t))
    masses = [
        Uncertain(v * (1 + 5e-4 * e), 5e-4 * v) for v, e in ((3.807, rng.normal()), (3.807 * p["mu"], rng.normal()))
    ]
    more = {
        "friction": {"value": p["friction"] * (1 + 0.15 * rng.normal()), "u": 0.15 * p["friction"]},
        "tilt": {"value": 0.0, "u": 0.01},
    }
    now, free = _ring_downs(p, rng)
    info = RunInfo(
        f"cheap_{rng.integers(1 << 30)}", "2026-01-05T09:00:00Z", "dwell", rig.omega / 2 / np.pi, p["E"], 60.0,
        masses[0], masses[1], Uncertain(p["b_hard"] + 5e-5 * rng.normal(), 5e-5), True, (now, now),
        ("before", "after"), more,
    )  # fmt: skip
    good, start = np.ones(len(t), bool), 0.5 / RATE
    channels = {
        "base": Sampled("base", "base_disp", RATE, start, base, good, 2e-3, 2e-6),
        "body": Sampled("body", "lo_disp", RATE, start, body, good, 2e-3, 2e-6),
    }
    own = run.rows[(run.rows[:, T] > begin) & (run.rows[:, T] < begin + LENGTH)]
    times = own[:, T] - begin
    times = times - wander * (times / LENGTH - 0.5) - late + 6e-6 * rng.normal(size=len(own))
    jumps = (own[:, V1_AFTER] - own[:, V1]) * (1 + 0.03 * rng.normal(size=len(own)))
    return Recording(info, channels, "none"), free, (times, jumps)


def _ring_downs(p: dict[str, float], rng: np.random.Generator) -> tuple[float, list[RingDown]]:
    """Return the temperature that was read in the run, and ring-downs before and after it, up to 2 K apart.

    The springs' temperature is read to .1 K, stiffness falls by .015 +- .005 % a kelvin, damping is known to 1e-4.
    """
    drift = -1.5e-4 + 0.5e-4 * rng.normal()
    warming = rng.uniform(-2.0, 2.0)
    place = rng.uniform(0.0, 1.0)
    lam = p["lam"] * (1 + 1e-4 * rng.normal())
    read = 20.0 + 0.1 * rng.normal(size=3)
    free = [
        RingDown(
            name, Uncertain(p["omega0"] * (1 + drift * away), 1e-5 * p["omega0"]), Uncertain(lam, 1e-7),
            float(reading + away), 0.0,
        )
        for name, away, reading in (
            ("before", -place * warming, read[0]), ("after", (1 - place) * warming, read[1]),
        )
    ]  # fmt: skip
    return float(read[2]), free


def _harmonic(c: npt.NDArray[np.complex128], omega: float, t: Floats) -> Floats:
    turn = np.exp(1j * omega * t)
    total = np.zeros(len(t), complex)
    for value in c[::-1]:
        total += value
        total *= turn
    return np.real(total)
