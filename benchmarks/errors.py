"""Are the standard errors of chaos the scatter between runs? Random chaotic points, many starts each.

Run with ``python -m benchmarks.errors``. Of each point that chaos of most starts ends in, every run gives measures with
their standard errors, by `vines.classify_many` with its defaults. z is the difference of a measure to the mean over the
starts, over its own error. docs/dynamics.md has the table; tests/attractors/test_errors.py demands what is claimed.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.attractors import Classified, classify_many
from vines.model import PARAMETER_NAMES

__all__ = ["NAMES", "Scores", "main", "scores"]

Floats = npt.NDArray[np.float64]

NAMES = ("kinetic_ratio", "max_abs_x1", "rms_x1", "lyapunov")

MOST = 0.8
"""Share of the starts that must be chaotic for a point to be one of chaos."""

OTHER = 10.0
"""Factor between the error of a run and the median of all by which the run is on another motion: a long transient."""


@dataclass(frozen=True)
class Scores:
    """Points, shape (n, 5), and for each the z of all its chaotic runs by measure, nan where a run tells no error."""

    points: Floats
    z: list[dict[str, Floats]]

    def of(self, name: str) -> Floats:
        """Return the z of a measure at all points that have an error."""
        every = np.concatenate([each[name] for each in self.z])
        return every[np.isfinite(every)]

    def told(self, name: str) -> float:
        """Return which share of the runs tells an error."""
        return float(np.mean(np.isfinite(np.concatenate([each[name] for each in self.z]))))


def scores(points: int = 40, starts: int = 60, seed: int = 18) -> Scores:
    """Return the z of random chaotic points."""
    rng = np.random.default_rng(seed)
    kept: list[Floats] = []
    z: list[dict[str, Floats]] = []
    while len(kept) < points:
        drawn = np.stack(
            [
                10 ** rng.uniform(-2.5, 0.5, 64),
                10 ** rng.uniform(-2.0, 0.0, 64),
                rng.uniform(0.5, 1.5, 64),
                rng.uniform(0.3, 0.9, 64),
                10 ** rng.uniform(-2.3, -0.4, 64),
            ],
            axis=1,
        )
        alone = classify_many(dict(zip(PARAMETER_NAMES, drawn.T, strict=True)), errors=False)
        for point in drawn[alone.regime == "chaotic"]:
            if len(kept) == points:
                break
            found = _z(_runs(point, starts, rng))
            if found is not None:
                kept.append(point)
                z.append(found)
    return Scores(np.array(kept), z)


def _runs(point: Floats, starts: int, rng: np.random.Generator) -> Classified:
    x1, v1, x2, v2 = rng.uniform(-0.3, 0.3, (4, starts))
    begin = {"x1": x1, "v1": v1, "x2": x1 + x2 / 0.3, "v2": v2}
    return classify_many(dict(zip(PARAMETER_NAMES, np.repeat(point[:, None], starts, axis=1), strict=True)), begin)


def _z(many: Classified) -> dict[str, Floats] | None:
    chaos = (many.regime == "chaotic") & many.settled
    if np.mean(chaos) < MOST:
        return None
    told = np.column_stack([many.errors, many.lyapunov_error])
    typical = np.nanmedian(told[chaos], axis=0)
    chaos &= np.all((told < OTHER * typical) & (told > typical / OTHER) | np.isnan(told), axis=1)
    errors = dict(zip(NAMES, told[chaos].T, strict=True))
    values = {name: many.measures[name][chaos] for name in NAMES[:3]} | {"lyapunov": many.lyapunov[chaos]}
    # The mean of n is itself off by 1/n of the variance.
    n = int(np.sum(chaos))
    return {name: (values[name] - values[name].mean()) / errors[name] * np.sqrt(n / (n - 1)) for name in NAMES}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=40)
    parser.add_argument("--starts", type=int, default=60)
    parser.add_argument("--seed", type=int, default=18)
    chosen = parser.parse_args()
    found = scores(chosen.points, chosen.starts, chosen.seed)
    print("| mu | A | Omega | r | lam | " + " | ".join(NAMES) + " |")
    print("|---|---|---|---|---|" + "---|" * len(NAMES))
    for point, each in zip(found.points, found.z, strict=True):
        squares = [f"{np.nanmean(each[name] ** 2):.2f}" for name in NAMES]
        print("| " + " | ".join(f"{value:.4g}" for value in point) + " | " + " | ".join(squares) + " |")
    print()
    print("| | " + " | ".join(NAMES) + " |\n|---|" + "---|" * len(NAMES))
    print("| mean of z² | " + " | ".join(f"{np.mean(found.of(name) ** 2):.2f}" for name in NAMES) + " |")
    print("| \\|z\\| > 3 | " + " | ".join(f"{np.mean(np.abs(found.of(name)) > 3):.2%}" for name in NAMES) + " |")
    print("| runs that tell an error | " + " | ".join(f"{found.told(name):.1%}" for name in NAMES) + " |")


if __name__ == "__main__":
    main()
