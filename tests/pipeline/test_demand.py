"""What is stored was computed with the code of its key, and is where the run finds it."""

import json
import os
import shutil
import subprocess
from types import SimpleNamespace

import pytest

from tests.pipeline.test_machines import SWEEP, Cluster, end, start
from vines.errors import CodeError, StoreError
from vines.pipeline import load, plan, run_pipeline
from vines.pipeline._demand import Demand
from vines.pipeline._gather import put_together
from vines.pipeline._plan import Planner
from vines.pipeline._worker import compute_apart

pytestmark = pytest.mark.long(12)

TOYS = """
    [stages.up]
    kind = "toy"
    vary.A = [0.1, 0.2, 0.3]
    [stages.total]
    kind = "total"
    needs = ["up"]
"""


def test_rows_that_are_not_there_are_named_and_nothing_is_stored(lab):
    declared = lab.declare(TOYS)
    lab.run(declared, stages=["up"], jobs=1)
    planner = Planner(load(declared, root=lab.folder), lab.store)
    prepared = planner.prepare("up")
    parts = sorted(lab.store.pool(prepared.pool_key).folder.glob("0*"))
    shutil.rmtree(parts[-1])
    shutil.rmtree(lab.store.results)
    with pytest.raises(
        StoreError, match=r"of 3 points of stage up were told to be stored and are not in .* the first at A = "
    ):
        put_together(prepared, prepared.grid, lab.store, replace=False)
    assert not lab.store.results.exists()


@pytest.mark.parametrize(
    ("module", "old", "new"), [("law", "gain *", "2 * gain *"), ("bodies", "0.5 * before", "0.6 * before")]
)
def test_a_module_that_is_edited_in_one_process_is_refused_until_python_starts_again(lab, module, old, new):
    declared = lab.declare(TOYS)
    lab.run(declared, jobs=1)
    before = lab.rows("up")
    source = (lab.package / f"{module}.py").read_text()
    lab.source(module, source.replace(old, new))
    with pytest.raises(
        CodeError, match=rf"this process runs other code than the key says: toylab\.{module}; .*restart Python"
    ):
        lab.run(declared, jobs=1)
    assert lab.rows("up") == before
    assert plan(load(declared, root=lab.folder), lab.store)[0].done == 0
    lab.source(module, "# a comment changes nothing\n" + source)
    assert lab.run(declared, jobs=1).new == 0
    lab.source(module, source)
    assert lab.run(declared, jobs=1, force=True).ok


def test_a_module_that_was_edited_before_the_first_run_is_refused_too(lab):
    declared = lab.declare(TOYS)
    source = (lab.package / "law.py").read_text()
    lab.source("law", source.replace("gain *", "2 * gain *"))
    with pytest.raises(CodeError, match=r"toylab\.law; nothing of it is stored; files were changed after"):
        lab.run(declared, jobs=1)
    assert not lab.store.pins("toys")


def test_an_edit_between_two_pipelines_of_a_collection_is_refused(lab):
    lab.run(lab.declare(TOYS, "first"), jobs=1)
    lab.source("law", (lab.package / "law.py").read_text().replace("gain *", "3 * gain *"))
    with pytest.raises(CodeError, match=r"toylab\.law"):
        lab.run(lab.declare(TOYS.replace("0.3]", "0.4]"), "second"), jobs=1)
    assert not lab.store.pins("second")


def test_a_worker_process_that_starts_after_an_edit_is_refused(lab, monkeypatch):
    monkeypatch.setattr("vines.pipeline._processes.WORTH_SECONDS", 0.0)
    declared = lab.declare(SWEEP)
    source = (lab.package / "law.py").read_text()

    def edit(event):
        if event.what == "started":
            lab.source("law", source.replace("gain *", "2 * gain *"))

    with pytest.raises(CodeError, match=r"a worker process runs other code .*: toylab\.law; .*run again"):
        run_pipeline(load(declared, root=lab.folder), lab.store, jobs=2, report=edit)
    assert not lab.store.pins("toys")


@pytest.fixture
def one_good_worker(lab):
    """Give a cluster with one worker of this machine and this code."""
    made = Cluster(lab.folder, lab.package.parent)
    try:
        made.begin(workers=1)
        yield made
    finally:
        made.close()


def test_a_dask_worker_with_other_code_is_refused_by_name(lab, one_good_worker):
    lab.declare(SWEEP)
    other = lab.folder / "other"
    shutil.copytree(lab.package, other / "toylab")
    (other / "toylab" / "law.py").write_text((lab.package / "law.py").read_text().replace("gain *", "2 * gain *"))
    one_good_worker.environment["PYTHONPATH"] = str(other)
    one_good_worker.worker()
    one_good_worker.wait_for(2)
    said = end(start(lab, engine="dask", scheduler=one_good_worker.address, target=0.1), code=2)
    assert said.startswith("vines: the dask worker at tcp://127.0.0.1:")
    assert "runs other code than the key says: toylab.law; nothing of it is stored; start it from" in said
    rows = [json.loads(path.read_text()) for path in lab.store.pools.glob("*/0*/part.json")]
    assert sum(len(each["ids"]) // 20 for each in rows) < 100
    assert not lab.store.pins("toys")


def test_a_dask_worker_without_the_folder_is_refused_by_name(lab, one_good_worker):
    lab.declare(SWEEP)
    lab.store.data.mkdir()
    alone = ["unshare", "--map-root-user", "--mount"]
    if shutil.which("unshare") is None or subprocess.run([*alone, "true"], check=False, capture_output=True).returncode:
        pytest.skip("this machine lets nobody mount a folder of their own, so no worker can be without the data")
    hidden = ["sh", "-c", f'mount -t tmpfs none "{lab.store.data}" && exec "$@"', "sh"]
    one_good_worker.worker(before=[*alone, *hidden])
    one_good_worker.wait_for(2)
    said = end(start(lab, engine="dask", scheduler=one_good_worker.address, target=0.1), code=3)
    assert said.startswith("vines: the dask worker at tcp://127.0.0.1:")
    assert f"does not see the folder {lab.store.data} of this run, so nothing was given to it" in said
    assert not lab.store.pins("toys")


def test_tasks_in_the_users_own_process_set_no_variable(tmp_path, monkeypatch):
    import numba

    import vines.kernels  # noqa: F401 - then they have their place

    monkeypatch.setattr(numba, "set_num_threads", lambda _: None)
    before = dict(os.environ)
    work = SimpleNamespace(demand=Demand("", {}, {}, tmp_path), data=tmp_path)
    assert compute_apart(lambda each: each.data, work) == tmp_path
    assert os.environ == before
