"""Where the time of a regime map goes, on one core: ``python -m benchmarks.regime_map``.

1,500 random points of the rectangle of the pipeline `regimes`. Every figure is the least of five, in milliseconds of
processor a point. Nothing but vines is imported: an older revision is measured by running this file in its checkout.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from vines.attractors import _classify, classify_many

POINTS = 1500
REPEATS = 5
PARTS = {"wait": "transients, in lanes", "look": "looks at windows"}


def timed(work: Callable[..., Any], spent: dict[str, float], name: str) -> Callable[..., Any]:
    """Return a function that does the same and adds its processor time to `spent`."""

    def measured(*arguments: Any, **options: Any) -> Any:
        begin = time.process_time()
        try:
            return work(*arguments, **options)
        finally:
            spent[name] = spent.get(name, 0.0) + time.process_time() - begin

    return measured


def main() -> None:
    """Print the table."""
    draw = np.random.default_rng(7)
    points = {"A": 10 ** draw.uniform(np.log10(0.005), 0.0, POINTS), "mu": 10 ** draw.uniform(-3.0, 0.0, POINTS)}
    spent: dict[str, float] = {}
    for name in PARTS:
        setattr(_classify._Many, name, timed(getattr(_classify._Many, name), spent, name))
    classify = timed(classify_many, spent, "all")
    found = classify(points, settle=200, watch=128, threads=1)
    least: dict[str, float] = {}
    for _ in range(REPEATS):
        spent.clear()
        classify(points, settle=200, watch=128, threads=1)
        least = {name: min(spent[name], least.get(name, np.inf)) for name in spent}
    for name, what in (*PARTS.items(), ("all", "all")):
        print(f"{what:24s} {least[name] / POINTS * 1e3:8.3f} ms a point")
    regimes, counts = np.unique(found.regime, return_counts=True)
    print(", ".join(f"{count} {regime}" for regime, count in zip(regimes, counts, strict=True)))


if __name__ == "__main__":
    main()
