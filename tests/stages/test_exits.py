"""The kind `exits` from declaration to tables and figure, and in shards."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vines
from vines.errors import DeclarationError, ParameterError
from vines.model import system_names
from vines.stages import estimate, run
from vines.stages.plots.exits import ExitsCell, _panel

EXITS = """
title = "exits"
[params]
mu = 0.05
A = 0.1
Omega = 1.17
[stages.held]
kind = "exits"
scatter = { noise = 0.2, seed = 1 }
words = ["LR"]
vary.level = [1.0, 2.0]
runs = 3
periods = 500
random = 4
[stages.figure]
kind = "figure"
plot = "exits"
needs = ["held"]
[[stages.figure.cells]]
show = "survival"
of = "held"
[[stages.figure.cells]]
show = "mean"
of = "held"
[[stages.figure.cells]]
show = "shares"
of = "held"
"""


@pytest.fixture
def exits(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))

    def declare(text):
        (project.root / "pipelines" / "held.toml").write_text(text)
        return project

    return declare


def _rows(name):
    return vines.query(f"select * from {name} order by all").to_pylist()


def test_tables_tell_of_runs_and_regimes_and_shards_agree_bit_for_bit(exits, monkeypatch, tmp_path):
    exits(EXITS)
    assert estimate("held") == {}  # a point of it takes longer than anybody waits for an estimate
    run("held")
    runs = vines.query("select * from exits order by level, attractor, seed").to_pylist()
    assert len(runs) == 2 * 2 * 3
    regimes = vines.query("select * from exit_regimes where name = '1:1' order by level").to_pylist()
    for row in regimes:
        own = [each for each in runs if each["point_id"] == row["point_id"] and each["attractor"] == row["attractor"]]
        assert row["exits"] == sum(not each["censored"] for each in own)
        assert row["watched"] == sum(each["T_exit"] for each in own)
        assert row["mean"] == row["watched"] / row["exits"]
        assert row["to"] == [0]
        assert row["to_share"] == [1.0]
        assert row["relaxation"] == pytest.approx(-1 / np.log(0.9974164), rel=1e-3)
        assert row["long_run_low"] <= row["long_run"] <= row["long_run_high"]
    assert regimes[0]["mean_low"] < regimes[0]["mean"] < regimes[0]["mean_high"]
    points = vines.query("select * from exit_points order by level").to_pylist()
    assert {row["most_started_name"] for row in points} == {"chaotic"}
    assert {row["status"] for row in points} == {"ok"}
    shares = vines.query("select point_id, sum(long_run) from exit_regimes group by all").to_pylist()
    assert all(row["sum(long_run)"] == pytest.approx(1.0) for row in shares)
    whole = {name: _rows(name) for name in ("exits", "exit_regimes", "exit_points", "attractors")}
    monkeypatch.setenv("VINES_DATA", str(tmp_path / "shards"))
    for k in (2, 1):
        run("held", stages=["held"], jobs=1, shard=f"{k}/2")
    run("held", stages=["held"], merge=True)
    assert {name: _rows(name) for name in whole} == whole


def test_a_splitting_without_a_mean_is_not_drawn():
    told = {"name": "1:1", "regime": "periodic", "attractor": 0, "mean_low": 90.0, "mean_high": 120.0}
    rows = [
        {**told, "A": 0.1, "point_id": "a", "method": "runs", "mean": 100.0, "remark": None},
        {**told, "A": 0.1, "point_id": "a", "method": "splitting", "mean": 101.0, "remark": None},
        {**told, "A": 0.2, "point_id": "b", "method": "runs", "mean": None, "mean_high": None, "remark": None},
        {
            **told,
            "A": 0.2,
            "point_id": "b",
            "method": "splitting",
            "mean": None,
            "mean_low": None,
            "mean_high": None,
            "remark": "no",
        },
    ]
    stage: Any = SimpleNamespace(
        tables=("exit_regimes",), axes={"A": None}, table=lambda _name: SimpleNamespace(to_pylist=lambda: rows)
    )
    drawn: Any = _panel(ExitsCell(show="mean", of="one"), stage)
    runs, rare = drawn.curves
    assert runs.x.tolist() == [0.1, 0.2]
    assert (rare.label, rare.x.tolist()) == ("1:1, by splitting", [0.1])


@pytest.mark.parametrize("system", [name for name in system_names() if name not in ("vi_nes", "impact_pair")])
def test_systems_without_scatter_are_refused_before_any_work(exits, system):
    exits(EXITS.replace('kind = "exits"', f'kind = "exits"\nsystem = "{system}"'))
    with pytest.raises(DeclarationError, match=f"{system}.*scatter; it can do impact_pair, vi_nes") as caught:
        run("held")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "error", "text"),
    [
        (
            ('kind = "exits"', 'kind = "exits"\nsystem = "parallel"\nparams = { mu = [0.01] }'),
            DeclarationError,
            "its kernels have no scatter",
        ),
        (("noise = 0.2", "nois = 0.2"), DeclarationError, "scatter: unknown key 'nois': did you mean 'noise'"),
        (("[1.0, 2.0]", "[-1.0]"), ParameterError, "level is -1, allowed is level >= 0"),
        (("periods = 500", "periods = 500\nwait = 500"), DeclarationError, "allowed is wait < periods, which is 500"),
        (("noise = 0.2", "spread = { B = 0.1 }"), DeclarationError, "scatter.spread: unknown parameter 'B'"),
        (
            ("noise = 0.2", "hold = 4, ou = { sigma = 1.0, correlation_time = 1.0 }"),
            ParameterError,
            "allowed is hold >= 22",
        ),
        (("periods = 500", "periods = 500\nsplitting = 8"), ParameterError, "allowed is splitting >= 16"),
        (
            ("noise = 0.2", "phase_diffusion = 0.1 }\nsplitting = 64 #"),
            ParameterError,
            "phase_diffusion, which splitting cannot do",
        ),
        (('show = "mean"\nof = "held"', 'show = "mean"\nof = "up"'), DeclarationError, "'up' is not needed"),
    ],
)
def test_what_cannot_be_is_refused_when_it_is_read(exits, change, error, text):
    exits(EXITS.replace(*change))
    with pytest.raises(error, match=text) as caught:
        run("held")
    assert "\n" not in str(caught.value)
