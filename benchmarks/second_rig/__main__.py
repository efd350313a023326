"""Score `vines.rig` on the second rig, or write its runs.

``python -m benchmarks.second_rig --seeds 0 5`` makes five runs of each effect; ``--write DIR`` writes them as run
folders with their ring-downs instead, for the commands of vines; ``--restitution`` looks at r alone, with friction not
stated.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from benchmarks.second_rig._record import write
from benchmarks.second_rig._score import score, show
from benchmarks.second_rig._settings import PHYSICS, draw_rig, rest_of


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("--seeds", nargs=2, type=int, default=(0, 3), metavar=("FROM", "COUNT"))
    ask.add_argument("--physics", default=",".join(PHYSICS), help="effects, parted by commas")
    ask.add_argument("--strength", type=float, default=1.0, help="of each, relative to what it is drawn to be")
    ask.add_argument("--duration", type=float, default=40.0, help="of a run [s]")
    ask.add_argument("--jobs", type=int, default=2)
    ask.add_argument("--write", type=Path, metavar="DIR", help="write run folders")
    ask.add_argument("--restitution", action="store_true", help="r alone, friction not stated")
    given = ask.parse_args()
    first, count = given.seeds
    plan = [(seed, physics) for physics in given.physics.split(",") for seed in range(first, first + count)]
    if given.write:
        for seed, physics in plan:
            rig = draw_rig(seed, physics, strength=given.strength, duration=given.duration)
            name = f"{physics}_{seed}"
            write(given.write / f"{name}_free", rest_of(rig))
            write(given.write / name, rig, (f"{name}_free",))
        return
    n = len(plan)
    seeds, physics = zip(*plan, strict=True)
    with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
        stated = [False if given.restitution else None] * n
        runs = list(
            pool.map(
                score, seeds, physics, [given.strength] * n, [given.duration] * n, stated, [not given.restitution] * n
            )
        )
    if not given.restitution:
        show(runs)
        return
    for title, least, most in (("all", 0.0, 1.0), ("friction < .005 g", 0.0, 0.049), ("more", 0.049, 1.0)):
        z = np.array([one.ratios["r"] for one in runs if one.ratios and least <= one.friction < most])
        if len(z):
            covers = np.mean(np.abs(z) <= 1.96)
            print(
                f"{title:20} {len(z)} runs: mean of (r - r_true)/u {z.mean():+.2f}, 95 % intervals cover {covers:.0%}"
            )


if __name__ == "__main__":
    main()
