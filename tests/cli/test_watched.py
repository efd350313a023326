"""A run that is watched: motions are shown as they are computed, and a viewer that goes away stops nothing."""

from types import SimpleNamespace

import pytest

from tests.project import Project
from vines.cli._watched import Watched
from vines.dynamics import simulate
from vines.errors import ViewerError
from vines.logs import write_run
from vines.model import Params
from vines.pipeline import Event

STUDY = """
title = "two motions"
params = { mu = 0.01 }
[stages.motion]
kind = "trajectory"
vary.A = [0.015, 0.016]
settle = 10
record = 2
per_period = 20
[stages.symmetric]
kind = "branch"
word = "LR"
vary.A = { from = 0.015, to = 0.0155 }
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "pipelines").mkdir()
    (tmp_path / "pipelines" / "two.toml").write_text(STUDY)
    return Project(tmp_path)


def test_each_motion_is_shown_and_kept(study):
    done = study.vines("run", "two", "motion", "--watch", "--save", study.root / "seen.rrd")
    assert "motion: done, 2 points" in done.stdout
    seen = [study.root / name for name in ("seen.rrd", "seen_2.rrd")]
    assert all(path.stat().st_size > 20_000 for path in seen)
    assert b"motion: " in seen[0].read_bytes()
    assert "nothing to watch" in study.vines("run", "two", "motion", "--watch").stdout
    assert "no motion was computed" in study.vines("run", "two", "symmetric", "--watch", "--save", seen[0]).stdout


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["--web"], "--web says where --watch shows motions; give --watch too"),
        (["--watch", "--dry-run"], "--watch shows what is computed, and --dry-run computes nothing"),
        (["--watch", "--web", "--save", "a.rrd"], "--web and --save exclude each other"),
        (["--watch", "--save", "a.png"], "--save a.png: a recording ends in .rrd, such as a.rrd"),
    ],
)
def test_options_that_do_not_fit_are_a_line(study, given, told):
    done = study.vines("run", "two", *given, check=False)
    assert done.returncode == 2
    assert told in done.stderr
    assert not study.data.exists()


def test_a_viewer_that_is_gone_does_not_stop_the_run(tmp_path):
    run = simulate(Params(mu=0.01, A=0.02), periods=2)
    log = write_run(
        tmp_path / "a.mcap",
        states=run.sample(per_period=20),
        impacts=run.impacts,
        sticks=run.sticks,
        provenance={},
        parameters=run.params.as_dict(),
        name="1:1",
    )
    said, shown = [], []
    show = SimpleNamespace(alive=True, show=shown.append)
    watched = Watched(show, said.append)
    event = Event("progress", "motion", 1, 1, logs=(log,))
    watched(event)
    assert [each.name for each in shown] == ["motion: 1:1"]
    show.alive = False
    watched(event)
    watched(event)
    watched.stay(wait=True)
    assert (len(shown), said) == (1, ["the viewer was closed; the run goes on without it"])

    def broken(log):
        raise ViewerError("the connection is lost")

    said.clear()
    watched = Watched(SimpleNamespace(alive=True, show=broken), said.append)
    watched(event)
    watched.stay(wait=True)
    assert said == ["the connection is lost; the run goes on without it"]


def test_more_runs_than_fit_beside_each_other_are_refused(study):
    text = (study.root / "pipelines" / "two.toml").read_text()
    nine = text.replace("[0.015, 0.016]", str([0.015 + k / 1e4 for k in range(9)]))
    (study.root / "pipelines" / "two.toml").write_text(nine)
    said = study.vines("run", "two", "motion").stdout
    (shown,) = [line.split()[2] for line in said.splitlines() if line.startswith("  vines view")]
    assert shown.startswith("two.motion/")
    done = study.vines("view", "two.motion", "--save", study.root / "a.rrd", check=False)
    assert done.returncode == 2
    assert "two.motion has 9 logs, and 8 fit beside each other; name points, such as two.motion/" in done.stderr
    assert "wrote" in study.vines("view", shown, "--save", study.root / "a.rrd").stdout
