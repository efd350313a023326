"""What the commands print and write when all is well."""

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

pytestmark = pytest.mark.long(18)


def test_list_and_status(quickstart):
    assert "quickstart" in quickstart.vines("list").stdout
    shown = quickstart.vines("status", "quickstart").stdout.splitlines()
    assert shown[0].split() == ["stage", "kind", "state", "points", "failed", "why"]
    assert all("up to date" in line for line in shown[1:])
    assert "quickstart" in quickstart.vines("status").stdout


def test_tables_and_schema(quickstart):
    rows = {row["view"]: row["rows"] for row in json.loads(quickstart.vines("tables", "--json").stdout)}
    assert rows["points"] == 185
    assert rows["quickstart.up"] == 181
    assert "Mass ratio m/M" in quickstart.vines("schema", "points").stdout


def test_query_in_every_form(quickstart, tmp_path):
    assert quickstart.vines("query", "select 1 as one, null as none").stdout == "one  none\n1\n"
    sql = "select A, name from points where stage = 'up' order by A limit 2"
    assert quickstart.vines("query", sql).stdout.splitlines()[1].split() == ["0.015", "1:1"]
    assert json.loads(quickstart.vines("query", sql, "--format", "json").stdout)[0] == {"A": 0.015, "name": "1:1"}
    rows = list(csv.DictReader(io.StringIO(quickstart.vines("query", sql, "--format", "csv").stdout)))
    assert rows[0] == {"A": "0.015", "name": "1:1"}
    for suffix in ("csv", "json", "parquet", "txt"):
        quickstart.vines("query", sql, "--out", tmp_path / f"answer.{suffix}")
    kept = pq.read_table(tmp_path / "answer.parquet")
    assert kept.num_rows == 2
    assert kept.schema.field("A").metadata == {b"unit": b"1"}
    assert (tmp_path / "answer.txt").read_text().startswith("A")
    assert {path.suffix for path in tmp_path.iterdir()} == {".csv", ".json", ".parquet", ".txt"}


AWKWARD = (
    "select 'a\"b' as words, [1.5, null] as list, 'nan'::double as x, 1e300 as big, date '2026-01-02' as day, "
    "null as none"
)


def test_awkward_values_and_empty_answers_on_the_screen(quickstart):
    row = json.loads(quickstart.vines("query", AWKWARD, "--format", "json").stdout)[0]
    assert row == {"words": 'a"b', "list": [1.5, None], "x": None, "big": 1e300, "day": "2026-01-02", "none": None}
    assert "[1.5, ]" in quickstart.vines("query", AWKWARD).stdout
    nothing = "select A, name from points where false"
    assert quickstart.vines("query", nothing).stdout == "A  name\n"
    assert quickstart.vines("query", nothing, "--format", "csv").stdout == "A,name\n"
    assert json.loads(quickstart.vines("query", nothing, "--format", "json").stdout) == []


def test_the_reference_of_tables_is_current(quickstart):
    said = quickstart.vines("schema", "--markdown").stdout
    committed = (Path(__file__).resolve().parents[2] / "docs" / "reference_tables.md").read_text("utf-8")
    assert said == committed, "run: vines schema --markdown > docs/reference_tables.md"


@pytest.mark.parametrize("what", ["kinds", "plots"])
def test_the_references_of_kinds_and_plots_are_current(quickstart, what):
    said = quickstart.vines(what, "--markdown").stdout
    committed = (Path(__file__).resolve().parents[2] / "docs" / f"reference_{what}.md").read_text("utf-8")
    assert said == committed, f"run: vines {what} --markdown > docs/reference_{what}.md"


@pytest.mark.parametrize("sql", ["create table x as select 1", "copy (select 1) to 'evil.csv'", "select 1; select 2"])
def test_the_catalogue_is_read_only(quickstart, sql):
    done = quickstart.vines("query", sql, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "single select" in done.stderr
    assert not (quickstart.root / "evil.csv").exists()


def test_init_and_its_next_step(project, tmp_path):
    folder = tmp_path / "my study"
    shown = project.vines("init", "--from", "quickstart", folder).stdout
    assert f"cd '{folder}'" in shown
    assert (folder / "pipelines" / "quickstart.toml").is_file()


def test_dry_run_and_force(quickstart):
    shown = quickstart.vines("run", "quickstart", "--set", "stages.up.vary.A.to=0.03", "--dry-run").stdout
    assert "120 of 301" in shown
    assert "181 of 181" in quickstart.vines("run", "quickstart", "--force", "--dry-run").stdout


def test_no_forcing_at_all_is_a_run_too(project):
    (project.root / "pipelines" / "still.toml").write_text(
        'title = "still"\n[params]\nmu = 0.01\nA = 0.0\n[stages.run]\nkind = "trajectory"\nsettle = 20\nrecord = 2\n'
    )
    shown = project.vines("run", "still").stdout
    assert "at mu = 0.01, A = 0, Omega = 1  (run)" in shown


def test_a_file_cannot_take_the_name_of_a_pipeline(project, tmp_path):
    other = tmp_path / "elsewhere" / "quickstart.toml"
    other.parent.mkdir()
    other.write_text((project.root / "pipelines" / "quickstart.toml").read_text())
    done = project.vines("run", other, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "rename this file" in done.stderr


SENSELESS = {
    "a figure of nothing": ('kind = "figure"\nplot = "bifurcation"\n', "needs"),
    "a figure without an axis": (
        'kind = "figure"\nplot = "bifurcation"\nneeds = ["symmetric_run"]\n',
        "varies nothing",
    ),
    "no width": (
        'kind = "figure"\nplot = "bifurcation"\nneeds = ["up"]\nwidth = -1\n',
        "width is -1, allowed is width > 0",
    ),
    "an unknown panel": ('kind = "figure"\nplot = "bifurcation"\nneeds = ["up"]\npanels = ["w_dott"]\n', "'w_dot'"),
    "an unknown claim": ('kind = "check"\nneeds = ["up"]\nclaims = ["fig2_x"]\n', "'fig2_"),
    "a branch of nothing": ('kind = "branch"\nword = "LR"\nparams.A = 0.02\n', "vary.X"),
    "a record too short": ('kind = "sweep"\nvary.A = [0.015]\nrecord = 1\n', "record is 1, allowed is record >= 2"),
}


@pytest.mark.parametrize("case", SENSELESS)
def test_senseless_stages_are_seen_before_anything_is_computed(project, case):
    text, expected = SENSELESS[case]
    declared = (project.root / "pipelines" / "quickstart.toml").read_text()
    (project.root / "pipelines" / "mine.toml").write_text(f"{declared}\n[stages.mine]\n{text}")
    done = project.vines("run", "mine", check=False)
    assert (done.returncode, done.stderr.count("\n"), done.stdout) == (2, 1, ""), done.stderr
    assert expected in done.stderr
    assert not (project.data / "results").exists()


def test_data_that_cannot_be_written(project, monkeypatch):
    monkeypatch.setenv("VINES_DATA", "/proc/nothing")
    done = project.vines("run", "quickstart", check=False)
    assert "Traceback" not in done.stderr
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)


def test_interrupted_run_says_how_to_go_on(project):
    (project.root / "pipelines" / "long.toml").write_text(
        'title = "long"\n[params]\nmu = 0.01\n[stages.up]\nkind = "sweep"\n'
        "vary.A = { from = 0.015, to = 0.024, count = 20001 }\n"
    )
    running = project.start("run", "long", stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    while not any(project.data.glob("points/*/0*")) and running.poll() is None:
        time.sleep(0.01)
    running.send_signal(signal.SIGINT)
    _, told = running.communicate(timeout=60)
    assert running.returncode not in (0, 1)
    assert "Traceback" not in told
    assert "vines run long" in told


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_run_that_is_inside_a_kernel_for_years(project, number, monkeypatch):
    from filelock import FileLock

    monkeypatch.setenv("VINES_LONG_POINTS", "1")

    (project.root / "pipelines" / "endless.toml").write_text(
        '[params]\nmu = 0.01\n[stages.up]\nkind = "sweep"\nvary.A = [0.015]\ncarry = "A"\nsettle = 99999999999999\n'
    )
    running = project.start("run", "endless", stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    while not any(project.data.glob("staging/*/work-*")) and running.poll() is None:
        time.sleep(0.01)
    time.sleep(1.5)  # the kernel is loaded and runs
    running.send_signal(number)
    _, told = running.communicate(timeout=60)
    assert (running.returncode, told) == (
        130,
        "vines: stopped; what is finished is kept, 'vines run endless' goes on\n",
    )
    with FileLock(project.data / "store.lock").acquire(timeout=30):
        assert not any(project.data.glob("points/*/0*"))


ENDLESS = "select count(*) from range(10000000) a, range(10000000) b where hash(a.range + b.range) = 1"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_query_that_takes_for_ever(quickstart, number, tmp_path):
    running = quickstart.start("query", ENDLESS, "--out", tmp_path / "answer.csv", stderr=subprocess.PIPE)
    while not any(tmp_path.iterdir()) and running.poll() is None:
        time.sleep(0.01)
    time.sleep(0.5)  # DuckDB is at it
    running.send_signal(number)
    _, told = running.communicate(timeout=60)
    assert (running.returncode, told) == (130, "vines: stopped\n")
    assert not any(tmp_path.iterdir())


def test_ctrl_c_ends_a_query_in_python_and_the_session_goes_on(quickstart):
    script = (
        "import os, signal, threading, time, vines\n"
        "def stop():\n    time.sleep(1)\n    os.kill(os.getpid(), signal.SIGINT)\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "threading.Thread(target=stop).start()\n"
        f"try:\n    vines.query({ENDLESS!r})\nexcept KeyboardInterrupt:\n"
        "    print(vines.query('select 1 as one').to_pylist())\n"
    )
    environment = {**os.environ, **quickstart.environment}
    said = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert (said.stdout, said.stderr) == ("[{'one': 1}]\n", "")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_command_that_waits_for_another(project, number):
    from filelock import FileLock

    project.data.mkdir()
    with FileLock(project.data / "store.lock"):
        running = project.start("gc", "--yes", stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
        children = Path(f"/proc/{running.pid}/task/{running.pid}/children")
        while not children.read_text() and running.poll() is None:
            time.sleep(0.01)
        time.sleep(0.7)
        running.send_signal(number)
        _, told = running.communicate(timeout=60)
    assert (running.returncode, told) == (130, "vines: stopped\n")


def test_sql_that_begins_with_a_comment_is_sql(quickstart):
    for sql in ("-- how many\nselect 3 as n", "--how many\nselect 3 as n"):
        assert json.loads(quickstart.vines("query", sql, "--format", "json").stdout) == [{"n": 3}]
        assert json.loads(quickstart.vines("query", "--format", "json", "--", sql).stdout) == [{"n": 3}]
    assert quickstart.vines("query", "select 1", "--fromat", "json", check=False).returncode == 2


def test_two_columns_of_one_name_are_both_in_json(quickstart):
    told = quickstart.vines("query", "select 1 as A, 2 as A", "--format", "json").stdout
    assert json.loads(told) == [{"A": 1, "A_1": 2}]


def test_a_letter_that_the_locale_does_not_have_is_no_traceback(quickstart):
    said = subprocess.run(
        [sys.executable, "-X", "utf8=0", "-m", "vines.cli", "query", "select 'ü' as letter"],
        env={**os.environ, **quickstart.environment, "LC_ALL": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"},
        cwd=quickstart.root,
        capture_output=True,
        check=False,
    )
    assert (said.returncode, said.stdout, said.stderr) == (0, "letter\nü\n".encode(), b"")
