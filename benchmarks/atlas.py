"""Is every attractor that random simulations find in the atlas of stable orbits over a box?

Run as ``python -m benchmarks.atlas [rig|wide] [simulations] [seed]``. An atlas over a box of (A, Omega) is made of what
searches of words by their equations give, and of what simulations of its own tell beyond that. Then parameters and
starts are drawn at random in the box, none of those that it was made of, and run until they settle. Each periodic
attractor counts as present if its orbit, carried to an orbit of the atlas nearby, is the same. Both shares are printed,
and what is missing.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import dataclass

import numpy as np

from vines.attractors import Atlas, atlas, classify_many, orbit_through
from vines.errors import OrbitNotFound
from vines.model import START_NAMES, Params, Word
from vines.orbits import Orbit, words_up_to

__all__ = ["BOXES", "Box", "Found", "compare", "drawn", "main", "make"]


@dataclass(frozen=True)
class Box:
    """A box of (A, Omega), with the nodes of its atlas and the words that are searched by their equations."""

    p: Params
    A: tuple[float, float, int]
    Omega: tuple[float, float, int]
    words: tuple[str, ...]
    every: int

    @property
    def axes(self) -> dict[str, list[float]]:
        """The nodes."""
        return {"A": np.linspace(*self.A).tolist(), "Omega": np.linspace(*self.Omega).tolist()}


RUNS = 10_000
"""Simulations of which an atlas is told: as many as it is asked for."""

EXHAUSTIVE = tuple(map(str, words_up_to(3, period=3)))

BOXES = {
    "rig": Box(Params(mu=0.01, A=0.02), (0.005, 0.05, 91), (0.9, 1.1, 41), (*EXHAUSTIVE, "LLRR", "LLLRRR", "L*R*"), 10),
    "wide": Box(
        Params(mu=0.01, A=0.02), (0.05, 1.0, 96), (0.6, 1.6, 51), (*EXHAUSTIVE, "LLRR", "LLLRRR", "L*R*", "L*R"), 12
    ),
}


@dataclass(frozen=True)
class Found:
    """What became of simulations: periodic ones present by either source, and those missing with their reason."""

    present: Counter[str]
    missing: list[tuple[Word, Params, str]]
    regimes: Counter[str]

    def share(self, *sources: str) -> float:
        """Return the share of the periodic attractors that are present by some sources."""
        every = self.present.total() + len(self.missing)
        return sum(self.present[source] for source in sources) / every


def make(box: Box, runs: int) -> Atlas:
    """Return the atlas of a box."""
    return atlas(box.p, box.axes, words=box.words, every=box.every, runs=runs)


def drawn(box: Box, simulations: int, seed: int) -> tuple[list[Orbit | tuple[Word, Params]], Counter[str]]:
    """Return the orbits of periodic attractors of random simulations, or word and parameters where none was found."""
    rng = np.random.default_rng([seed, simulations])
    x1, v1 = rng.uniform(-1, 1, (2, simulations))
    begin = (x1, v1, x1 - rng.uniform(-1, 1, simulations), rng.uniform(-2, 2, simulations))
    starts = dict(zip(START_NAMES, (*begin, rng.uniform(0, 2 * np.pi, simulations)), strict=True))
    A, Omega = (rng.uniform(*ends[:2], simulations) for ends in (box.A, box.Omega))
    many = classify_many({**box.p.as_dict(), "A": A, "Omega": Omega}, starts, errors=False)
    orbits: list[Orbit | tuple[Word, Params]] = []
    for k in np.flatnonzero(many.regime == "periodic").tolist():
        p = box.p.replace(A=float(A[k]), Omega=float(Omega[k]))
        final = dict(zip(START_NAMES, many.final[k].tolist(), strict=True))
        try:
            orbits.append(orbit_through(many.words[k], p, final))
        except OrbitNotFound:
            orbits.append((many.words[k], p))
    return orbits, Counter(many.regime.tolist())


def compare(found: Atlas, orbits: list[Orbit | tuple[Word, Params]], regimes: Counter[str]) -> Found:
    """Look for orbits in an atlas."""
    present: Counter[str] = Counter()
    missing: list[tuple[Word, Params, str]] = []
    words = set(found.words)
    for orbit in orbits:
        if isinstance(orbit, tuple):
            missing.append((*orbit, "no orbit found from the run itself"))
            continue
        entry = found.entry_of(orbit)
        if entry is not None:
            present[entry.source] += 1
            continue
        known = {orbit.word, orbit.word.mirror} & words
        why = "its family is none of those of its word nearby" if known else "no orbit of its word in the atlas"
        missing.append((orbit.word, orbit.params, why))
    return Found(present, missing, regimes)


def main() -> None:
    """Print the shares of one box."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("box", nargs="?", default="rig", choices=list(BOXES))
    parser.add_argument("simulations", nargs="?", type=int, default=10_000)
    parser.add_argument("seed", nargs="?", type=int, default=18)
    chosen = parser.parse_args()
    name, simulations, seed = chosen.box, chosen.simulations, chosen.seed
    box = BOXES[name]
    began = time.perf_counter()
    found = make(box, runs=RUNS)
    made = time.perf_counter() - began
    sources = Counter(entry.source for entry in found.entries)
    print(f"{name}: A {box.A[0]} … {box.A[1]}, Omega {box.Omega[0]} … {box.Omega[1]}, {box.p}")
    print(f"{box.A[2]} x {box.Omega[2]} nodes, words searched at {len(found.nodes)} of them: {', '.join(box.words)}")
    exhaustive = [str(word) for word, complete in found.searched.items() if complete]
    print(f"exhaustive there: {', '.join(exhaustive)}")
    print(
        f"{len(found.entries)} stable orbits of {len(found.words)} words in {made:.0f} s, {dict(sources)}", flush=True
    )
    began = time.perf_counter()
    orbits, regimes = drawn(box, simulations, seed)
    seen = compare(found, orbits, regimes)
    print(f"{simulations} simulations in {time.perf_counter() - began:.0f} s: {dict(seen.regimes)}")
    print(f"periodic attractors present by equation:  {seen.share('equation'):.2%}")
    print(f"with those that its own simulations told: {seen.share('equation', 'run'):.2%}")
    reasons = Counter((str(word), why) for word, _, why in seen.missing)
    for (word, why), count in reasons.most_common():
        print(f"missing {count}: {word}, {why}")


if __name__ == "__main__":
    main()
