"""Declarations that include another, that are made in Python, and the schema of their form."""

import json

import pytest

from vines.errors import DeclarationError, FileMissingError
from vines.pipeline import Declaration, Journal, json_schema, load, mermaid, plan, run_pipeline, silent, span
from vines.store import versions

TEXT = """
    title = "toys"
    [params]
    mu = 0.2
    [stages.up]
    kind = "toy"
    gain = 2
    vary.A = { from = 0.1, to = 0.5, count = 5 }
    carry = { axis = "A", direction = "down" }
    refine = { on = ["end_x1"], tolerance = 0.05, jump = 0.5 }
    [stages.pair]
    kind = "toy"
    vary.A = [0.1, 0.3]
    vary.mu = [1, 2]
    zip = ["A", "mu"]
    [stages.total]
    kind = "total"
    needs = ["up", "pair"]
"""


def python():
    made = Declaration("toys", title="toys", params={"mu": 0.2})
    made.stage(
        "up",
        "toy",
        gain=2,
        vary={"A": span(0.1, 0.5, 5)},
        carry={"axis": "A", "direction": "down"},
        refine={"on": ("end_x1",), "tolerance": 0.05, "jump": 0.5},
    )
    made.stage("pair", "toy", vary={"A": (0.1, 0.3), "mu": [1, 2]}, zip=("A", "mu"))
    made.stage("total", "total", needs=("up", "pair"))
    return made


def test_a_declaration_in_python_gives_the_same_keys(lab):
    lab.run(lab.declare(TEXT), jobs=1)
    pipeline = python().load(root=lab.folder)
    assert {each.state for each in plan(pipeline, lab.store)} == {"up_to_date"}
    assert run_pipeline(pipeline, lab.store, jobs=1).new == 0
    changed = python().load({"stages.up.gain": 3}, root=lab.folder)
    assert plan(changed, lab.store)[0].reason.startswith("gain 2 → 3")


def test_mistakes_in_python_are_one_line(lab):
    made = python()
    with pytest.raises(DeclarationError, match=r"stages\.up is declared twice"):
        made.stage("up", "toy")
    made.stage("more", "toi")
    with pytest.raises(DeclarationError, match=r"<toys>: stages\.more\.kind: unknown kind 'toi': did you mean 'toy'"):
        made.load(root=lab.folder)


def test_a_file_is_laid_over_the_one_it_includes(lab):
    (lab.folder / "pipelines" / "common").mkdir(parents=True)
    lab.declare(TEXT, "common/runs")
    over = 'include = "common/runs.toml"\n[stages.up]\ngain = 5\nvary.A = [0.4]\n[stages.up.params]\nmu = 1\n'
    path = lab.declare(over.replace("[0.4]", "[0.4, 0.5]"))
    up = load(path, root=lab.folder).stages["up"]
    assert (up.options.gain, up.params["mu"], up.axes[0].values()) == (5.0, 1.0, (0.4, 0.5))
    assert list(load(path, root=lab.folder).stages) == ["up", "pair", "total"]
    path = lab.declare('include = "common/gone.toml"')
    with pytest.raises(FileMissingError, match="include: there is no file"):
        load(path, root=lab.folder)
    lab.declare('include = "other.toml"', "common/runs")
    with pytest.raises(DeclarationError, match="an included file cannot include another"):
        load(lab.declare('include = "common/runs.toml"'), root=lab.folder)
    with pytest.raises(DeclarationError, match="include is 3; name one file"):
        load(lab.declare("include = 3"), root=lab.folder)


def test_the_schema_knows_every_key_that_is_read(lab):
    form = json_schema()
    toy = form["$defs"]["toy"]["properties"]
    assert set(toy) >= {"kind", "params", "vary", "zip", "refine", "carry", "gain", "steps"}
    assert toy["gain"] == {"type": "number", "default": 1.0}
    assert "needs" in form["$defs"]["total"]["properties"]
    assert "vary" not in form["$defs"]["total"]["properties"]
    assert json.dumps(form)


def test_the_graph_shows_stages_needs_and_starts(lab):
    text = TEXT.replace('"down" }', '"down", start = { from = "pair", at = { A = 0.1, mu = 1 } } }')
    pipeline = load(lab.declare(text), root=lab.folder)
    drawn = mermaid(pipeline, {each.name: each for each in plan(pipeline, lab.store)})
    assert drawn.startswith("flowchart LR\n")
    assert "    stage_up --> stage_total" in drawn
    assert '    stage_pair -. "A = 0.1, mu = 1" .-> stage_up' in drawn
    assert "<b>up</b><br/>toy<br/>0/5 points<br/>never" in drawn


def test_a_run_leaves_a_log_file_that_names_failures(lab):
    declared = lab.declare(TEXT.replace("gain = 2", "gain = 2\n    bad = [0.3]"))
    with Journal(lab.store.logs, "toys", {"jobs": 1, "force": False}, silent) as journal:
        run_pipeline(load(declared, root=lab.folder), lab.store, jobs=1, report=journal)
    (path,) = lab.store.logs.glob("*-toys-*.log")
    text = path.read_text()
    assert text.startswith("run toys jobs=1\n")
    assert f"numpy {versions()['numpy']}" in text
    assert "ValueError: A = 0.3 is bad" in text
    assert text.endswith(" done\n")
    with Journal(lab.store.logs, "toys", {}, silent) as journal:
        run_pipeline(load(declared, root=lab.folder), lab.store, jobs=1, report=journal)
    assert journal.path is None
    assert len(list(lab.store.logs.iterdir())) == 1


def test_status_says_when_results_come_from_other_versions(lab):
    declared = lab.declare(TEXT)
    lab.run(declared, jobs=1)
    pins = lab.store.pins("toys")
    assert pins["up"]["versions"] == versions()
    lab.store.pin("toys", "up", {**pins["up"], "versions": {**versions(), "numpy": "1.0"}})
    up = {each.name: each for each in plan(load(declared, root=lab.folder), lab.store)}["up"]
    assert (up.state, up.versions) == ("up_to_date", f"numpy 1.0 then, now {versions()['numpy']}")
