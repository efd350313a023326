"""The pictures of the viewer in docs: ``python -m benchmarks.viewer_pictures [NAME...]``, all if none is named.

Those of the page and of the catalogue need Chromium.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.viewer.chromium import chromium
from vines import Params, logs, settle, simulate, viewer
from vines.dynamics import Trajectory
from vines.systems import Parallel
from vines.viewer._program import headless, served
from vines.viewer._show import _at_rest

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "pictures"
SIZE = (1600, 900)


def log(folder: Path, name: str, run: Trajectory, attractor: str, called: str) -> Path:
    """Write a run as a log of a stage of that name."""
    system = run.params.system.name if isinstance(run.params, Parallel) else None
    return logs.write_run(
        folder / f"{name}.mcap",
        states=run.sample(per_period=200, at_events=True),
        impacts=run.impacts,
        sticks=run.sticks,
        provenance={"stage": f"tour.{name}"},
        parameters=run.params.as_dict(),
        name=called,
        attractor=attractor,
        system=system,
    )


def settled(p: Params, periods: int, x2: float = 0.0, v2: float = 0.1) -> tuple[Trajectory, str]:
    """Return the motion that is left after 2000 forcing periods, and what it is called."""
    state = simulate(p, x2=x2, v2=v2, periods=2000).final
    start = {name: state[name] for name in ("x1", "v1", "x2", "v2")}
    found = settle(p, **start, phi=state["phase"], settle=0)
    return simulate(p, **start, phi=state["phase"], periods=periods), found.name or found.regime


def made(folder: Path) -> dict[str, Path]:
    """Return the logs that are shown."""
    found: dict[str, Path] = {}
    for name, A, periods, start in (
        ("one", 0.02, 10, {}),
        ("two", 0.0216, 10, {}),
        ("mirror", 0.0216, 10, {"v2": 0.3}),
        ("chaos", 0.03, 120, {}),
    ):
        run, attractor = settled(Params(mu=0.01, A=A), periods, **start)
        found[name] = log(folder, name, run, attractor, f"{attractor}, A = {A:g}")
    rest = simulate(Params(mu=0.0084, A=0.015), periods=12)
    found["chatter"] = log(folder, "chatter", rest, "1:1", "chatter and sticking from rest")
    balls = Parallel(mu=(0.008, 0.004, 0.002), beta=(1.0, 0.8, 0.6), r=(0.65, 0.5, 0.3), A=0.02)
    found["balls"] = log(folder, "balls", simulate(balls, v2_1=0.1, periods=20), "", "three balls from near rest")
    return found


def main() -> None:
    """Draw them."""
    wanted = sys.argv[1:]
    program = shutil.which("chromium") or "chromium"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found = made(folder)

        def shown(*logs_shown: str, **options: Any) -> Callable[[Path], object]:
            return lambda out: viewer.screenshot([found[each] for each in logs_shown], out, size=SIZE, **options)

        def bare(out: Path) -> None:
            with headless(found["one"], SIZE, laid_out=False) as client:
                out.write_bytes(_at_rest(client))

        def page(out: Path) -> None:
            with (
                served(viewer.save_rrd([found["one"]], folder / "one.rrd")) as (url, _),
                chromium(program, SIZE) as browser,
            ):
                browser.open(url)
                out.write_bytes(browser.at_rest())

        def catalogue(out: Path) -> None:
            stages = {path.resolve(): f"tour.{name}" for name, path in found.items()}
            with (
                viewer.catalogue_of(list(found.values()), folder / "cache", stages) as address,
                served(address) as (url, _),
                chromium(program, SIZE) as browser,
            ):
                browser.open(url)
                out.write_bytes(browser.at_rest())

        pictures: dict[str, Callable[[Path], object]] = {
            "viewer": shown("one"),
            "view_2_1": shown("two"),
            "view_chatter": shown("chatter"),
            "view_chaos": shown("chaos"),
            "view_balls": shown("balls"),
            "view_two": shown("two", "mirror"),
            "view_bare": bare,
            "view_web": page,
            "view_browse": catalogue,
        }
        for each in wanted or pictures:
            pictures[each](FOLDER / f"{each}.png")
            print(f"wrote {FOLDER / each}.png", flush=True)


if __name__ == "__main__":
    main()
