"""Everything in full: the numbers that issues and docs promise, measured now and written to docs/acceptance.md.

Run as ``make acceptance``. Each section runs the real thing, prints as it goes, and becomes a part of the page.
"""

from __future__ import annotations

import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

import vines
from benchmarks import start_up
from vines.places import cache_folder

PAGE = Path(__file__).resolve().parent.parent / "docs" / "acceptance.md"
SCORED, COVERED = ("--seeds", "3116887", "60"), ("--seeds", "6831205", "500")
"""Seeds of the rig's score and coverage (docs/rig.md): drawn after the methods were frozen, used for nothing else."""
CHATTER = {"release": 48.6979167390, "mu": 0.0084, "A": 0.015}


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> list[str]:
    """Return a Markdown table."""
    names = list(head)
    lines = ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]
    return lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]


def timed(work: Callable[[], object], repeats: int = 7) -> float:
    """Return the median wall time of a piece of work [s]."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def machine() -> list[str]:
    """Say on what kind of machine the numbers were taken; ratios hold elsewhere, absolutes do not."""
    from vines.store import versions

    listed = ", ".join(f"{name} {version}" for name, version in versions().items())
    return [f"{os.cpu_count()} cores, {platform.system()} {platform.machine()}; {listed}."]


def four_runs() -> list[str]:
    """Settle the four runs of Fig. 2."""
    rows = []
    for A, published in ((0.015, "symmetric 1:1"), (0.020, "asymmetric 1:1"), (0.021, "1:1/2T"), (0.023, "2:1")):
        found = vines.settle(vines.Params(mu=0.01, A=A))
        side = "symmetric" if found.symmetric else "asymmetric"
        rows.append((A, published, f"{side} {found.name}", f"{found.measures.balance / found.measures.base_work:.1e}"))
    return table(("A", "paper", "settled to", "energy imbalance / base work"), rows)


def branch() -> list[str]:
    """Locate the bifurcations of the symmetric 1:1 orbit and compare simulation and closed form."""
    p = vines.Params(mu=0.01, A=0.015)
    family = vines.continue_orbit(vines.find_orbit("LR", p), "A", 0.024)
    rows = [
        (b.type.replace("_", " "), f"{b.value:.10f}", f"{b.multiplier:.8f}")
        for b in (*family.bifurcations, *family.events)
    ]
    worst = 0.0
    for A in np.linspace(0.015, 0.0179, 30):
        here = p.replace(A=float(A))
        orbit, run = vines.find_orbit("LR", here), vines.settle(here)
        for impact in run.impacts[-2:]:
            theirs = orbit.w_dot[orbit.side.tolist().index(impact["side"])]
            worst = max(worst, abs(float(impact["w_dot"]) - float(theirs)))
    return [
        *table(("on the symmetric 1:1 orbit", "A", "multiplier"), rows),
        "",
        f"Largest difference in impact velocity between simulation and closed form at 30 amplitudes from .015 to "
        f".0179: {worst:.1e}.",
    ]


def chatter() -> list[str]:
    """Run the chatter from rest and time it."""
    p = vines.Params(mu=CHATTER["mu"], A=CHATTER["A"])
    vines.simulate(p, v2=0.1, periods=500)
    seconds = timed(lambda: vines.simulate(p, v2=0.1, periods=500))
    release = float(vines.simulate(p, v2=0.1, periods=20).sticks["t_release"][0])
    return [
        f"From rest at A = {p.A:g}, mu = {p.mu:g} (x2' = .1): the ball sticks and is released at t = {release:.10f} "
        f"(known: {CHATTER['release']:.10f}); 500 periods take {1e3 * seconds:.2f} ms.",
    ]


def waiting() -> list[str]:
    """Time the command line."""
    rows = [(f"`{name}`", f"{wall:.3f}", f"{cpu:.3f}", f"{ratio:.2f}") for name, wall, cpu, ratio in start_up.rows()]
    return table(("command", "median s", "processor s", "x import numpy"), rows)


def paper() -> list[str]:
    """Compute every figure of the paper into an empty store, compare with what is printed, verify and recompute."""
    with tempfile.TemporaryDirectory() as folder:
        env = os.environ | {"VINES_DATA": folder, "NUMBA_CACHE_DIR": str(cache_folder())}

        def ask(*words: str) -> tuple[str, float]:
            begin = time.perf_counter()
            command = [sys.executable, "-m", "vines.cli", *words]
            done = subprocess.run(command, capture_output=True, text=True, check=False, env=env)
            return (done.stdout + done.stderr).strip(), time.perf_counter() - begin

        _, cold = ask("run", "paper", "--quiet")
        size = sum(
            file.stat().st_size for file in Path(folder).rglob("*") if file.is_file() and "cache" not in file.parts
        )
        _, again = ask("run", "paper", "--quiet")
        checked, _ = ask("check", "paper")
        verified, verifying = ask("verify", "--recompute", "100")
    return [
        f"`vines run paper` from an empty store, kernels compiled: {cold:.0f} s, {size / 1e6:.0f} MB; again, with "
        f"nothing to do: {again:.1f} s.",
        "",
        f"`vines check paper`: {checked.splitlines()[-1]}",
        "",
        f"`vines verify --recompute 100` ({verifying:.0f} s):",
        "",
        "```",
        *verified.splitlines(),
        "```",
    ]


def benchmark(name: str, *arguments: str) -> Callable[[], list[str]]:
    """Return a section that runs one of the benchmarks and shows what it printed."""

    def section() -> list[str]:
        command = [sys.executable, "-m", f"benchmarks.{name}", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        told = done.stdout.rstrip() if done.returncode == 0 else f"failed: {done.stderr.strip().splitlines()[-1]}"
        return ["```", *told.splitlines(), "```"]

    return section


def tests() -> list[str]:
    """Run the whole suite, the full-size variants included."""
    begin = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-n", "auto", "--dist", "loadfile", "-q", "-p", "no:cacheprovider"],
        capture_output=True,
        text=True,
        check=False,
    )
    last = done.stdout.strip().splitlines()[-1].strip("= ")
    return [f"`pytest -n auto`, full-size variants included: {last} ({time.perf_counter() - begin:.0f} s wall)."]


SECTIONS = {
    "Machine": machine,
    "The four runs of Fig. 2": four_runs,
    "Where the symmetric orbit loses stability": branch,
    "Chatter and sticking": chatter,
    "Waiting for the command line": waiting,
    "Compiling the kernels": benchmark("compilation", "--runs", "3"),
    "Dynamics, beside its peers": benchmark("dynamics"),
    "A regime map": benchmark("regime_map"),
    "Periodic orbits, beside AUTO-07p": benchmark("orbits"),
    "Attractors that stick, each found by its word": benchmark("sticking"),
    "The paper, from an empty store": paper,
    "The catalogue, beside its peers": benchmark("catalogue"),
    "Reading a run of the rig": benchmark("rig_ingest"),
    "Sixty synthetic runs of the rig, beside their sealed truth": benchmark("rig", *SCORED),
    "Do the rig's 95 % intervals cover?": benchmark("rig_coverage", *COVERED),
    "Logs, beside mcap's own writer": benchmark("logs"),
    "Pipelines, beside their peers": benchmark("engine"),
    "Tests": tests,
}


def main(names: list[str]) -> None:
    """Measure everything, or only the named sections, and write the page; other sections keep what they say."""
    subprocess.run([sys.executable, "-m", "vines.cli", "run", "quickstart", "--quiet"], check=True)
    told = kept() if names else {}
    for title, section in SECTIONS.items():
        if names and title not in names:
            continue
        print(title, flush=True)
        told[title] = section()
        print("\n".join(told[title]), flush=True)
        write(told)


def kept() -> dict[str, list[str]]:
    """Return the sections of the page as it is."""
    parts = PAGE.read_text(encoding="utf-8").split("\n## ")[1:] if PAGE.is_file() else []
    return {part.split("\n", 1)[0]: part.split("\n", 1)[1].strip().splitlines() for part in parts}


def write(told: dict[str, list[str]]) -> None:
    """Write the page in the order of the sections."""
    lines = ["# Acceptance", "", "Written by `make acceptance`; every number below was computed by it."]
    for title in SECTIONS:
        if title in told:
            lines += ["", f"## {title}", "", *told[title]]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
