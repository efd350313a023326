"""Speed and error of the simulator, with its peers in the same run: ``python -m benchmarks.dynamics``.

Every figure is the median of five. Errors are those of |w'| at the impacts of a stable symmetric 1:1 orbit, whose
closed form is known; all methods start on it. Times are those of the processor, so that a busy machine disturbs little.
"""

from __future__ import annotations

import json
import math
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.lanes import MIXED, ORBIT, PUBLISHED_FLOOR, REPEATS, floor, median, ways_to_run
from benchmarks.rk4 import rk4_run
from vines.dynamics import Scatter, ensemble, lyapunov_spectrum, simulate
from vines.model import Params
from vines.orbits import find_orbit

SCATTERED = {
    "restitution drawn": Scatter(sigma_r=0.02, seed=1),
    "second harmonic": Scatter(second=0.1, seed=1),
    "32 held forces a period": Scatter(noise=0.05, hold=32, seed=1),
}

MILLION = """
import json, resource, time
import numpy as np
from vines.dynamics import ensemble
from vines.model import Params
n = 1_000_000
began, cpu = time.perf_counter(), time.process_time()
many = ensemble(Params(mu=0.01, A=0.02), {"v2": np.linspace(0.05, 0.5, n)}, settle=1, periods=4, record="measures")
print(json.dumps({
    "runs": n, "impacts": int(many.counts.sum()), "seconds": time.perf_counter() - began,
    "cpu": time.process_time() - cpu, "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    "errors": int(np.isfinite(many.measures["kinetic_ratio_error"]).sum()),
}))
"""


def million() -> dict[str, float]:
    """Run a million trajectories of which only measures are kept, in a process of its own; return what it took."""
    done = subprocess.run([sys.executable, "-c", MILLION], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def start_on(p: Params) -> tuple[dict[str, float], float]:
    """Return the state just after an impact of the symmetric 1:1 orbit, and |w'| before its impacts."""
    orbit = find_orbit("LR", p)
    x1, v1, x2, v2 = (float(value) for value in orbit.states[0][:4])
    w = v1 - v2
    v1, v2 = v1 - p.mu * (1 + p.r) / (1 + p.mu) * w, v2 + (1 + p.r) / (1 + p.mu) * w
    return {"x1": x1, "v1": v1, "x2": x2, "v2": v2, "phase": float(orbit.phase[0])}, abs(float(orbit.w_dot[0]))


def ours(p: Params) -> list[tuple[str, float]]:
    """Return (what, ns an impact) for the ways to run."""
    rows = ways_to_run(p)
    run = simulate(p, periods=5000)
    hits = len(run.impacts)
    rows.append(("scalar, every event kept", median(lambda: simulate(p, periods=5000)) / hits * 1e9))
    rows.append(("scalar, measures of it", median(run.measures) / hits * 1e9))
    rows.append(("scalar, Lyapunov spectrum of it", median(lambda: lyapunov_spectrum(run)) / hits * 1e9))
    for name, scatter in SCATTERED.items():
        asked = {"periods": 2000, "record": "measures", "scatter": scatter, "threads": 1}
        hits = int(ensemble(p, **asked).counts.sum())
        rows.append((f"scatter, measures, {name}", median(lambda asked=asked: ensemble(p, **asked)) / hits * 1e9))
    return rows


def scattered(rows: list[tuple[str, float]]) -> list[tuple[str, float]]:
    """Return (what, times the scalar kernel with measures) for the runs with scatter among the rows of `ours`."""
    told = dict(rows)
    exact = told["scalar, every event kept"] + told["scalar, measures of it"]
    return [(name, ns / exact) for name, ns in rows if name.startswith("scatter")]


def dop853(p: Params, start: dict[str, float], periods: float) -> np.ndarray:
    """Return |w'| of the impacts by SciPy's DOP853 at 1e-9 with events for the walls."""
    x1, v1, x2, v2 = (start[name] for name in ("x1", "v1", "x2", "v2"))
    t, stop, speeds = 0.0, periods * p.period, []

    def motion(t: float, y: np.ndarray) -> list[float]:
        angle = p.Omega * t + start["phase"]
        return [y[1], p.A * math.sin(angle) + p.lam * p.Omega * p.A * math.cos(angle) - p.lam * y[1] - y[0], y[3], 0.0]

    def left(t: float, y: np.ndarray) -> float:
        return y[0] - y[2] - 1.0

    def right(t: float, y: np.ndarray) -> float:
        return y[0] - y[2] + 1.0

    left.terminal, left.direction = True, 1  # type: ignore[attr-defined]
    right.terminal, right.direction = True, -1  # type: ignore[attr-defined]
    while t < stop:
        leg = solve_ivp(
            motion, (t, stop), [x1, v1, x2, v2], method="DOP853", rtol=1e-9, atol=1e-12, events=(left, right)
        )
        if leg.status != 1:
            break
        t, (x1, v1, x2, v2) = float(leg.t[-1]), leg.y[:, -1]
        w = v1 - v2
        speeds.append(abs(w))
        v1, v2 = v1 - p.mu * (1 + p.r) / (1 + p.mu) * w, v2 + (1 + p.r) / (1 + p.mu) * w
        side = math.copysign(1.0, x1 - x2)
        x2 = x1 - side * (1.0 - 1e-15)
    return np.array(speeds)


def siconos(p: Params, start: dict[str, float], periods: int) -> dict | None:
    """Return what benchmarks/siconos_run.py prints, or None where no interpreter has Siconos."""
    python = shutil.which("python3", path="/usr/bin:/usr/local/bin")
    if python is None:
        return None
    # Siconos does not begin on a wall: it gets the state a little later, from the closed form.
    state = {name: start[name] for name in ("x1", "v1", "x2", "v2")}
    begin = simulate(p, **state, phi=start["phase"], periods=0.1).final
    numbers = [p.mu, p.A, p.Omega, p.r, p.lam, periods, *(begin[n] for n in ("x1", "v1", "x2", "v2", "phase"))]
    script = Path(__file__).with_name("siconos_run.py")
    words = [python, str(script), *(repr(float(number)) for number in numbers)]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=300)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if done.returncode == 0 and lines else None


def peers(p: Params, periods: int) -> list[tuple[str, float, float]]:
    """Return (method, ns an impact, largest error of |w'|) for the peers, all started on the orbit."""
    start, speed = start_on(p)
    state = [start[name] for name in ("x1", "v1", "x2", "v2", "phase")]
    rows = []
    for parts in (100, 400, 2000):
        speeds = np.zeros(4 * periods)
        run = lambda parts=parts, speeds=speeds: rk4_run(  # noqa: E731
            p.mu, p.A, p.Omega, p.r, p.lam, *state, periods * p.period, parts, speeds
        )
        hits = run()
        rows.append((f"RK4, h = T/{parts}, halved to 1e-9 (the paper's way)", median(run) / hits * 1e9, speeds, hits))
    few = max(periods // 10, 2)
    speeds = dop853(p, start, few)
    rows.append(("SciPy DOP853, rtol 1e-9, events", median(lambda: dop853(p, start, few)) / len(speeds) * 1e9, speeds,
                 len(speeds)))  # fmt: skip
    told = [siconos(p, start, few) for _ in range(REPEATS)]
    if all(told) and told[0]["impacts"]:
        seconds = statistics.median(answer["seconds"] for answer in told)
        speeds = np.array(told[0]["speeds"])
        rows.append(("Siconos, event-driven", seconds / told[0]["impacts"] * 1e9, speeds, len(speeds)))
    return [(name, ns, float(np.max(np.abs(found[:hits] - speed)))) for name, ns, found, hits in rows]


def errors_of_ours(p: Params, periods: int) -> list[tuple[str, float]]:
    """Return the largest error of |w'| of the scalar kernel and of the lanes."""
    start, speed = start_on(p)
    state = {name: start[name] for name in ("x1", "v1", "x2", "v2")}
    hits = simulate(p, **state, phi=start["phase"], periods=periods).impacts
    many = ensemble(p, {name: [value] for name, value in start.items()}, periods=periods, record="impacts").impacts
    assert many is not None
    return [(name, float(np.max(np.abs(np.abs(found["w_dot"]) - speed)))) for name, found in
            (("scalar, every event kept", hits), ("lanes, final states", many))]  # fmt: skip


def main() -> None:
    """Print the table."""
    bottom = floor()
    print(f"floor: four sincos-exp evaluations in a lane {bottom:.1f} ns here, {PUBLISHED_FLOOR:.0f} ns in the facts")
    for p in (ORBIT, MIXED):
        print(f"\n{p}")
        rows = ours(p)
        times = dict(scattered(rows))
        for name, ns in rows:
            ratio = f", {times[name]:.1f} x scalar with measures" if name in times else ""
            if name == "lanes, final states":
                ratio = f", {ns / bottom:.1f} floors of here, {ns / PUBLISHED_FLOOR:.1f} of the facts"
            print(f"  {name:36s} {ns:12.1f} ns an impact{ratio}")
    errors = dict(errors_of_ours(ORBIT, 500))
    base = dict(ours(ORBIT))
    print(f"\nerror of |w'| on the 1:1 orbit of {ORBIT}, 500 periods (event solvers 50)")
    for name in ("lanes, final states", "scalar, every event kept"):
        print(f"  {name:52s} {base[name] / 1e3:12.4f} us an impact  error {errors[name]:.1e}")
    for name, ns, error in peers(ORBIT, 500):
        print(
            f"  {name:52s} {ns / 1e3:12.4f} us an impact  error {error:.1e}  "
            f"{ns / base['scalar, every event kept']:.0f} x scalar, {ns / base['lanes, final states']:.0f} x lanes"
        )
    took = million()
    print(
        f"\n{took['runs']:,} trajectories of which measures are kept: peak memory {took['peak'] / 1e6:.0f} MB, "
        f"{took['seconds']:.0f} s, {took['cpu'] / took['impacts'] * 1e9:.0f} ns of processor an impact"
    )


if __name__ == "__main__":
    main()
