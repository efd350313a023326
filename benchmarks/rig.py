"""How near reconstruction and comparison come to the truth of synthetic runs over the ranges of a real rig.

Run with ``python -m benchmarks.rig --seeds 0 60 --jobs 2``; prints tables, the worst cases by name. Seeds below 1000
were used while the methods were made; a score is taken once, on seeds from 100000.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from benchmarks.rig_runs import FAULTS, Scored, planted, score


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("--seeds", nargs=2, type=int, default=(0, 60), metavar=("FROM", "COUNT"))
    ask.add_argument("--duration", type=float, default=60.0, help="of a run [s]")
    ask.add_argument("--jobs", type=int, default=2)
    ask.add_argument("--faults", type=int, default=1, help="runs with each planted fault")
    ask.add_argument("--out", type=Path, help="keep the rows as JSON lines")
    given = ask.parse_args()
    first, count = given.seeds
    with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
        runs = kept(pool.map(score, range(first, first + count), [given.duration] * count), given.out)
        plan = [(first + k, fault) for fault in FAULTS for k in range(given.faults)]
        faults = list(pool.map(planted, *zip(*plan, strict=True))) if plan else []
    print_targets(runs)
    print_coverage(runs)
    print_verdicts(runs)
    for (seed, fault), (verdict, why) in zip(plan, faults, strict=True):
        print(f"{'WRONG ' if verdict == 'agree' else ''}planted {fault} ({seed}): {verdict}: {why[:140]}")


def kept(results: Iterable[Scored], out: Path | None) -> list[Scored]:
    """Gather results as they come, and keep them."""
    runs = []
    for one in results:
        runs.append(one)
        if out is not None:
            with out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(one)) + "\n")
    return runs


def print_targets(runs: list[Scored]) -> None:
    """Print the share of runs within each target and the worst ones."""
    usable = [one for one in runs if one.errors]
    print(f"{len(runs)} runs, {len(usable)} reconstructed, {sum(one.accepted for one in runs)} accepted")
    print(f"{'target':28} {'within, of accepted':>20} {'of all':>8} {'median':>9}  worst")
    tests: dict[str, tuple[Callable[[Scored], float], float]] = {
        "r +-.005": (lambda one: abs(one.errors["r"]), 0.005),
        "r_mean +-.005": (lambda one: abs(one.errors["r_mean"]), 0.005),
        "sigma_r +-20 %": (lambda one: abs(one.errors["sigma_r"]), 0.2),
        "mu +-1 %": (lambda one: abs(one.errors["mu"]), 0.01),
        "impact times, rms <= 20 us": (lambda one: 1e6 * one.errors["t_rms"], 20.0),
        "impact times, 95 % <= 20 us": (lambda one: 1e6 * one.errors["t_95"], 20.0),
    }
    for name, (value, most) in tests.items():
        accepted = [one for one in usable if one.accepted]
        good = sum(value(one) <= most for one in accepted)
        everywhere = sum(value(one) <= most for one in usable)
        worst = sorted(usable, key=value, reverse=True)[:4]
        listed = ", ".join(
            f"{one.seed} ({one.kind}{'' if one.accepted else ', not accepted'}): {value(one):.3g}" for one in worst
        )
        middle = float(np.median([value(one) for one in usable])) if usable else np.nan
        print(f"{name:28} {good:>12} of {len(accepted):<4} {everywhere:>3}/{len(runs)} {middle:9.3g}  {listed}")
    total = sum(one.impacts for one in usable)
    print(f"impacts {total}, missed {sum(one.missed for one in usable)}, false {sum(one.false for one in usable)}")
    clear = [one for one in runs if one.true_fraction >= 0.95]
    wrong = [one for one in clear if not same_pattern(one)]
    print(f"right pattern in {len(clear) - len(wrong)} of {len(clear)} runs where one holds in 95 % of the periods")
    for one in wrong:
        print(f"  wrong: {one.seed} ({one.kind}) {one.pattern or one.refused[:100]}, true {one.true_pattern}")
    for one in runs:
        if one.refused or not one.accepted:
            print(f"  {one.seed} ({one.kind}) {'refused' if one.refused else 'not accepted'}: "
                  f"{(one.refused or one.reasons)[:160]}")  # fmt: skip


def same_pattern(one: Scored) -> bool:
    """Say whether the pattern is the true one; the truth counts impacts and cannot tell 2:2/2T from 1:1."""
    return one.pattern == one.true_pattern or (one.pattern == "2:2/2T" and one.regime == "2:2/2T")


def print_coverage(runs: list[Scored]) -> None:
    """Print how often 95 % intervals hold the truth."""
    accepted = [one for one in runs if one.accepted]
    print(f"{'interval of':16} {'covers':>8} {'rms of error/u':>15}  farthest")
    for name in sorted({name for one in accepted for name in one.ratios}):
        z = {one.seed: one.ratios[name] for one in accepted if name in one.ratios}
        values = np.array(list(z.values()))
        far = sorted(z, key=lambda seed: -abs(z[seed]))[:3]
        covers = np.mean(np.abs(values) <= 1.96)
        print(
            f"{name:16} {covers:8.1%} {np.sqrt(np.mean(values**2)):15.2f}  "
            + ", ".join(f"{s}: {z[s]:.1f}" for s in far)
        )


def print_verdicts(runs: list[Scored]) -> None:
    """Print the verdicts by kind of run, and by what the truth is."""
    for title, of in (("kind", lambda one: one.kind), ("truth", expected)):
        groups: dict[str, Counter[str]] = {}
        for one in runs:
            groups.setdefault(of(one), Counter())[one.verdict] += 1
        for name, counts in sorted(groups.items()):
            print(f"{title:6} {name:20} " + ", ".join(f"{verdict} {n}" for verdict, n in counts.most_common()))
    for one in runs:
        open_truth = expected(one) != "clear"
        if one.verdict in ("disagree", "pattern_only") or (
            open_truth and one.verdict not in ("undecidable", "refused")
        ):
            print(f"  {one.seed} ({one.kind}; {one.true_pattern} {one.true_fraction:.0%}, {one.regime}): "
                  f"{one.verdict}: {one.reason[:170]}")  # fmt: skip


def expected(one: Scored) -> str:
    """Return ``mixed`` or ``chaotic`` where the truth decides nothing, else ``clear``."""
    if one.true_fraction < 0.95:
        return "mixed"
    return "chaotic" if one.regime in ("chaotic", "unsettled", "quasiperiodic") else "clear"


if __name__ == "__main__":
    main()
