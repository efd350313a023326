"""Bad input: one clear line, exit 2, nothing written."""

import json

import pytest

PIPELINE = """
title = "a test"
[params]
mu = 0.01
Omega = 1.0
[stages.up]
kind = "sweep"
vary.A = { from = 0.015, to = 0.016, count = 3 }
settle = 10
record = 4
"""

BAD = {
    "unknown parameter": ("mu = 0.01", "mue = 0.01", "'mu'"),
    "unknown kind": ('"sweep"', '"swep"', "'sweep'"),
    "misspelt option": ("settle = 10", "settel = 10", "'settle'"),
    "misspelt stage key": ("vary.A", "vari.A", "'vary'"),
    "misspelt top key": ("title =", "titel =", "'title'"),
    "misspelt axis": ("vary.A", "vary.B", "allowed"),
    "r above 1": ("Omega = 1.0", "r = 1.2", "0 <= r <= 1"),
    "mu not positive": ("mu = 0.01", "mu = 0.0", "1e-12 <= mu"),
    "lam too large": ("Omega = 1.0", "lam = 2.0", "0 <= lam < 2"),
    "a point of years": ("settle = 10", "settle = 99999999999999", "settle <= 10000000 periods a point; VINES_LONG"),
    "starts of years": ("settle = 10", "settle = 1000\nrandom = 100000", "(settle + record) (1 + random) <= 10000000"),
    "too many points": (
        "count = 3 }",
        "count = 9000000 }\nvary.mu = { from = 0.01, to = 0.02, count = 9000000 }",
        "at most",
    ),
    "ball outside": ("settle = 10", "settle = 10\nstart = { x1 = 1.5 }", "|w| <= 1"),
    "wrong type": ("settle = 10", 'settle = "ten"', "settle"),
    "no TOML": ("[params]", "[params", "line"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_declaration(project, case):
    old, new, expected = BAD[case]
    assert old in PIPELINE
    (project.root / "pipelines" / "mine.toml").write_text(PIPELINE.replace(old, new))
    done = project.vines("run", "mine", check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr
    assert expected in done.stderr
    assert not (project.data / "results").exists()
    assert not (project.data / "points").exists()


def test_one_bad_declaration_leaves_the_others_their_status(project):
    (project.root / "pipelines" / "mine.toml").write_text(PIPELINE.replace('"sweep"', '"swep"'))
    told = json.loads(project.vines("status", "--json").stdout)
    assert "'swep'" in told["mine"]["error"]
    assert len(told["quickstart"]) == 8


def test_a_declaration_that_needs_itself(project):
    figure = '\n[stages.a]\nkind = "figure"\nplot = "bifurcation"\nneeds = ["b"]\n'
    other = figure.replace("stages.a", "stages.b").replace('["b"]', '["a"]')
    (project.root / "pipelines" / "mine.toml").write_text(PIPELINE + figure + other)
    done = project.vines("run", "mine", check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "itself" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["run", "quickstrt"], "'quickstart'"),
        (["run", "no/such/file.toml"], "file.toml"),
        (["rnu", "quickstart"], "'run'"),
        (["run", "quickstart", "nosuchstage"], "nosuchstage"),
        (["run", "quickstart", "--set", "params.mue=1"], "'mu'"),
        (["run", "quickstart", "--set", "params.r=2"], "0 <= r <= 1"),
        (["run", "quickstart", "--set", "nonsense"], "nonsense"),
        (["schema", "piont"], "'points'"),
        (["query", "select * from nosuch"], "nosuch"),
        (["query", "selec 1"], "selec"),
        (["view", "quickstart.symmetric_run"], "run"),
        (["view", "missing.mcap"], "missing.mcap"),
        (["check", "quickstart"], "run"),
        (["diff", "quickstart.up", "quickstart.up", "--rtol", "nan"], "nan is not a finite number"),
        (["diff", "quickstart.up", "quickstart.up", "--atol", "inf"], "inf is not a finite number"),
        (["view", "quickstart.symmetric_run", "--png", "a.png", "--at", "nan"], "nan is not a finite number"),
        (["solve", "LR", "--mu", "0.01", "--A", "inf"], "inf is not a finite number"),
        (["check", "quickstrt"], "quickstrt"),
    ],
)
def test_wrong_use(project, arguments, expected):
    done = project.vines(*arguments, check=False)
    assert done.returncode == 2, done.stdout
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1, done.stderr
    assert expected in done.stderr
    assert not (project.data / "results").exists()


def test_arguments_are_checked_where_nothing_is_left_to_do(quickstart):
    assert quickstart.vines("run", "quickstart").returncode == 0
    for shard in ("5/4", "0/4", "x"):
        done = quickstart.vines("run", "quickstart", "--shard", shard, check=False)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
        assert f"--shard '{shard}' is not i/n with 1 <= i <= n" in done.stderr
    for address in ("node1", "tcp://node1", "node1:port"):
        done = quickstart.vines("run", "quickstart", "--engine", "dask", "--scheduler", address, check=False)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr == f"vines: --scheduler {address} is not an address such as tcp://node1:8786\n"


def test_a_declaration_that_cannot_be_read_is_told_as_that(project):
    (project.root / "pipelines" / "mine.toml").symlink_to("mine.toml")
    (project.root / "pipelines" / "folder.toml").mkdir()
    listed = project.vines("list").stdout
    assert "mine.toml cannot be read: Too many levels of symbolic links" in " ".join(listed.split())
    assert "folder.toml cannot be read: Is a directory" in " ".join(listed.split())
    assert "quickstart" in listed
    assert "never" in project.vines("status", "quickstart").stdout
    told = json.loads(project.vines("status", "--json").stdout)
    assert "Is a directory" in told["folder"]["error"]


def test_an_error_of_the_system_is_explained_by_what_caused_it(project, monkeypatch):
    import vines.stages

    def time_out(*args, **options):
        raise TimeoutError("timed out")

    monkeypatch.setattr(vines.stages, "status_of_each", time_out)
    done = project.vines("status", check=False)
    assert (done.returncode, done.stderr) == (2, "vines: timed out\n")


def test_a_folder_that_a_variable_names_and_that_cannot_be_made_is_told_with_it(project, monkeypatch):
    (project.root / "file").write_text("")
    monkeypatch.setenv("VINES_DATA", str(project.root / "file" / "data"))
    done = project.vines("run", "quickstart", "up", check=False)
    assert done.returncode == 2
    assert done.stderr.endswith(f"; VINES_DATA names the folder {project.root / 'file' / 'data'}\n")


def test_data_that_may_only_be_read_answer_status_query_and_a_run_with_nothing_to_do(quickstart, tmp_path):
    import shutil

    from tests.project import Project

    shutil.copytree(quickstart.root, tmp_path / "copy")
    copy = Project(tmp_path / "copy")
    shutil.rmtree(copy.data / "cache")
    (copy.data / "cache").write_text("")  # no file can be made below it, not even by a superuser
    assert "nothing to compute" in copy.vines("run", "quickstart").stdout
    assert "up to date" in copy.vines("status", "quickstart").stdout
    assert "181" in copy.vines("query", "select count(*) from quickstart.up").stdout


def test_a_file_where_the_folder_of_results_should_be(project, monkeypatch):
    (project.root / "data").write_text("mine")
    for named in ("", str(project.root / "data")):
        with monkeypatch.context() as patched:
            if named:
                patched.setenv("VINES_DATA", named)
            for command in (("status",), ("query", "select 1"), ("run", "quickstart"), ("gc",)):
                done = project.vines(*command, check=False)
                assert (done.returncode, done.stderr.count("\n"), done.stdout) == (2, 1, ""), command
                assert f"{project.root / 'data'} should be the folder of results and is none" in done.stderr
