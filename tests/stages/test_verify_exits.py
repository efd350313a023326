"""vines verify on runs with noise: what they add up to, and one point of each result computed again bit for bit."""

import hashlib
import json

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import vines
from vines.model import counted
from vines.pipeline import kinds
from vines.stages import register_kinds, verify
from vines.stages.audit._compare import Comparison
from vines.stages.audit._exits import compare_exits
from vines.stages.audit._physics import checks

EXITS = """
[params]
mu = 0.05
Omega = 1.17
[stages.held]
kind = "exits"
params.A = 0.1
scatter = { noise = 0.2, seed = 1 }
words = ["LR"]
vary.level = [1.0, 2.0]
runs = 4
periods = 400
random = 2
[stages.pair]
kind = "exits"
system = "impact_pair"
params = { B = 0.5, r = 0.5 }
scatter = { sigma_r = 0.05 }
runs = 2
periods = 20
random = 2
[stages.si]
kind = "dimensionless"
params = { omega = 55.0, m = 0.04 }
vary.E = [1e-4, 2e-4]
[stages.gone]
kind = "transient"
periods = 5
vary.V = [1.5]
"""


@pytest.fixture
def held(tmp_path):
    (tmp_path / "pipelines").mkdir()
    (tmp_path / "pipelines" / "held.toml").write_text(EXITS)
    study = vines.study(tmp_path)
    study.run("held")
    return study


def forged(study, stage, name, column, row, value):
    """Change a value and put the new checksum into the manifest."""
    result = study.store.result(study.store.pins("held")[stage]["result"])
    path = result.folder / f"{name}.parquet"
    made = pq.read_table(path)
    values, field = made.column(column).to_pylist(), made.schema.field(column)
    values[row] = value(values[row])
    pq.write_table(made.set_column(made.schema.names.index(column), field, pa.array(values, field.type)), path)
    manifest = dict(result.manifest)
    raw = path.read_bytes()
    manifest["files"][path.name] = {"sha256": hashlib.sha256(raw).hexdigest(), "bytes": len(raw)}
    (result.folder / "manifest.json").write_text(json.dumps(manifest))


def lines(study, **options):
    return {f"{line.group}: {line.name}": line for line in verify("held", study=study, **options).lines}


def test_a_point_of_each_result_comes_out_the_same_and_a_changed_run_is_found(held):
    found = lines(held, recompute=40, seed=2)
    assert all(line.good for line in found.values()), [line.first for line in found.values() if line.first]
    again = {name.removeprefix("recomputed: ") for name in found if name.startswith("recomputed")}
    made = {"exit_points", "exit_regimes", "exits"}
    assert again == made | {f"impact_pair_{name}" for name in made} | {
        "attractors", "impact_pair_attractors", "dimensionless", "transients",
    }  # fmt: skip
    assert found["recomputed: exit_points"].checked == 1
    assert found["recomputed: exits"].largest == 0.0
    assert found["exit_regimes: interval"].checked == 4

    for row in (4, 12):  # one of each point, whichever is drawn
        forged(held, "held", "exits", "excursions", row, lambda value: value + 1)
    found = lines(held, recompute=200, seed=3)
    assert [name for name, line in found.items() if not line.good] == ["recomputed: exits"]
    assert "excursions is stored as" in found["recomputed: exits"].first
    forged(held, "held", "exits", "T_exit", 4, lambda value: value + 1)
    assert "what its runs add up to" in lines(held)["exit_regimes: counts"].first
    forged(held, "held", "exit_regimes", "mean_low", 1, lambda value: 0.9 * value)
    assert lines(held)["exit_regimes: interval"].failed == 1
    forged(held, "si", "dimensionless", "lam", 1, lambda value: 1.001 * value)
    assert lines(held)["dimensionless: c"].failed == 1


def test_irregular_regimes_are_compared_as_samples():
    regimes = [{"attractor": 0, "regime": "chaotic"}, {"attractor": 1, "regime": "periodic"}]
    told = [{"attractor": k, "exits": 20, "watched": 1000.0, "runs": 20} for k in (0, 1)]

    runs = [{"attractor": k, "T_exit": 50.0 + j, "censored": False} for k in (0, 1) for j in range(20)]

    def differs(parted=20, **changes):
        other = [{**row, **(changes.get(f"of_{row['attractor']}") or {})} for row in told]
        others = [{**row, "T_exit": 80.0 - row["T_exit"]} if j < parted else row for j, row in enumerate(runs)]
        tables = ({"attractors": regimes, "exit_regimes": a, "exits": b} for a, b in ((told, runs), (other, others)))
        comparison = Comparison()
        compare_exits(comparison, "exit_regimes", *tables)
        return comparison.wrong

    assert differs() == ""
    assert "exits is stored as 20" in differs(parted=1, of_0={"exits": 21})
    assert differs(of_0={"exits": 25, "watched": 1100.0}) == ""
    assert "logarithm of the rate" in differs(of_0={"exits": 60, "watched": 1000.0})
    assert "exits is stored as 20" in differs(of_1={"exits": 21})


NOT_AGAIN = {
    "check": "its rows are those of other stages",
    "compare": "a run folder is read, no row",
    "curve": "its rows hold no start state",
    "figure": "it has no table",
    "ingest": "a run folder is read, no row",
    "reconstruct": "a run folder is read, no row",
    "report": "it has no table",
    "synth": "its rows name folders",
}


def test_no_kind_is_left_out_of_what_is_computed_again():
    register_kinds()
    for name, kind in kinds().items():
        if kind.body.startswith("vines."):
            can = bool(kind.again) or bool({"orbits", "bifurcations"} & set(kind.tables))
            assert can != (name in NOT_AGAIN), name


UNCHECKED = {
    "rig_budgets": "shares of an uncertainty, made with the row of reconstructions",
    "rig_channels": "what a run folder states",
    "rig_made": "what was asked for",
    "rig_runs": "what a run folder states",
}


def test_no_table_is_left_out_of_what_is_checked():
    register_kinds()
    written = {name for kind in kinds().values() if kind.body.startswith("vines.") for name in kind.tables}
    for kind in list(kinds().values()):
        for system in kind.systems:
            written |= set(kind.of_system(system, counted(system)[1]).tables)
    assert {name for name in written if not checks(name)} == set(UNCHECKED)
