"""Do 95 % intervals cover? Many cheap runs made at the level of impacts, each beside a far longer run of the same rig.

A small simulation of its own (friction and tilt of the ball, restitution that scatters and falls with speed)
gives impacts and motion; the recording is what sensors would make of them at 3200 samples a second, and the impacts are
given with errors of their times, so that nothing is detected. Run with
``python -m benchmarks.rig_coverage --seeds 0 500 --jobs 2``.
"""

from __future__ import annotations

import argparse
import math
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from vines.errors import VinesError
from vines.rig import Recording, RingDown, RunInfo, Sampled, Uncertain, reconstruct
from vines.rig._cycle import slots
from vines.rig._motion import Motion
from vines.rig._pattern import cut_into_periods

Floats = npt.NDArray[np.float64]

RATE, STEPS = 3200.0, 400
SETTLE, LONG = 150, 6000
"""Forcing periods: before the record, and of the long run that stands for the truth."""


@numba.njit(cache=False)
def simulate(omega0, lam, omega, E, phi, mu, b, r, sigma, exponent, speed, friction, tilt, periods, draws):
    """Return impacts as rows t, side, x1, v1, v1 after, v2, v2 after."""
    s = omega0 * complex(-0.5 * lam, math.sqrt(1.0 - 0.25 * lam * lam))
    drive = complex(omega0 * omega0, lam * omega0 * omega)
    c = -1j * E * np.exp(1j * phi) * drive / complex(omega0 * omega0 - omega * omega, lam * omega0 * omega)
    rows = np.empty((int(12 * periods) + 100, 7))
    count = 0
    h = 2.0 * math.pi / omega / STEPS
    t0, z = 0.0, complex(0.0, 0.0)
    t, x2, v2 = 0.0, 0.0, 0.08
    side, x1, v1 = 1.0, 0.0, 0.0
    for _ in range(int(periods * STEPS)):
        left, events = h, 0
        while left > 0.0:
            events += 1
            if events > 40:
                # The ball sticks: it is let go beside the wall, to be caught again as long as the wall pushes it.
                x2, v2, t, left = x1 - side * b * (1.0 - 1e-4), v1, t + left, 0.0
                continue
            f = c * np.exp(1j * omega * t)
            g = z * np.exp(s * (t - t0))
            v1 = (1j * omega * f + s * g).real
            a = tilt - friction * (1.0 if v2 > v1 else -1.0)
            new = t + left
            x1 = (c * np.exp(1j * omega * new) + z * np.exp(s * (new - t0))).real
            ball = x2 + v2 * left + 0.5 * a * left * left
            if abs(x1 - ball) < b:
                x2, v2, t, left = ball, v2 + a * left, new, 0.0
                continue
            low, high = 0.0, left
            for _ in range(60):
                mid = 0.5 * (low + high)
                x1 = (c * np.exp(1j * omega * (t + mid)) + z * np.exp(s * (t + mid - t0))).real
                if abs(x1 - (x2 + v2 * mid + 0.5 * a * mid * mid)) < b:
                    low = mid
                else:
                    high = mid
            # Just inside, so that the ball is never found beyond the wall again.
            x2, v2 = x2 + v2 * low + 0.5 * a * low * low, v2 + a * low
            t, left = t + low, left - high
            f = c * np.exp(1j * omega * t)
            g = z * np.exp(s * (t - t0))
            x1, v1 = (f + g).real, (1j * omega * f + s * g).real
            w = v1 - v2
            side = 1.0 if x1 > x2 else -1.0
            if w * side <= 0.0:
                t += 1e-12
                continue
            e = r * (abs(w) / speed) ** (-exponent) + sigma * draws[count % len(draws)]
            e = min(max(e, 0.0), 0.99)
            after1 = v1 - mu * (1.0 + e) * w / (1.0 + mu)
            after2 = v2 + (1.0 + e) * w / (1.0 + mu)
            if count < len(rows):
                rows[count] = (t, side, x1, v1, after1, v2, after2)
                count += 1
            # z at the new start, from x1 and the new velocity less the forced part
            px, pv = x1 - f.real, after1 - (1j * omega * f).real
            z = complex(px, -(pv - s.real * px) / s.imag)
            t0, v2 = t, after2
    return rows[:count], s, c


def one(seed: int) -> dict[str, float] | str:
    """Return (estimate - truth)/u of each quantity of a run, or why there is none."""
    rng = np.random.default_rng([seed, 99])

    def even(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    true: dict[str, Any] = {
        "omega0": 55.39 * (1 + 1e-5 * rng.normal()), "lam": 0.012, "Omega": even(0.99, 1.01), "A": even(0.012, 0.022),
        "mu": math.exp(even(math.log(0.006), math.log(0.02))), "b": 0.015, "r": even(0.55, 0.75),
        "sigma_r": math.exp(even(math.log(0.005), math.log(0.04))), "exponent": even(0.0, 0.15),
        "friction": 9.80665 * math.exp(even(math.log(0.001), math.log(0.01))), "tilt": 0.01 * rng.normal(),
    }  # fmt: skip
    omega, E, phi = true["Omega"] * true["omega0"], true["A"] * true["b"], even(0, 2 * np.pi)
    rows, s, c = simulate(
        true["omega0"], true["lam"], omega, E, phi, true["mu"], true["b"], true["r"], true["sigma_r"],
        true["exponent"], 0.9, true["friction"], true["tilt"], float(LONG), rng.normal(size=50_000),
    )  # fmt: skip
    period = 2 * np.pi / omega
    begin, length = SETTLE * period, 30.0
    own = rows[(rows[:, 0] > begin) & (rows[:, 0] < begin + length)]
    if len(own) < 60:
        return "no impacts"
    if np.mean(np.diff(rows[rows[:, 0] > begin, 0]) < 2e-3) > 1e-3:
        return "chatter, of which no mean is taken"
    recording, free, impacts = recorded(rng, true, own, rows, s, c, omega, E, phi, begin, length)
    try:
        found = reconstruct(recording, [free], impacts=impacts)
    except VinesError as error:
        return str(error)
    if not found.accepted:
        return "not accepted: " + found.reasons
    truth = population(rows[rows[:, 0] > begin], true, s, c, omega, phi, E, found)
    ratios = {}
    for name, value in truth.items():
        got = found.quantities.get(name)
        if got is not None and got.u > 0:
            gap = got.value - value
            ratios[name] = (float(np.angle(np.exp(1j * gap))) if "phase" in name else gap) / got.u
    return ratios


def recorded(
    rng: np.random.Generator, true: dict[str, Any], own: Floats, rows: Floats, s: complex, c: complex, omega: float,
    E: float, phi: float, begin: float, length: float,
) -> tuple[Recording, RingDown, tuple[Floats, Floats]]:  # fmt: skip
    """Return what sensors and scales say: every stated uncertainty is that of the error drawn here."""
    t = begin + (np.arange(round(length * RATE), dtype=np.float64) + 0.5) / RATE
    x1 = motion_of(rows, s, c, omega).at(t)
    gain, base_gain, late = 1 + 0.002 * rng.normal(), 1 + 0.002 * rng.normal(), 2e-6 * rng.normal()
    noise = 10 ** rng.uniform(-6.6, -5.8)
    weighed = [
        Uncertain(v * (1 + 5e-4 * e), 5e-4 * v) for v, e in ((3.807, rng.normal()), (3.807 * true["mu"], rng.normal()))
    ]
    # The gauge does not know how far a contact gives way, which reconstruct adds with an uncertainty of 16 us.
    soft = float(np.median(np.abs(own[:, 3] - own[:, 5]))) * (5.5e-5 + 1.6e-5 * rng.normal())
    gauged = Uncertain(true["b"] + 5e-5 * rng.normal() - soft, 5e-5)
    rubbed = true["friction"]
    more = {
        "friction": {"value": rubbed * (1 + 0.15 * rng.normal()), "u": 0.15 * rubbed},
        "tilt": {"value": 0.0, "u": 0.01},
    }
    run = RunInfo(
        f"cheap_{rng.integers(1 << 30)}", "2026-01-05T09:00:00Z", "dwell", omega / 2 / np.pi, E, 60.0, weighed[0],
        weighed[1], gauged, True, (20.0, 20.0), ("free",), more,
    )  # fmt: skip
    start = 0.5 / RATE
    base = E * base_gain * np.sin(omega * (t + late) + phi) + 3e-8 * rng.normal(size=len(t))
    good = np.ones(len(t), bool)
    channels = {
        "base": Sampled("base", "base_disp", RATE, start, base, good, 0.002, 2e-6),
        "body": Sampled("body", "lo_disp", RATE, start, gain * x1 + noise * rng.normal(size=len(t)), good, 0.002, 1e-7),
    }
    free = RingDown("free", Uncertain(55.39, 1e-7), Uncertain(true["lam"] * (1 + 1e-4 * rng.normal()), 1e-7), 20.0, 0.0)
    times = own[:, 0] - begin + 3e-6 * rng.normal(size=len(own))
    return Recording(run, channels, "none"), free, (times, gain * (own[:, 4] - own[:, 3]))


def motion_of(rows: Floats, s: complex, c: complex, omega: float) -> Motion:
    """Return the oscillator's motion between the first and the last of some impacts."""
    t = rows[:, 0]
    f = c * np.exp(1j * omega * t)
    px, pv = rows[:, 2] - f.real, rows[:, 4] - (1j * omega * f).real
    return Motion(s, omega, np.array([c]), t, px - 1j * (pv - s.real * px) / s.imag, float(t[-1]))


def population(
    rows: Floats, true: dict[str, Any], s: complex, c: complex, omega: float, phi: float, E: float, found: Any
) -> dict[str, float]:  # fmt: skip
    """Return what a far longer record of the same rig shows."""
    w, after = rows[:, 3] - rows[:, 5], rows[:, 4] - rows[:, 6]
    r = -after / w
    motion = motion_of(rows, s, c, omega)
    times, values = motion.peaks()
    number = np.floor((times - times[0]) * omega / (2 * np.pi)).astype(int)
    top = np.zeros(number[-1] + 1)
    np.maximum.at(top, number, values)
    time = np.diff(rows[:, 0])
    v2 = 0.5 * (rows[:-1, 6] + rows[1:, 5])
    square = float(np.sum((v2**2 + (true["friction"] * time) ** 2 / 12) * time) / np.sum(time))
    v1 = float(motion.mean_square_velocity(rows[[0, -1], 0])[0])
    values_of = {
        "f": omega / 2 / np.pi, "E": E, "omega0": true["omega0"], "lam": true["lam"], "Omega": true["Omega"],
        "A": true["A"], "mu": true["mu"], "mu_momentum": true["mu"], "b": true["b"], "friction": true["friction"],
        "tilt": true["tilt"], "r": float(r.mean()), "sigma_r": true["sigma_r"], "r_exponent": -true["exponent"],
        "max_abs_x1": float(top[1:-1].mean()) / true["b"], "kinetic_ratio": true["mu"] * square / v1,
        "w_before": float(np.abs(w).mean()), "w_after": float(np.abs(after).mean()),
        "impacts_per_period": len(rows) / ((rows[-1, 0] - rows[0, 0]) * omega / (2 * np.pi)),
    }  # fmt: skip
    phase = omega * rows[:, 0] + phi
    periods = cut_into_periods(phase, rows[:, 1], (phase[0], phase[-1]), cut=found.periods.cut)
    places = slots(periods, found.pattern, phase, rows[:, 1])
    if places is not None:
        values_of["impact_phase"] = float(np.angle(np.exp(1j * places.phase[:, 0]).mean()) + found.periods.cut)
    return values_of


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("--seeds", nargs=2, type=int, default=(0, 500), metavar=("FROM", "COUNT"))
    ask.add_argument("--jobs", type=int, default=2)
    given = ask.parse_args()
    first, count = given.seeds
    with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
        results = list(pool.map(one, range(first, first + count), chunksize=5))
    told = [one for one in results if isinstance(one, dict)]
    print(f"{count} cheap runs, {len(told)} accepted")
    reasons: dict[str, int] = {}
    for text in results:
        if isinstance(text, str):
            reasons[text.split(",")[0][:60]] = reasons.get(text.split(",")[0][:60], 0) + 1
    for text, n in sorted(reasons.items(), key=lambda item: -item[1])[:6]:
        print(f"  {n}: {text}")
    print(f"{'95 % interval of':20} {'covers':>8} {'rms of error/u':>15} {'median':>8} {'runs':>6}")
    for name in sorted({name for one in told for name in one}):
        z = np.array([one[name] for one in told if name in one and np.isfinite(one[name])])
        print(
            f"{name:20} {np.mean(np.abs(z) <= 1.96):8.1%} {np.sqrt(np.mean(z**2)):15.2f} {np.median(z):8.2f} {len(z):6}"
        )


if __name__ == "__main__":
    main()
