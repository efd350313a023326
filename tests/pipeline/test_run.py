"""The engine: only what is new, the same bytes whoever computed them, failures as rows."""

import importlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from vines.errors import RunFailed, UnknownNameError
from vines.pipeline import load, plan
from vines.store import Store

pytestmark = pytest.mark.long(25)

TOYS = """
    title = "toys"
    [stages.up]
    kind = "toy"
    vary.A = { from = 0.1, to = 0.5, count = 41 }
    [stages.total]
    kind = "total"
    needs = ["up"]
"""
CARRIED = TOYS.replace("[stages.total]", 'carry = "A"\n    [stages.total]')


def test_a_run_makes_results_and_a_second_one_computes_nothing(lab, tally):
    path, read = tally
    declared = lab.declare(TOYS.replace('"toy"', f'"toy"\n    tally = "{path}"'))
    first = lab.run(declared, jobs=1)
    assert first.ok
    assert sum(read().values()) == 41
    before = {stage: lab.bytes_of(stage) for stage in ("up", "total")}
    second = lab.run(declared, jobs=1)
    assert second.new == 0
    assert not read()
    assert [event.what for event in lab.events] == ["up_to_date", "up_to_date"]
    assert before == {stage: lab.bytes_of(stage) for stage in ("up", "total")}


def test_rows_are_sorted_by_the_axis_and_complete(lab):
    lab.run(lab.declare(TOYS), jobs=1)
    rows = lab.rows("up")
    assert [row["A"] for row in rows] == [round(0.1 + 0.01 * i, 2) for i in range(41)]
    assert {row["status"] for row in rows} == {"ok"}
    impacts = lab.rows("up", "impacts")
    assert [row["index"] for row in impacts] == [0, 1] * 41
    manifest = lab.store.result(lab.store.pins("toys")["up"]["result"]).manifest
    assert len(manifest["logs"]) == 41
    assert manifest["logs"][0]["params"] == {"A": 0.1, "mu": 0.1}
    assert manifest["logs"][0]["name"] == "1:1"
    assert lab.rows("total")[0]["point_id"] == "000000"


@pytest.mark.parametrize("form", [TOYS, CARRIED])
@pytest.mark.parametrize(("count", "new"), [(81, 40), (121, 80)])
def test_a_refined_grid_computes_only_new_points_unless_carried(lab, tally, form, count, new):
    path, read = tally
    declared = lab.declare(form.replace('"toy"', f'"toy"\n    tally = "{path}"'))
    lab.run(declared, jobs=1)
    read()
    lab.run(declared, {"stages.up.vary.A.count": count}, jobs=1)
    counted = read()
    # the first point of a chain has no predecessor, so it stays what it is
    assert sum(counted.values()) == (count - 1 if form is CARRIED else new)
    fresh = Store(lab.folder / "fresh")
    lab.store, kept = fresh, lab.bytes_of("up")
    lab.run(declared, {"stages.up.vary.A.count": count}, jobs=1)
    assert kept == lab.bytes_of("up")


@pytest.mark.parametrize("form", [TOYS, CARRIED])
def test_an_extended_range_computes_only_the_new_points(lab, tally, form):
    path, read = tally
    declared = lab.declare(form.replace('"toy"', f'"toy"\n    tally = "{path}"'))
    lab.run(declared, jobs=1)
    read()
    change = {"stages.up.vary.A.to": "0.6", "stages.up.vary.A.count": 51}
    assert lab.run(declared, change, jobs=1).stages[0].new == 10
    assert sum(read().values()) == 10
    kept = lab.bytes_of("up")
    lab.store = Store(lab.folder / "fresh")
    lab.run(declared, change, jobs=1)
    assert kept == lab.bytes_of("up")


def test_two_pipelines_share_their_points(lab, tally):
    path, read = tally
    text = TOYS.replace('"toy"', f'"toy"\n    tally = "{path}"')
    lab.run(lab.declare(text), jobs=1)
    read()
    other = lab.declare(text.replace("stages.up", "stages.rise").replace('["up"]', '["rise"]'), "others")
    assert lab.run(other, jobs=1).stages[0].new == 0
    assert not read()


def test_a_carried_chain_hands_on_its_state_in_both_directions(lab):
    lab.run(lab.declare(CARRIED), jobs=1)
    up = [row["end_x1"] for row in lab.rows("up")]
    import math

    state, wanted = None, []
    for i in range(41):
        state = math.sin(round(0.1 + 0.01 * i, 2)) + (0.5 * state if state is not None else 0.0)
        wanted.append(state)
    assert up == wanted
    down = {"stages.up.carry": {"axis": "A", "direction": "down"}}
    lab.run(lab.declare(CARRIED), down, jobs=1)
    assert lab.rows("up")[-1]["end_x1"] == math.sin(0.5)


def test_a_chain_may_start_from_a_point_of_another_stage(lab, tally):
    path, read = tally
    declared = lab.declare(
        f"""
        [stages.up]
        kind = "toy"
        vary.A = [0.1, 0.2]
        [stages.on]
        kind = "toy"
        tally = "{path}"
        vary.A = [0.2, 0.3]
        carry = {{ axis = "A", start = {{ from = "up", at = {{ A = 0.2 }} }} }}
        """
    )
    lab.run(declared, jobs=1)
    import math

    read()
    assert lab.rows("on")[0]["end_x1"] == math.sin(0.2) + 0.5 * math.sin(0.2)
    # more points in the other stage leave the start as it was
    assert lab.run(declared, {"stages.up.vary.A": [0.1, 0.2, 0.3]}, jobs=1).stages[1].state == "up_to_date"
    assert not read()


@pytest.mark.parametrize("form", [TOYS, CARRIED.replace("vary.A", "vary.mu = [0.1, 0.2, 0.3]\n    vary.A")])
def test_one_and_two_processes_make_the_same_bytes(lab, monkeypatch, form):
    monkeypatch.setattr("vines.pipeline._processes.WORTH_SECONDS", 0.0)
    declared = lab.declare(form)
    lab.run(declared, jobs=1)
    alone = lab.bytes_of("up")
    lab.store = Store(lab.folder / "two")
    lab.run(declared, jobs=2)
    assert max(event.jobs for event in lab.events) == 2
    assert lab.bytes_of("up") == alone


@pytest.mark.parametrize("form", [TOYS, CARRIED.replace("vary.A", "vary.mu = [0.1, 0.2, 0.3]\n    vary.A")])
def test_a_worker_that_dies_loses_nothing(lab, monkeypatch, form):
    monkeypatch.setattr("vines.pipeline._processes.WORTH_SECONDS", 0.0)
    lab.run(lab.declare(form), jobs=1)
    undisturbed = lab.rows("up")
    declared = lab.declare(form.replace('"toy"', f'"toy"\n    die = "{lab.folder / "died"}"'))
    assert lab.run(declared, jobs=2).ok
    assert (lab.folder / "died").exists()
    values = [[(row["A"], row["mu"], row["end_x1"]) for row in rows] for rows in (undisturbed, lab.rows("up"))]
    assert values[0] == values[1]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            'return Batch(tables={"points": rows,',
            'return Batch(tables={"points": rows[1:],',
            "exactly one row for each",
        ),
        ('"index": i,', '"indx": i,', "did you mean 'index'"),
        ("from toylab.law import law", "from toylab.gone import law", "No module named 'toylab.gone'"),
    ],
)
def test_a_mistake_in_a_kind_fails_its_stage_and_marks_no_point(lab, monkeypatch, old, new, words):
    source = (lab.package / "bodies.py").read_text()
    assert old in source
    lab.source("wrong", source.replace(old, new))
    from vines.pipeline import Kind, kind, register

    fields = {name: getattr(kind("toy"), name) for name in Kind.__dataclass_fields__}
    register(Kind(**{**fields, "body": "toylab.wrong:points"}))
    declared = lab.declare(TOYS + '    [stages.alone]\n    kind = "total"\n')
    summary = lab.run(declared, jobs=1)
    assert {each.name: each.state for each in summary.stages} == {
        "up": "failed",
        "total": "skipped",
        "alone": "computed",
    }
    with pytest.raises(RunFailed, match=words):
        summary.check()
    assert list(lab.store.pins("toys")) == ["alone"]
    assert plan(load(declared, root=lab.folder), lab.store)[0].failed == 0


def test_a_stage_without_axes_is_one_point(lab):
    summary = lab.run(lab.declare('[stages.one]\nkind = "toy"\nparams.A = 0.3\n'), jobs=1)
    assert (summary.stages[0].wanted, summary.stages[0].new) == (1, 1)
    assert len(lab.rows("one")) == 1


def test_failed_points_are_rows_with_a_reason_and_can_be_tried_again(lab, tally):
    path, read = tally
    declared = lab.declare(TOYS.replace('"toy"', f'"toy"\n    tally = "{path}"\n    bad = [0.2, 0.33]'))
    summary = lab.run(declared, jobs=1)
    assert summary.stages[0].failed == 2
    assert summary.stages[1].state == "computed"
    with pytest.raises(RunFailed, match="2 points failed") as caught:
        summary.check()
    assert caught.value.exit_code == 3
    failed = [row for row in lab.rows("up") if row["status"] == "failed"]
    assert [row["A"] for row in failed] == [0.2, 0.33]
    assert failed[0]["reason"] == "ValueError: A = 0.2 is bad"
    assert failed[0]["end_x1"] is None
    read()
    again = lab.run(declared, jobs=1)
    assert (again.new, again.stages[0].state, again.stages[0].failed) == (0, "up_to_date", 2)
    assert not read()
    assert lab.run(declared, jobs=1, retry_failed=True).stages[0].new == 2


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("toys", [TOYS, CARRIED])
def test_a_package_that_is_missing_here_fails_no_point(lab, toys, jobs):
    declared = lab.declare(toys.replace('"toy"', '"toy"\n    package = "toylab.driver"'))
    stage = lab.run(declared, jobs=jobs).stages[0]
    assert (stage.state, stage.reason) == ("failed", "ModuleNotFoundError: No module named 'toylab.driver'")
    lab.source("driver", "")  # it is installed, or the run goes on where it is
    importlib.invalidate_caches()
    stage = lab.run(declared, jobs=1).stages[0]
    assert (stage.state, stage.failed, stage.new) == ("computed", 0, stage.wanted)


def test_in_a_chain_what_comes_after_a_failed_point_fails_with_it(lab):
    declared = lab.declare(CARRIED.replace('"toy"', '"toy"\n    bad = [0.3]'))
    assert lab.run(declared, jobs=1).stages[0].failed == 21
    reasons = [row["reason"] for row in lab.rows("up") if row["status"] == "failed"]
    assert reasons[0] == "ValueError: A = 0.3 is bad"
    assert set(reasons[1:]) == {"a point before it in the carried chain failed"}


def test_a_failed_whole_stage_leaves_the_others_and_skips_those_after_it(lab):
    declared = lab.declare(TOYS + '    label = "broken"\n    [stages.more]\n    kind = "toy"\n    vary.A = [0.7]\n')
    summary = lab.run(declared, jobs=1)
    assert [(each.name, each.state) for each in summary.stages] == [
        ("up", "computed"),
        ("more", "computed"),
        ("total", "failed"),
    ]
    with pytest.raises(RunFailed, match="stage total failed: RuntimeError: label is broken"):
        summary.check()


def test_force_computes_again_and_ends_with_the_same_bytes(lab, tally):
    path, read = tally
    declared = lab.declare(TOYS.replace('"toy"', f'"toy"\n    tally = "{path}"'))
    lab.run(declared, jobs=1)
    before = lab.bytes_of("up")
    read()
    lab.run(declared, stages=["up"], jobs=1, force=True)
    assert sum(read().values()) == 41
    assert lab.bytes_of("up") == before


def test_named_stages_run_with_what_they_need(lab):
    declared = lab.declare(TOYS + '    [stages.more]\n    kind = "toy"\n    vary.A = [0.7]\n')
    assert [stage.name for stage in lab.run(declared, stages=["total"], jobs=1).stages] == ["up", "total"]
    with pytest.raises(UnknownNameError, match="did you mean 'total'"):
        lab.run(declared, stages=["totl"])


def test_a_stage_that_was_removed_is_forgotten(lab):
    lab.run(lab.declare(TOYS), jobs=1)
    lab.run(lab.declare(TOYS.partition("[stages.total]")[0]), jobs=1)
    assert list(lab.store.pins("toys")) == ["up"]


def test_an_interrupt_keeps_what_is_stored(lab, tally):
    path, read = tally
    declared = lab.declare(TOYS.replace('"toy"', f'"toy"\n    tally = "{path}"'))

    def stop(event):
        if event.what == "progress" and event.done > 5:
            raise KeyboardInterrupt

    from vines.pipeline import run_pipeline

    with pytest.raises(KeyboardInterrupt):
        run_pipeline(load(declared, root=lab.folder), lab.store, jobs=1, report=stop)
    stored = sum(read().values())
    assert 5 < stored < 41
    assert plan(load(declared, root=lab.folder), lab.store)[0].done == stored
    lab.run(declared, jobs=1)
    assert sum(read().values()) == 41 - stored


PICTURES = """
[stages.up]
kind = "toy"
vary.A = [0.1, 0.2]
[stages.first]
kind = "picture"
needs = ["up"]
LABEL
[stages.second]
kind = "picture"
needs = ["up"]
[stages.total]
kind = "total"
needs = ["up"]
"""


@pytest.mark.parametrize(("label", "apart"), [("", True), ('label = "dies"', False)])
def test_a_picture_is_drawn_beside_later_stages(lab, tmp_path, label, apart):
    tally = tmp_path / "tally"
    form = PICTURES.replace("LABEL", f'{label}\ntally = "{tally}"')
    declared = lab.declare(form)
    summary = lab.run(declared, jobs=2)
    assert [stage.name for stage in summary.stages] == ["up", "first", "second", "total"]
    assert summary.ok
    # a process that dies leaves it to this one
    assert (int(tally.read_text()) != os.getpid()) == apart
    assert plan(load(declared, root=lab.folder), lab.store)[1].state == "up_to_date"
    together = lab.bytes_of("first")
    lab.store = Store(lab.folder / "alone")
    lab.run(declared, jobs=1)
    assert lab.bytes_of("first") == together


def test_a_picture_that_fails_in_another_process_fails_its_stage_alone(lab):
    declared = lab.declare(PICTURES.replace("LABEL", 'label = "broken"'))
    states = {stage.name: (stage.state, stage.reason) for stage in lab.run(declared, jobs=2).stages}
    assert states["first"] == ("failed", "RuntimeError: label is broken")
    assert [states[name][0] for name in ("second", "total")] == ["computed", "computed"]


def test_a_script_without_a_guard_may_use_processes(lab):
    lab.declare(PICTURES.replace("LABEL", ""))
    (lab.folder / "script.py").write_text(SCRIPT.replace('if __name__ == "__main__":', "if True:"))
    command = [sys.executable, "script.py", lab.package.parent, Path(__file__).parent, lab.folder, "2"]
    assert subprocess.run(command, cwd=lab.folder, timeout=120, check=False).returncode == 0
    assert lab.store.pins("toys").keys() == {"up", "first", "second", "total"}


SCRIPT = """
import importlib, sys
from pathlib import Path
sys.path[:0] = [sys.argv[1], sys.argv[2]]
if __name__ == "__main__":
    import vines.pipeline._processes as processes
    processes.WORTH_SECONDS = 0.0
    from lab import Lab
    lab = object.__new__(Lab)
    lab.folder = Path(sys.argv[3])
    lab.store = importlib.import_module("vines.store").Store(lab.folder / "data")
    lab.register()
    lab.run(lab.folder / "pipelines" / "toys.toml", jobs=int(sys.argv[4]))
"""


@pytest.mark.parametrize("jobs", [1, 2])
def test_killed_in_the_middle_the_same_command_ends_with_the_same_bytes(lab, jobs):
    form = TOYS.replace('"toy"', '"toy"\n    wait = 0.02').replace("[stages.total]", 'carry = "A"\n    [stages.total]')
    declared = lab.declare(form.replace("vary.A", "vary.mu = [0.1, 0.2]\n    vary.A"))
    (lab.folder / "script.py").write_text(SCRIPT)
    command = [
        sys.executable,
        "script.py",
        str(lab.package.parent),
        str(Path(__file__).parent),
        str(lab.folder),
        str(jobs),
    ]
    for parts in (2, 4):
        process = subprocess.Popen(command, cwd=lab.folder)
        while len(list(lab.store.pools.glob("*/0*"))) < parts and process.poll() is None:
            time.sleep(0.01)
        os.kill(process.pid, signal.SIGKILL)
        assert process.wait() == -signal.SIGKILL
    assert not lab.store.pins("toys")
    done = plan(load(declared, root=lab.folder), lab.store)[0].done
    assert 0 < done < 82
    lab.run(declared, jobs=1)
    after = {stage: lab.bytes_of(stage) for stage in ("up", "total")}
    lab.store = Store(lab.folder / "undisturbed")
    lab.run(declared, jobs=1)
    assert after == {stage: lab.bytes_of(stage) for stage in ("up", "total")}
