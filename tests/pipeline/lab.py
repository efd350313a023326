"""A small laboratory of its own: a package with bodies and helpers in a temporary folder, and kinds for it.

Processes that tests start import it as well, and nothing of pytest with it.
"""

import importlib
import textwrap
from pathlib import Path

from vines.pipeline import Kind, load, register, run_pipeline
from vines.store import Store

BODY = '''
"""Bodies of the toy kinds."""

import importlib
import multiprocessing
import os
import time
from pathlib import Path

import msgspec

from toylab.law import law
from vines.pipeline import Batch

pause = time.sleep


class ToyOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    gain: float = 1.0
    steps: int = 1
    wait: float = 0.0
    bad: tuple[float, ...] = ()
    tally: str = ""
    die: str = ""
    package: str = ""


class SumOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    label: str = "sum"
    tally: str = ""


def points(job):
    options = job.options
    before = None if job.start is None else job.start["end_x1"]
    rows, impacts, logs = [], [], {}
    for point in job.points:
        pause(options.wait)
        if options.die and multiprocessing.parent_process() and not Path(options.die).exists():
            Path(options.die).touch()
            os._exit(1)
        if point.params["A"] in options.bad:
            raise ValueError(f"A = {point.params['A']} is bad")
        if options.package:
            importlib.import_module(options.package)
        if options.tally:
            with Path(options.tally).open("a") as stream:
                stream.write(f"{point.id}\\n")
        x1 = law(point.params["A"], options.gain) + (0.5 * before if before is not None else 0.0)
        row = {"point_id": point.id, **point.params, "carry": job.carry, "end_x1": x1}
        rows.append({**row, "name": "1:1", "status": "ok"})
        impacts += [{"point_id": point.id, **point.params, "index": i, "t": float(i)} for i in range(2)]
        logs[point.id] = f"run-{point.id}.txt"
        (job.folder / logs[point.id]).write_text(f"{x1!r}\\n")
        before = x1 if job.carry else None
    return Batch(tables={"points": rows, "impacts": impacts}, logs=logs)


def bare(job):
    A = job.points.column("A")
    rows = {"point_id": job.points.ids, "A": A, "mu": job.points.column("mu"), "end_x1": law(1.0, 2.0) * A}
    pause(job.options.wait * len(A))
    return Batch(tables={"points": {**rows, "status": ["ok"] * len(A)}})


def whole(job):
    total = sum(x or 0.0 for table in job.inputs.values() for x in table.table().column("end_x1").to_pylist())
    if job.options.label == "broken":
        raise RuntimeError("label is broken")
    (job.folder / "note.txt").write_text(job.options.label)
    return Batch(tables={"checks": [{"id": job.options.label, "our_value": total}]})


def picture(job):
    if job.options.label == "broken":
        raise RuntimeError("label is broken")
    if job.options.label == "dies" and multiprocessing.parent_process():
        os._exit(1)
    if job.options.tally:
        with Path(job.options.tally).open("a") as stream:
            stream.write(f"{os.getpid()}\\n")
    for end in ("png", "svg", "pdf"):
        (job.folder / f"picture.{end}").write_text(" ".join(job.inputs))
    return Batch()
'''

LAW = '''
"""The law, in another file than the body."""

import math


def law(a, gain):
    """Return the value."""
    return gain * math.sin(a)  # exactly
'''


class Lab:
    """A temporary project with the toy kinds."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.package = folder / "code" / "toylab"
        self.package.mkdir(parents=True)
        self.source("__init__", '"""Toy laboratory."""\n')
        self.source("bodies", BODY)
        self.source("law", LAW)
        self.store = Store(folder / "data")
        self.events = []

    def source(self, name: str, text: str) -> None:
        (self.package / f"{name}.py").write_text(text)

    def register(self) -> None:
        bodies = importlib.import_module("toylab.bodies")
        register(
            Kind(
                name="toy",
                summary="points of a toy law",
                shape="points",
                options=bodies.ToyOptions,
                body="toylab.bodies:points",
                tables=("points", "impacts"),
                parameters={"A": None, "mu": 0.1},
                vary="grid",
                carry=True,
                logs=True,
            )
        )
        register(
            Kind(
                name="bare",
                summary="points of a straight line, as columns, without logs",
                shape="points",
                options=bodies.ToyOptions,
                body="toylab.bodies:bare",
                tables=("points",),
                parameters={"A": None, "mu": 0.1},
                vary="grid",
            )
        )
        register(
            Kind(
                name="total",
                summary="sum of what other stages made",
                shape="whole",
                options=bodies.SumOptions,
                body="toylab.bodies:whole",
                tables=("checks",),
                needs=True,
            )
        )
        register(
            Kind(
                name="picture",
                summary="a picture of what other stages made",
                shape="whole",
                options=bodies.SumOptions,
                body="toylab.bodies:picture",
                needs=True,
                pictures=True,
            )
        )

    def declare(self, text: str, name: str = "toys") -> Path:
        path = self.folder / "pipelines" / f"{name}.toml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(textwrap.dedent(text))
        return path

    def run(self, path: Path, overrides=None, **options):
        self.events = []
        pipeline = load(path, overrides, root=self.folder)
        return run_pipeline(pipeline, self.store, report=self.events.append, **options)

    def folder_of(self, stage: str, pipeline: str = "toys") -> Path:
        return self.store.result(self.store.pins(pipeline)[stage]["result"]).folder

    def bytes_of(self, stage: str, pipeline: str = "toys") -> dict[str, bytes]:
        folder = self.folder_of(stage, pipeline)
        names = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "manifest.json"]
        return {str(path.relative_to(folder)): path.read_bytes() for path in names}

    def rows(self, stage: str, table: str | None = None):
        return self.store.result(self.store.pins("toys")[stage]["result"]).table(table).to_pylist()
