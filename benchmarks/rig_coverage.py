"""Do 95 % intervals cover? Many cheap runs made at the level of impacts, each beside a far longer run of the same rig.

`benchmarks.rig_cheap` makes them: impacts are given with errors of their times, so that nothing is detected. Run with
``python -m benchmarks.rig_coverage --seeds 0 500 --jobs 2``.
"""

from __future__ import annotations

import argparse
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context

import numpy as np
import numpy.typing as npt

from benchmarks.rig_cheap import (
    GAP,
    LENGTH,
    SIDE,
    V1,
    V1_AFTER,
    V2,
    V2_AFTER,
    X1,
    Rig,
    Run,
    T,
    draw,
    recorded,
    run_of,
)
from vines.errors import VinesError
from vines.rig import Reconstruction, reconstruct
from vines.rig.ball import Cavity, ball_motion, mean_restitution
from vines.rig.fit import Jumps, Motion
from vines.rig.quantities import cut_into_periods, slots

Floats = npt.NDArray[np.float64]

SETTLE, LONG = 200, 10_000
"""Forcing periods: before the record, and of the long run that stands for the truth."""

SLOW = 0.05
"""A record of a run that forgets more slowly holds less than twenty independent stretches of it, which tell no mean."""

SHORT = 2e-3
"""Flights below this are chatter [s]: no restitution is taken beside one, in the record as in the long run."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """A cheap run beside its truth.

    Attributes
    ----------
    seed : int
    why : str
        Why it does not count; empty if it does.
    pattern : str
    found, u, true : dict
        Estimates, standard uncertainties and true values by quantity.
    slow : float
        See `memory`.
    """

    seed: int
    why: str = ""
    pattern: str = ""
    found: dict[str, float] = field(default_factory=dict)
    u: dict[str, float] = field(default_factory=dict)
    true: dict[str, float] = field(default_factory=dict)
    slow: float = 0.0

    def ratio(self, name: str) -> float:
        """Return (estimate - truth)/u."""
        gap = self.found[name] - self.true[name]
        return (float(np.angle(np.exp(1j * gap))) if "phase" in name else gap) / self.u[name]


def one(seed: int) -> Outcome:
    """Make a cheap run, reconstruct it, and lay it beside its truth."""
    rng = np.random.default_rng([seed, 99])
    rig = draw(rng)
    run = run_of(rig, LONG + SETTLE, rng)
    begin = SETTLE * 2 * np.pi / rig.omega
    after = run.rows[run.rows[:, T] > begin]
    if np.count_nonzero(after[:, T] < begin + LENGTH) < 120:
        return Outcome(seed, "no impacts")
    if np.mean(np.diff(after[:, T]) < SHORT) > 1e-3:
        return Outcome(seed, "chatter, of which no mean is taken")
    slow = memory(rig, after)
    if slow > SLOW:
        return Outcome(seed, "hops between coexisting motions or wanders: a record tells no mean", slow=slow)
    recording, free, impacts = recorded(rig, run, begin, rng)
    try:
        found = reconstruct(recording, free, impacts=impacts)
    except VinesError as error:
        return Outcome(seed, str(error))
    if not found.accepted:
        return Outcome(seed, "not accepted: " + found.reasons)
    true = population(rig, run, begin, found)
    got = {n: found.quantities[n] for n in true if n in found.quantities and 0 < found.quantities[n].u < np.inf}
    return Outcome(
        seed, "", found.pattern.name, {n: q.value for n, q in got.items()}, {n: q.u for n, q in got.items()},
        {n: true[n] for n in got}, slow,
    )  # fmt: skip


def memory(rig: Rig, rows: Floats) -> float:
    """Return after how many periods a run forgets, in parts of a record.

    That is by how much means over as many periods as a record has scatter more than those of independent periods: of
    the impacts' number, of their speeds, of how far out they are, and of their mean place, which tells mirror images of
    a motion apart.
    """
    number = np.floor((rows[:, T] - rows[0, T]) * rig.omega / (2 * np.pi)).astype(int)
    w = rows[:, V1] - rows[:, V2]
    length = int(LENGTH * rig.omega / (2 * np.pi))
    longest = 0.0
    for values in (np.ones(len(rows)), np.abs(w), rows[:, X1] ** 2, rows[:, X1]):
        series = np.bincount(number, values)[1:-1]
        windows = series[: len(series) // length * length].reshape(-1, length).mean(axis=1)
        if np.var(series) > 1e-12 * np.mean(series**2):
            longest = max(longest, float(np.var(windows, ddof=1) / np.var(series)))
    return longest


def population(rig: Rig, run: Run, begin: float, found: Reconstruction) -> dict[str, float]:
    """Return what a far longer record of the same rig shows, taken over impacts that are chosen by the same rule."""
    p, omega = rig.true, rig.omega
    rows = run.rows[run.rows[:, T] > begin]
    time = np.diff(rows[:, T])
    b = float(rows[:, GAP].mean())
    long = np.r_[False, (time[:-1] > SHORT) & (time[1:] > SHORT), False]
    w, w_after = rows[:, V1] - rows[:, V2], rows[:, V1_AFTER] - rows[:, V2_AFTER]
    jumps = Jumps(rows[:, T], rows[:, X1], rows[:, V1], rows[:, V1_AFTER])
    plain = ball_motion(jumps, rows[:, SIDE], Cavity(b, 0.0, p["tilt"]))
    own = np.abs(w[long]) / np.abs(w[long]).mean()
    motion = _after(run.motion, begin)
    times, values = motion.peaks()
    number = np.floor((times - times[0]) * omega / (2 * np.pi)).astype(int)
    top = np.zeros(number[-1] + 1)
    np.maximum.at(top, number, values)
    v2 = 0.5 * (rows[:-1, V2_AFTER] + rows[1:, V2])
    square = float(np.sum((v2**2 + (p["friction"] * time) ** 2 / 12) * time) / np.sum(time))
    v1 = float(motion.mean_square_velocity(rows[[0, -1], T])[0])
    start = p["phi"] + omega * begin
    true = {
        "f": omega / 2 / np.pi, "E": p["E"], "phase": start, "omega0": p["omega0"], "lam": p["lam"],
        "Omega": p["Omega"],
        "A": p["E"] / b, "mu": p["mu"], "mu_momentum": p["mu"], "b": b, "friction": p["friction"],
        "tilt": p["tilt"], "r": float(np.abs(w_after[long]).mean() / np.abs(w[long]).mean()),
        "r_mean": float((-w_after / w)[long].mean()),
        "r_effective": mean_restitution(plain, long[1:-1]) / float(np.mean(own ** (1 - p["exponent"]))),
        "sigma_r": p["sigma_r"], "r_exponent": -p["exponent"], "max_abs_x1": float(top[1:-1].mean()) / b,
        "kinetic_ratio": p["mu"] * square / v1, "w_before": float(np.abs(w)[long].mean()),
        "w_after": float(np.abs(w_after)[long].mean()),
        "impacts_per_period": len(rows) / ((rows[-1, T] - rows[0, T]) * omega / (2 * np.pi)),
    }  # fmt: skip
    phase = omega * rows[:, T] + p["phi"]
    periods = cut_into_periods(phase, rows[:, SIDE], (phase[0], phase[-1]), cut=found.periods.cut)
    places = slots(periods, found.pattern, phase, rows[:, SIDE])
    if places is not None:
        true["impact_phase"] = float(np.angle(np.exp(1j * places.phase[:, 0]).mean()) + found.periods.cut)
    return true


def _after(motion: Motion, begin: float) -> Motion:
    first = int(np.searchsorted(motion.starts, begin))
    return Motion(motion.s, motion.omega, motion.c, motion.starts[first:], motion.z[first:], motion.stop)


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("--seeds", nargs=2, type=int, default=(0, 500), metavar=("FROM", "COUNT"))
    ask.add_argument("--jobs", type=int, default=2)
    given = ask.parse_args()
    first, count = given.seeds
    with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
        results = list(pool.map(one, range(first, first + count), chunksize=5))
    told = [one for one in results if not one.why]
    print(f"{count} cheap runs of {LENGTH:g} s, {len(told)} accepted")
    for text, n in Counter(one.why.split(",")[0][:60] for one in results if one.why).most_common(6):
        print(f"  {n}: {text}")
    show(told)


def show(told: list[Outcome]) -> None:
    """Print how often 95 % intervals hold the truth: of all runs, and with and without a pattern that holds."""
    print(
        f"{'95 % interval of':20} {'covers':>8} {'pattern':>8} {'mixed':>8} {'rms of z':>9} {'median':>8} {'runs':>6}"
    )
    for name in sorted({name for one in told for name in one.found}):
        z = np.array([one.ratio(name) for one in told if name in one.found])
        mixed = np.array([one.pattern == "mixed" for one in told if name in one.found])
        covers = np.abs(z) <= 1.96
        parts = [f"{covers[which].mean():8.1%}" if which.any() else " " * 8 for which in (~mixed, mixed)]
        told_by = f"{np.sqrt(np.mean(z**2)):9.2f} {np.median(z):8.2f} {len(z):6}"
        print(f"{name:20} {covers.mean():8.1%} {' '.join(parts)} {told_by}")


if __name__ == "__main__":
    main()
