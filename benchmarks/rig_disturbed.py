"""What electrical and slow troubles of real rigs do to reconstruction and verdict: named, or dealt with, or missed?

Run with ``python -m benchmarks.rig_disturbed --seeds 0 2``: each seed draws a run for each trouble; prints a line a run
and the share of causes named. ``agree`` counts as right only where the trouble was dealt with and r is within .005.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np

from benchmarks.rig_runs import rest_of, true_values
from vines.errors import VinesError
from vines.rig import compare, reconstruct, ring_down
from vines.rig.synth import Burst, Disturbances, Hum, RigSettings, Ringing, disturbed, draw_settings, raw_run, read_raw

_DURATION = 24.0


def troubles(rng: np.random.Generator) -> Iterator[tuple[str, str, dict[str, Any], Disturbances]]:
    """Yield name of a trouble, the finding that names it, settings and what is added to the channels."""

    def modes(role: str) -> tuple[Ringing, ...]:
        return tuple(
            Ringing(role, f * rng.uniform(0.95, 1.05), rng.uniform(0.01, 0.025), rng.uniform(0.05, 0.3))
            for f in (38.0, 112.0, 310.0)
        )

    def bursts(kind: Any, count: int, length: float) -> tuple[Burst, ...]:
        return tuple(Burst("lo_disp", kind, float(t), length) for t in rng.uniform(0.5, _DURATION - 0.5, count))

    mains = (Hum(float(rng.choice([50.0, 60.0])) + rng.normal(0, 0.02), 3e-3, 0.01), Hum(150.0, 1e-3))
    end = _DURATION
    yield "none", "", {}, Disturbances()
    yield "hum", "hum", {}, Disturbances(hum=mains[:1])
    yield "modes in the laser", "frame_modes", {}, Disturbances(ringing=modes("lo_disp"))
    yield "hum and modes", "hum", {}, Disturbances(hum=mains[:1], ringing=modes("lo_disp"))
    yield "r falls", "drift_r", {"r": 0.68, "r_course": ((0.0, 0.0), (end, -0.07))}, Disturbances()
    yield "E ramps", "drift_E", {"E_course": ((0.0, 1.0), (end, 1 + rng.uniform(0.015, 0.04)))}, Disturbances()
    warm = 20.0 + float(rng.choice([-1, 1]) * rng.uniform(4.0, 8.0))
    yield "springs warm", "drift_omega0", {"temperature": (20.0, warm), "settle": 30.0}, Disturbances()
    stairs = ((0.0, 1.0), (9.0, 1.0), (9.5, 1.08), (17.0, 1.08), (17.5, 1.16))
    yield "levels", "levels", {"E_course": stairs}, Disturbances()
    yield "spikes", "lost_signal", {}, Disturbances(bursts=bursts("spike", 6, 0.02))
    yield "held values", "lost_signal", {}, Disturbances(bursts=bursts("held", 8, 0.01))
    yield "dropouts", "lost_signal", {}, Disturbances(bursts=bursts("dropout", 8, 0.008))
    yield "lost too long", "lost", {}, Disturbances(bursts=bursts("held", 10, 0.2))


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("--seeds", nargs=2, type=int, default=(0, 2), metavar=("FROM", "COUNT"))
    given = ask.parse_args()
    named = total = wrong = 0
    for seed in range(given.seeds[0], given.seeds[0] + given.seeds[1]):
        rng = np.random.default_rng([seed, 19])
        for name, finding, change, what in troubles(rng):
            drawn = draw_settings(
                seed, duration=_DURATION, recorders=1, offset_second=0.0, sag=0.0, dropouts=0.0, sigma_r=0.008,
                friction=0.002, f=8.815555, m=0.0382, E=0.015 * rng.uniform(0.014, 0.017),
            )  # fmt: skip
            s = msgspec.structs.replace(drawn, **{"temperature": (20.0, 20.0), **change})
            told, right, verdict = _told(s, seed, finding, what)
            total += bool(finding)
            named += bool(finding) and right
            bad = verdict == "agree" and (finding.startswith("drift") or finding in ("levels", "lost"))
            wrong += bad
            print(
                f"{seed} {name:20} {'named ' if right else 'missed' if finding else '      '} {told[:150]}", flush=True
            )
    print(f"{named} of {total} causes named; {wrong} wrong agreements")


def _told(s: RigSettings, seed: int, finding: str, what: Disturbances) -> tuple[str, bool, str]:
    raw = disturbed(raw_run(s, seed), what, seed)
    free = [ring_down(read_raw(raw_run(rest_of(s, when), seed + 500_000))) for when in sorted(set(s.temperature))]
    try:
        found = reconstruct(read_raw(raw), free)
    except VinesError as error:
        return str(error), bool(finding) and "lost" in finding and "lost" in str(error), "refused"
    one = compare(found)
    named = any(
        each.name == finding and (each.passed != finding.startswith(("drift", "lev"))) for each in found.findings
    )
    off = found.quantities["r"].value - true_values(raw.truth)["r"]
    return f"{one.verdict}, r off {off:+.4f}; {one.reason}", named, one.verdict


if __name__ == "__main__":
    main()
