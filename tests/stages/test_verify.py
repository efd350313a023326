"""vines verify: a clean store passes; each way of tampering with it is caught by a line that tells where."""

import functools
import hashlib
import json
import shutil

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from vines.stages import verify
from vines.stages.audit._compare import Comparison, compare_rows, compare_within_errors
from vines.store import Store

pytestmark = pytest.mark.long(15)


@pytest.fixture
def data(quickstart, tmp_path, monkeypatch):
    """Give a copy of the results of the quickstart that may be damaged."""
    shutil.copytree(quickstart.data, tmp_path / "data", ignore=shutil.ignore_patterns("points", "cache"))
    monkeypatch.setenv("VINES_DATA", str(tmp_path / "data"))
    return Store(tmp_path / "data")


def result_of(store, stage):
    return store.result(store.pins("quickstart")[stage]["result"])


def rewrite(store, stage, name, change):
    """Change a table and put the new checksum into the manifest, as a careful forger would."""
    result = result_of(store, stage)
    path = result.folder / f"{name}.parquet"
    table = change(pq.read_table(path))
    pq.write_table(table, path)
    seal(result, name, table.num_rows)


def seal(result, name, rows):
    path = result.folder / f"{name}.parquet"
    manifest = dict(result.manifest)
    about = {"sha256": hashlib.sha256(path.read_bytes()).hexdigest(), "bytes": path.stat().st_size}
    manifest["files"] = {**manifest["files"], f"{name}.parquet": about}
    manifest["tables"][name]["rows"] = rows
    (result.folder / "manifest.json").write_text(json.dumps(manifest))


def scaled(column, by, row=5):
    """Return a change of one value of a column; of a list of values, its first."""

    def change(table):
        values = table.column(column).to_pylist()
        if isinstance(values[row], list):
            values[row] = [values[row][0] * by, *values[row][1:]]
        else:
            values[row] *= by
        field = table.schema.field(column)
        return table.set_column(table.schema.names.index(column), field, pa.array(values, field.type))

    return change


def replaced(column, value, row=5):
    def change(table):
        values = table.column(column).to_pylist()
        values[row] = value
        field = table.schema.field(column)
        return table.set_column(table.schema.names.index(column), field, pa.array(values, field.type))

    return change


def both(*changes):
    return lambda table: functools.reduce(lambda made, change: change(made), changes, table)


def other_unit(table):
    i = table.schema.names.index("phase")
    return table.set_column(i, table.schema.field(i).with_metadata({"unit": "deg"}), table.column(i))


def failing(names=("quickstart",), **options):
    found = verify(*names, **options)
    assert not found.good
    return {f"{line.group}: {line.name}": line.first for line in found.lines if line.failed}


def test_a_clean_store_passes_and_rows_come_out_the_same(data):
    found = verify("quickstart", recompute=20, seed=1)
    assert found.good, [line.first for line in found.lines if line.first]
    again = {line.name: line.checked for line in found.lines if line.group == "recomputed"}
    assert sum(again.values()) == 20
    assert set(again) == {"points", "impacts", "attractors", "orbits", "bifurcations"}
    counted = {f"{line.group}: {line.name}": line.checked for line in found.lines}
    assert counted["points: energy balance"] == 185
    assert counted["orbits: multiplier product"] == pq.read_metadata(orbits_of(data)).num_rows
    assert counted["files: point ids"] == 185


def orbits_of(store):
    return result_of(store, "symmetric").folder / "orbits.parquet"


TAMPERED = {
    "r of an orbit": ("symmetric", "orbits", scaled("r", 1.01), ["orbits: declared parameters", "orbits: closure"]),
    "a state": ("symmetric", "orbits", scaled("x1", 1 + 1e-6), ["orbits: closure", "orbits: contact"]),
    "a time": ("symmetric", "orbits", scaled("t", 1 + 1e-6), ["orbits: times", "orbits: closure"]),
    "a multiplier": ("symmetric", "orbits", scaled("multipliers_re", 1.001), ["orbits: multiplier product"]),
    "stability": ("symmetric", "orbits", replaced("stable", False), ["orbits: stability"]),
    "admissibility": ("symmetric", "orbits", replaced("min_clearance", -0.1), ["orbits: admissibility"]),
    "a residual": ("symmetric", "orbits", replaced("residual", 1e-3), ["orbits: residual"]),
    "energies that still balance": (
        "symmetric",
        "orbits",
        both(*(scaled(name, 1.001) for name in ("base_work", "damper_loss", "impact_loss_left", "impact_loss_right"))),
        ["orbits: impact losses", "orbits: measures"],
    ),
    "max|x1| with its reduction": (
        "symmetric",
        "orbits",
        both(scaled("max_abs_x1", 1.001), scaled("reduction", 1.001)),
        ["orbits: largest displacement"],
    ),
    "a word": ("symmetric", "orbits", replaced("word", "LLR"), ["orbits: word"]),
    "a bifurcation": (
        "symmetric",
        "bifurcations",
        both(scaled("value", 1 + 1e-6, 0), scaled("A", 1 + 1e-6, 0)),
        ["bifurcations: closure"],
    ),
    "a branch": ("symmetric", "orbits", replaced("branch_id", "another"), ["orbits: links"]),
    "A of a point": ("up", "points", scaled("A", 1 + 1e-9), ["files: point ids"]),
    "base work": ("up", "points", scaled("base_work", 1 + 1e-6), ["points: energy balance"]),
    "kinetic energies alike": (
        "up",
        "points",
        both(scaled("kinetic_1", 1.001), scaled("kinetic_2", 1.001)),
        ["impacts: measures of points"],
    ),
    "the yardstick": ("up", "points", scaled("x1_no_ball", 1.001), ["points: yardsticks"]),
    "a regime": ("up", "points", replaced("regime", "lively"), ["files: values"]),
    "a missing measure": ("up", "points", replaced("max_abs_x1", None), ["points: measures"]),
    "a point left out": ("up", "points", lambda table: table.slice(1), ["files: provenance", "impacts: links"]),
    "a speed after impact": (
        "up",
        "impacts",
        scaled("v2_after", 1 + 1e-6),
        ["impacts: momentum", "impacts: impact law"],
    ),
    "an impact that keeps the law": (
        "up",
        "impacts",
        lambda table: slowed(table, 7),
        ["impacts: next impact", "impacts: repetition"],
    ),
    "a gap": ("up", "impacts", scaled("x2", 1 + 1e-6), ["impacts: contact"]),
    "a unit": ("up", "impacts", other_unit, ["files: schemas"]),
    "a verdict": ("checks", "checks", replaced("verdict", "differs", 5), ["checks: verdict"]),
}


def slowed(table, row):
    """Change the speeds of an impact so that law and momentum still hold."""
    one = table.slice(row, 1).to_pylist()[0]
    v1, v2, mu, r = one["v1"] * (1 + 1e-6), one["v2"], one["mu"], one["r"]
    values = {
        "v1": v1,
        "w_dot": v1 - v2,
        "v1_after": ((1 - r * mu) * v1 + mu * (1 + r) * v2) / (1 + mu),
        "v2_after": ((1 + r) * v1 + (mu - r) * v2) / (1 + mu),
    }
    return both(*(replaced(name, value, row) for name, value in values.items()))(table)


@pytest.mark.parametrize("case", TAMPERED)
def test_a_changed_value_with_a_new_checksum_is_caught(data, case):
    stage, name, change, expected = TAMPERED[case]
    rewrite(data, stage, name, change)
    found = failing()
    assert set(expected) <= set(found), found
    assert "files: checksums" not in found
    assert found[expected[0]].startswith(f"quickstart.{stage}")


def test_the_line_names_the_row(data):
    rewrite(data, "symmetric", "orbits", scaled("x1", 1.001, 17))
    text = failing()["orbits: closure"]
    assert "orbits row 17 (mu = 0.01, A = 0.0" in text
    assert "allowed 1e-09" in text


def test_a_flipped_byte_and_a_strange_file(data):
    result = result_of(data, "up")
    path = result.folder / "points.parquet"
    raw = bytearray(path.read_bytes())
    raw[200] ^= 1
    path.write_bytes(bytes(raw))
    (result.folder / "notes.txt").write_text("mine")
    found = failing()
    assert "points.parquet is damaged" in found["files: checksums"]
    path.write_bytes(b"not a table")
    assert "points cannot be read" in failing()["files: schemas"]
    path.unlink()
    assert "points.parquet is missing" in failing()["files: checksums"]


def test_another_origin_is_caught_even_where_file_and_manifest_agree(data):
    result = result_of(data, "symmetric")
    text = (result.folder / "manifest.json").read_text()
    for name in result.tables:
        table = pq.read_table(result.folder / f"{name}.parquet")
        about = json.loads(table.schema.metadata[b"vines"])
        about["provenance"]["params"]["mu"] = 0.0101
        pq.write_table(table.replace_schema_metadata({"vines": json.dumps(about)}), result.folder / f"{name}.parquet")
    manifest = json.loads(text)
    for part in ("ingredients", "provenance"):
        manifest[part]["params"]["mu"] = 0.0101
    del manifest["check"]
    (result.folder / "manifest.json").write_text(json.dumps(manifest))
    for name in result.tables:
        seal(result_of(data, "symmetric"), name, manifest["tables"][name]["rows"])
    found = failing()
    assert "the provenance belongs to another key" in found["files: provenance"]
    assert "quickstart.symmetric: orbits row 0" in found["orbits: declared parameters"]


def test_a_pin_without_a_result_and_a_broken_manifest(data):
    shutil.rmtree(result_of(data, "figure").folder)
    (result_of(data, "checks").folder / "manifest.json").write_text("{")
    found = failing()
    assert "quickstart.figure" in found["files: pins"]
    assert "cannot be read" in found["files: manifests"]


def test_recomputing_finds_what_no_balance_can(data):
    rewrite(data, "up", "points", lambda table: all_scaled(table, "lyapunov", 1.0001))
    assert verify("quickstart").good
    text = failing(recompute=10)["recomputed: points"]
    assert "lyapunov is stored as" in text
    assert "comes out as" in text


def all_scaled(table, column, by):
    i = table.schema.names.index(column)
    return table.set_column(i, table.schema.field(i), pc.multiply(table.column(i), by))


def test_the_draw_follows_the_seed(data):
    first, second = (verify("quickstart", recompute=5, seed=3).lines for _ in range(2))
    assert first == second


def test_a_row_that_nothing_can_be_compared_with_is_passed_over(data):
    data.unpin("quickstart", set(data.pins("quickstart")) - set(RUNS))  # few rows, so that each of them is drawn
    rewrite(data, "doubled_run", "points", lambda table: failed(table))
    (line,) = [
        each
        for each in verify("quickstart", recompute=20).lines
        if each.name == "points" and each.group == "recomputed"
    ]
    assert line.good
    assert (line.checked, line.skipped) == (len(RUNS) - 1, 1)


RUNS = ("symmetric_run", "asymmetric_run", "doubled_run", "two_one_run")


def failed(table):
    i = table.schema.names.index("status")
    return table.set_column(i, table.schema.field(i), pa.array(["failed"] * table.num_rows))


def test_chaotic_rows_are_compared_within_four_standard_errors():
    given = ("mu", "A", "Omega", "r", "lam", "x1", "v1", "x2", "v2", "phase")
    stored = dict.fromkeys(given, 0.1)
    stored |= {"regime": "chaotic", "settled": True, "status": "ok"}
    for name in ("kinetic_ratio", "max_abs_x1", "rms_x1", "lyapunov"):
        stored |= {name: 1.0, f"{name}_error": 0.01}
    for off, good in ((0.056, True), (0.057, False)):
        comparison = Comparison()
        compare_within_errors(comparison, stored, {**stored, "rms_x1": 1.0 + off}, names=given)
        assert (comparison.wrong == "") is good


def test_phases_are_compared_around_the_circle():
    comparison = Comparison()
    compare_rows(comparison, "impacts", {"phase": 1e-12}, {"phase": 2 * np.pi - 1e-12})
    assert comparison.wrong == ""


def test_the_command_says_what_is_wrong_and_exits_with_one(quickstart, data, monkeypatch):
    monkeypatch.setenv("VINES_DATA", str(data.data))
    assert "all hold" in quickstart.vines("verify", "quickstart").stdout
    rewrite(data, "up", "points", scaled("base_work", 2.0))
    done = quickstart.vines("verify", check=False)
    assert done.returncode == 1
    assert "FAIL  points" in done.stdout
    assert "points row 5 (mu = 0.01, A = 0.01525" in done.stderr
    told = json.loads(quickstart.vines("verify", "--json", check=False).stdout)
    assert "energy balance" in [line["name"] for line in told["checks"] if not line["good"]]
    wrong = quickstart.vines("verify", "quikstart", check=False)
    assert (wrong.returncode, wrong.stderr.count("\n")) == (2, 1)
    assert "did you mean 'quickstart'" in wrong.stderr
