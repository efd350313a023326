"""One run by heyoka for benchmarks/taylor.py, in an interpreter that has heyoka: prints seconds and impacts as JSON."""

from __future__ import annotations

import json
import math
import sys
import time

import heyoka as hy  # pyright: ignore[reportMissingImports]


def main() -> None:
    """Run what the argument says, with terminal events at the barriers; compiling is not counted."""
    p = json.loads(sys.argv[1])
    x, v, w, u = hy.make_vars("x", "v", "w", "u")
    spring = p["k1"] * w + p["k3"] * w * w * w + p["l2"] * u
    angle = p["Omega"] * hy.time
    force = p["A"] * (hy.sin(angle) + p["lam"] * p["Omega"] * hy.cos(angle)) - p["lam"] * v - x
    system = [(x, v), (v, force - p["mu"] * spring), (w, u), (u, force - (1 + p["mu"]) * spring)]
    hits = 0

    def strike(flown: hy.taylor_adaptive, sign: int) -> bool:
        nonlocal hits
        hits += 1
        state = flown.state
        speed = state[3]
        state[1] -= p["mu"] * (1 + p["r"]) * speed / (1 + p["mu"])
        state[3] = -p["r"] * speed
        return True

    events = [
        hy.t_event(1.0 - side * w, callback=strike, direction=hy.event_direction.negative) for side in (1.0, -1.0)
    ]
    start = [p["x1"], p["v1"], p["x1"] - p["x2"], p["v1"] - p["v2"]]
    flown = hy.taylor_adaptive(system, start, time=p["t"], t_events=events)
    began = time.process_time()
    flown.propagate_until(p["t"] + 2 * math.pi / p["Omega"] * p["periods"])
    print(json.dumps([time.process_time() - began, hits]))


if __name__ == "__main__":
    main()
