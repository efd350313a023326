"""Mistakes of a first day: each is one line that says what is wrong, the value, what is allowed, and what to do."""

import json
import sys

import pytest

import vines

PIPELINE = """
title = "a test"
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = { from = 0.015, to = 0.016, count = 3 }
carry = "A"
settle = 10
record = 4
[stages.picture]
kind = "figure"
plot = "bifurcation"
needs = ["up"]
"""
DOWN = """
[stages.down]
kind = "sweep"
vary.A = { from = 0.016, to = 0.015, count = 3 }
settle = 10
record = 4
"""
BASINS = """
[stages.basins]
kind = "basins"
params.A = 0.016
x = { name = "x1", from = -1, to = 1 }
"""


@pytest.fixture
def refused(project):
    """Return a function that calls the command line and gives the one line that it refuses with."""

    def call(*arguments):
        done = project.vines(*arguments, check=False)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
        assert "Decimal" not in done.stderr
        return done.stderr.strip()

    return call


@pytest.fixture
def mine(project):
    """Return the file of the pipeline mine."""
    return project.root / "pipelines" / "mine.toml"


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"bifurcation"', '"bifurcations"', "did you mean 'bifurcation'? Allowed: basins, best, bifurcation, chart"),
        ("settle = 10", "settle = 50.0", "stages.up.settle is 50.0; allowed is a whole number, such as 50"),
        ("settle = 10", "settle = 3.5", "stages.up.settle is 3.5; allowed is a whole number"),
        ("settle = 10", "settle = true", "stages.up.settle is true; allowed is a whole number"),
        ("settle = 10", "settle = 10\nwatch = -1", "stages.up.watch is -1, allowed is watch >= 16"),
        ("mu = 0.01", "mu = [0.01, 0.02]", "to vary it, use vary.mu = [0.01, 0.02] in a stage"),
        ("mu = 0.01", "mu = { from = 0.01, to = 0.02 }", "vary.mu = { from = 0.01, to = 0.02 } in a stage"),
        ("settle = 10", "settle = 10\nparams.mu = [0.01, 0.02]", "stages.up.params.mu is a list"),
        ("mu = 0.01", "mu = 0.01\nM = 1.5", "M is a quantity in SI units; give it as physical.M"),
        ("settle = 10", "settle = 10\nparams.M = 1.5", "give it as stages.up.physical.M"),
        ("count = 3", "count = 1", "vary.A.count is 1, from 0.015 to 0.016, which cannot be; a count of 2 or more"),
        ("count = 3", "count = 1", "to take 0.015 alone write vary.A = [0.015]"),
        ("count = 3", "count = 3.0", "vary.A.count is 3.0; allowed is a whole number"),
        ("{ from = 0.015, to = 0.016, count = 3 }", "0.5", "vary.A is 0.5; write { from"),
        ("{ from = 0.015, to = 0.016, count = 3 }", "[[0.5]]", "vary.A[0] is [0.5], which is not a number"),
        (
            "record = 4",
            f'record = 4{DOWN}carry = {{ axis = "A", start = {{ from = "up", at = {{ A = 0.0157 }} }} }}',
            "at is { A = 0.0157 }, no point of stage 'up'; nearest: { A = 0.0155 } and { A = 0.016 }",
        ),
        (
            "record = 4",
            f'record = 4{DOWN}carry = {{ axis = "A", start = {{ from = "up", at = {{ A = 1 }} }} }}',
            "at is { A = 1.0 }, no point of stage 'up'; nearest: { A = 0.016 }",
        ),
        (
            "record = 4",
            f'record = 4{DOWN}carry = {{ axis = "A", start = {{ from = "up" }} }}',
            "at is {}, no point of stage 'up', which varies A; name one value of each",
        ),
        ("record = 4", f'record = 4{DOWN}needs = ["up"]', "stages.down.needs is ['up']; the kind 'sweep' takes no"),
        ("record = 4", f"record = 4{BASINS}", "stages.basins: 'y' is missing; needed: x, y"),
        (
            "record = 4",
            f'record = 4{BASINS}y = {{ name = "v1", from = -1 }}',
            "stages.basins.y: 'to' is missing; needed: name, from, to",
        ),
    ],
)
def test_a_declaration(mine, refused, old, new, says):
    assert old in PIPELINE
    mine.write_text(PIPELINE.replace(old, new, 1))
    assert says in refused("run", "mine", "--dry-run")


@pytest.mark.parametrize(
    ("encoding", "says"),
    [
        ("latin-1", "is not UTF-8 (byte 0xf6 in line 2); TOML is UTF-8: save it as UTF-8"),
        ("utf-16", "is UTF-16; TOML is UTF-8: save it as UTF-8"),
        ("utf-16-le", "is UTF-16; TOML is UTF-8: save it as UTF-8"),
    ],
)
def test_a_file_in_another_encoding(mine, refused, encoding, says):
    mine.write_bytes(PIPELINE.replace("a test", "Größe" if encoding == "latin-1" else "a test").encode(encoding))
    assert says in refused("status", "mine")


def test_a_byte_order_mark_is_no_mistake(mine, project):
    mine.write_text(PIPELINE, "utf-8-sig")
    assert "never finished" in project.vines("status", "mine").stdout


@pytest.mark.parametrize(
    ("sql", "says"),
    [
        (
            "select kinetic_ration from points",
            "no column 'kinetic_ration': nearest: kinetic_ratio, kinetic_ratio_error",
        ),
        ("select p.nam from points p", "no column 'nam': nearest: name, "),
        ("select zzz from points", "no column 'zzz': 'vines schema TABLE' lists the columns"),
    ],
)
def test_an_unknown_column(refused, sql, says):
    line = refused("query", sql)
    assert says in line
    assert len(line) < 200


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("check", "mine"), "mine has no stage of kind 'check', so there is nothing to compare"),
        (("check", "quickstart"), "nothing has been checked for quickstart; run 'vines run quickstart' first"),
        (("--root", "/nonexist", "list"), "--root is '/nonexist', which is not a folder; name an existing one"),
        (("view", "mine.up", "--png", "a.pdf"), "--png a.pdf: a picture ends in .png, such as a.png"),
        (("view", "mine.up", "--save", "a.mcap"), "--save a.mcap: a recording ends in .rrd, such as a.rrd"),
        (("solve", "LR", "--A", "0.02"), "Missing option '--mu'. Usage: vines solve [OPTIONS] WORD"),
        (("status", "mine", "quickstrat"), "did you mean 'quickstart'"),
    ],
)
def test_a_command(mine, refused, arguments, says):
    mine.write_text(PIPELINE)
    assert says in refused(*arguments)


@pytest.mark.parametrize(("word", "mu", "says"), [("LR", "-1", "1e-12 <= mu"), ("LX", "0.01", "'LX' is not a word")])
def test_solve_checks_before_the_compiler_is_loaded(monkeypatch, refused, word, mu, says):
    monkeypatch.setitem(sys.modules, "vines.orbits", None)  # its import would fail
    assert says in refused("solve", word, "--mu", mu, "--A", "0.02")


def test_an_empty_table_says_so(project):
    with pytest.warns(UserWarning, match=f"no result in {project.data} has rows of 'points' yet; 'vines run NAME'"):
        assert vines.study(project.root).table("points").num_rows == 0


def test_several_pipelines_have_a_status_line_each(mine, project):
    mine.write_text(PIPELINE)
    _, *rows = project.vines("status", "mine", "quickstart").stdout.splitlines()
    assert [row.split()[0] for row in rows] == ["mine", "quickstart"]
    assert list(json.loads(project.vines("status", "mine", "quickstart", "--json").stdout)) == ["mine", "quickstart"]


def test_a_run_and_its_plan_are_told_to_machines(mine, project):
    mine.write_text(PIPELINE.partition("[stages.picture]")[0])
    (planned,) = json.loads(project.vines("run", "mine", "--dry-run", "--json").stdout)["mine"]
    assert (planned["name"], planned["would_compute"], planned["done"]) == ("up", 3, 0)
    assert planned["seconds"] >= 0
    for _ in range(2):
        (ended,) = json.loads(project.vines("run", "mine", "--json").stdout)["mine"]
        assert (ended["state"], ended["done"], ended["failed"]) == ("up_to_date", 3, 0)
    asked = "vines query \"select A, name, reduction from points where pipeline = 'mine' order by A\""
    assert asked in project.vines("run", "mine").stdout
