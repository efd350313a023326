"""A package that is not of vines, installed into a folder of its own, brings a kind, a table, a plot and a format."""

import importlib
import json
import os
import subprocess
import sys

import msgspec
import numpy as np
import pytest

import vines
from vines.errors import DeclarationError, PlugInError
from vines.rig import read_run
from vines.rig.formats import read_file
from vines.rig.synth import RigSettings, make_run
from vines.schema import _tables
from vines.stages import declaration_schema, list_kinds, list_plots, load_pipeline, run, status

KIND = '''
"""A kind: how far a ball bounces."""

import msgspec

from vines.pipeline import Batch, Kind, WholeJob


class BounceOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Heights of a ball that falls from 1, so many times."""

    times: int = 3
    r: float = 0.5


def compute(job: WholeJob) -> Batch:
    from bouncing._law import height

    rows = [{"number": k, "height": height(k, job.options.r)} for k in range(job.options.times)]
    return Batch(tables={"bounces": rows})


KIND = Kind(
    name="bounce",
    summary="heights of a bouncing ball",
    shape="whole",
    options=BounceOptions,
    body="bouncing.kind:compute",
    tables=("bounces",),
)
'''

LAW = """
def height(k, r):
    return r ** (2 * k)
"""

TABLE = """
name = "bounces"
description = "a bounce"
version = 1
columns = [
    { name = "point_id", dtype = "string", unit = "", description = "id", source = "" },
    { name = "number", dtype = "int64", unit = "", description = "which", source = "" },
    { name = "height", dtype = "float64", unit = "1", description = "how high", source = "" },
]
"""

PLOT = '''
"""A plot in one file: options, check, rows to panels, and a panel of its own."""

from dataclasses import dataclass

from vines.errors import DeclarationError
from vines.stages.plots import Plot, PlotOptions


class HeightsOptions(PlotOptions, frozen=True, tag="heights"):
    """Heights of bounces."""

    colour: str = "#222222"


@dataclass(frozen=True)
class Panel:
    rows: list
    colour: str

    def draw(self, ax):
        ax.plot([row["number"] for row in self.rows], [row["height"] for row in self.rows], "o-", color=self.colour)

    def entries(self):
        from matplotlib.lines import Line2D

        return [("height", (Line2D([], [], color=self.colour),))]


def check(stage, pipeline):
    if any("bounces" not in pipeline.stages[name].kind.tables for name in stage.needs):
        raise DeclarationError("heights are those of bounces")


def draw(inputs, options):
    from vines.figures import sheet_figure

    panels = [Panel(stage.table().to_pylist(), options.colour) for stage in inputs.values()]
    return sheet_figure(panels, columns=len(panels), caption=options.title, width=options.width)


PLOT = Plot(summary="heights of bounces", options=HeightsOptions, draw=draw, check=check)
'''

FORMAT = '''
"""A format of recordings: a line a channel, its name, unit and rate before its samples."""

import numpy as np

from vines.rig.formats import Format, RawChannel, RawFile


def read(path):
    channels = []
    for line in path.read_text().splitlines()[1:]:
        name, unit, rate, *values = line.split()
        channels.append(RawChannel(name, np.array(values, float), unit, float(rate), 0.0))
    return RawFile("lines", tuple(channels))


FORMAT = Format(
    name="lines",
    label="lines of samples",
    summary="a line a channel",
    suffixes=(".lines",),
    read=read,
    begins=lambda head, suffix: head.startswith(b"LINES"),
)
'''

ENTRY_POINTS = """
[vines.kinds]
bounce = bouncing.kind:KIND

[vines.tables]
bounces = bouncing.schemas

[vines.plots]
heights = bouncing.plot:PLOT

[vines.formats]
lines = bouncing.format:FORMAT
"""

STUDY = """
title = "mine"
[stages.ball]
kind = "bounce"
times = 4
[stages.figure]
kind = "figure"
plot = "heights"
needs = ["ball"]
colour = "#c8102e"
title = "one ball"
"""


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Install the package into a folder, and forget it afterwards."""
    site = tmp_path / "site"
    (site / "bouncing" / "schemas").mkdir(parents=True)
    (site / "bouncing_ball-1.0.dist-info").mkdir()
    for name, text in {
        "bouncing/__init__.py": "",
        "bouncing/kind.py": KIND,
        "bouncing/_law.py": LAW,
        "bouncing/plot.py": PLOT,
        "bouncing/format.py": FORMAT,
        "bouncing/schemas/bounces.toml": TABLE,
        "bouncing_ball-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: bouncing-ball\nVersion: 1.0\n",
        "bouncing_ball-1.0.dist-info/entry_points.txt": ENTRY_POINTS,
    }.items():
        (site / name).write_text(text)
    monkeypatch.syspath_prepend(str(site))
    yield site
    for name in [name for name in sys.modules if name.partition(".")[0] == "bouncing"]:
        del sys.modules[name]
    importlib.invalidate_caches()
    for remembered in (_tables._table, _tables.digest):
        remembered.cache_clear()


@pytest.fixture
def study(project, installed, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "mine.toml").write_text(STUDY)
    return project.root


def test_a_kind_a_table_and_a_plot_of_another_package_run(study):
    run("mine", jobs=1)
    rows = vines.query("select number, height from bounces order by number").to_pylist()
    assert [row["height"] for row in rows] == [1.0, 0.25, 0.0625, 0.015625]
    (picture,) = study.glob("data/results/*/picture.png")
    assert picture.stat().st_size > 5_000
    assert {plan.state for plan in status("mine")} == {"up_to_date"}


def test_its_code_counts(study, installed):
    run("mine", jobs=1)
    before = {plan.name: plan.key for plan in status("mine")}
    (installed / "bouncing" / "_law.py").write_text(LAW.replace("2 * k", "3 * k"))
    plans = {plan.name: plan for plan in status("mine")}
    assert plans["ball"].state == "stale"
    assert "code changed: bouncing._law" in plans["ball"].reason
    (installed / "bouncing" / "_law.py").write_text(LAW)
    (installed / "bouncing" / "plot.py").write_text(PLOT.replace('"o-"', '"s-"'))
    plans = {plan.name: plan for plan in status("mine")}
    assert (plans["ball"].state, plans["ball"].key) == ("up_to_date", before["ball"])
    assert "code changed: bouncing.plot" in plans["figure"].reason


def test_of_all_plots_only_its_own_counts_in_the_key_of_a_figure(study):
    from vines.pipeline import CodeDigests

    figure = load_pipeline("mine").stages["figure"]
    modules = CodeDigests(None).modules_of_all(figure.kind.bodies(figure.options))
    assert {"bouncing.plot", "vines.figures._sheet", "vines.stages.plots._figure"} <= set(modules)
    assert not [
        name
        for name in modules
        if name.startswith(("vines.stages.plots.", "bouncing.kind")) and not name.rpartition(".")[2].startswith("_")
    ]


def test_they_are_listed_and_described(study, installed):
    assert {
        "name": "bounce",
        "summary": "heights of a bouncing ball",
        "package": "bouncing-ball",
        "tables": ["bounces"],
    } in list_kinds()
    assert {"name": "heights", "summary": "heights of bounces", "package": "bouncing-ball"} in list_plots()
    form = json.loads(declaration_schema())["$defs"]
    assert form["bounce"]["properties"]["times"] == {"type": "integer", "default": 3}
    assert form["figure.heights"]["properties"]["colour"]["default"] == "#222222"
    env = {**os.environ, "PYTHONPATH": str(installed)}
    said = {}
    for command in ("list", "kinds", "kinds bounce", "plots heights", "schema bounces", "rig formats"):
        call = [sys.executable, "-m", "vines.cli", *command.split()]
        done = subprocess.run(call, env=env, cwd=study, capture_output=True, text=True, check=True)
        said[command] = done.stdout
    assert "mine" in said["list"]
    assert "heights of a bouncing ball" in said["kinds"]
    assert "bouncing-ball" in said["kinds"]
    assert "times   integer  3" in said["kinds bounce"]
    assert "colour" in said["plots heights"]
    assert "how high" in said["schema bounces"]
    assert "lines of samples" in said["rig formats"]
    assert "bouncing-ball" in said["rig formats"]


def test_a_recording_of_its_format_is_read_and_ingested(project, installed, monkeypatch, tmp_path):
    folder = tmp_path / "rest"
    settings = RigSettings(run_id="rest", protocol="ringdown", ball=False, E=0.0, duration=4.0, rate=3200.0, form="csv")
    settings = msgspec.structs.replace(settings, start=(0.012, 0.0, 0.0, 0.0), recorders=1, channels=("lo_disp",))
    make_run(folder, settings, 3)
    (raw,) = folder.glob("raw/*")
    before = read_run(folder).recording.channels["lo_disp"]
    (channel,) = read_file(raw).channels
    samples = " ".join(map(repr, channel.values.tolist()))
    raw.write_text(f"LINES\n{channel.name} {channel.unit} {channel.rate!r} {samples}\n")
    assert read_file(raw).form == "lines"  # by its first bytes, whatever its suffix
    assert np.array_equal(read_run(folder).recording.channels["lo_disp"].values, before.values)

    monkeypatch.setenv("VINES_ROOT", str(project.root))
    declared = f'title = "rest"\n[stages.ingest]\nkind = "ingest"\nfolder = "{folder.relative_to(project.root)}"\n'
    (project.root / "pipelines" / "rest.toml").write_text(declared)
    run("rest", jobs=1)
    assert vines.query("select samples from rig_channels").to_pylist() == [{"samples": len(before.values)}]
    (installed / "bouncing" / "format.py").write_text(FORMAT.replace("0.0)", "0.5)"))
    (plan,) = status("rest")
    assert plan.state == "stale"
    assert "code changed: bouncing.format" in plan.reason


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('kind = "bounce"', 'kind = "bouncy"', "unknown kind 'bouncy': did you mean 'bounce'"),
        ("times = 4", "tims = 4", "unknown key 'tims': did you mean 'times'"),
        ('plot = "heights"', 'plot = "height"', "unknown plot 'height': did you mean 'heights'"),
        ('colour = "#c8102e"', "color = 1", "unknown key 'color': did you mean 'colour'"),
        ('needs = ["ball"]', "needs = []", "a figure draws other stages"),
    ],
)
def test_a_mistake_is_one_line(study, old, new, said):
    (study / "pipelines" / "mine.toml").write_text(STUDY.replace(old, new))
    with pytest.raises(DeclarationError, match=said) as found:
        load_pipeline("mine")
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("kind.py", "import nothing_of_that_name", "bouncing-ball .* cannot be loaded: ModuleNotFoundError"),
        ("kind.py", "KIND = 3", "bouncing-ball .* is 3; a Kind of the name 'bounce' is needed"),
        ("plot.py", PLOT.replace('tag="heights"', 'tag="depths"'), "is a Plot 'depths'; a Plot of the name 'heights'"),
        ("schemas/bounces.toml", None, "should bring bounces.toml has no such file"),
    ],
)
def test_a_broken_package_is_one_line(study, installed, file, text, said):
    path = installed / "bouncing" / file
    path.unlink() if text is None else path.write_text(text)
    with pytest.raises(PlugInError, match=said) as found:
        run("mine", jobs=1)
    assert "\n" not in str(found.value)


def test_no_package_takes_a_name_of_vines_and_no_two_the_same(study, installed):
    folder = installed / "other-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(
        "[vines.kinds]\nsweep = other:SWEEP\n[vines.plots]\nheights = other:PLOT\n"
    )
    importlib.invalidate_caches()
    sys.path.insert(0, sys.path.pop(0) + "/")  # another path: looked at again
    assert load_pipeline("quickstart").stages["up"].kind.options.__module__ == "vines.stages.kinds.sweep"
    with pytest.raises(PlugInError, match="'heights' is brought by the packages bouncing-ball and other"):
        load_pipeline("mine")


def test_it_is_gone_where_it_is_not_installed(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    (project.root / "pipelines" / "mine.toml").write_text(STUDY)
    with pytest.raises(DeclarationError, match="unknown kind 'bounce'"):
        load_pipeline("mine")
