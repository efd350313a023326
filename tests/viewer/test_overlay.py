"""Runs laid over each other, and what sensors measured: in the recording, and drawn by the viewer."""

import os

import numpy as np
import pytest

from tests.viewer.test_recording import chunks
from vines import viewer
from vines.errors import ViewerError
from vines.logs import Sensor, read, write_rig
from vines.schema import numpy_dtype
from vines.viewer._program import headless
from vines.viewer._show import _at_rest


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """Return the log of one sensor and of the base."""
    samples = np.zeros(400, numpy_dtype("vines.v1.SensorSample"))
    samples["t"] = np.arange(400) / 100.0
    samples["value"], samples["valid"] = 1e-3 * np.sin(55.0 * samples["t"]), 1
    base = np.zeros(400, numpy_dtype("vines.v1.BaseMotion"))
    base["t"], base["displacement"] = samples["t"], 1e-4 * np.sin(55.0 * samples["t"])
    base["velocity"] = base["acceleration"] = np.nan
    about = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "100"}
    path = tmp_path_factory.mktemp("rig") / "run.mcap"
    sensors = {"lo_disp": Sensor(samples, about)}
    return write_rig(path, sensors=sensors, base=base, provenance={}, parameters={"M [kg]": 3.8}, name="run_1")


@pytest.fixture(scope="module")
def other(settled, tmp_path_factory):
    """Return a second run with the same forcing."""
    from tests.viewer.conftest import write
    from vines.dynamics import simulate
    from vines.model import Params

    run = simulate(Params(mu=0.01, A=0.019, Omega=1.0, r=0.65), periods=8)
    return write(tmp_path_factory.mktemp("other") / "model.mcap", run)


def test_every_curve_of_both_runs_is_there(settled, other, tmp_path):
    found = chunks(viewer.save_rrd([settled, other], tmp_path / "both.rrd", overlay=True))
    for k, path in enumerate((settled, other)):
        rows = read(path).states.num_rows
        for name in ("w", "w_dot", "x1", "x2"):
            assert found[f"/overlay/{name}/run_{k}"] == rows
        assert f"/overlay/plane/up/run_{k}" in found


def test_what_cannot_be_laid_over_each_other_is_refused(settled, rig, tmp_path):
    from tests.viewer.conftest import write
    from vines.dynamics import simulate
    from vines.model import Params

    faster = write(tmp_path / "faster.mcap", simulate(Params(mu=0.01, A=0.02, Omega=1.1, r=0.65), periods=4))
    for logs, words in (
        ([settled], "2 to 4 runs over each other, 1 were named"),
        ([settled, rig], "run_1 is what sensors measured"),
        ([settled, faster], "Omega is 1.0 and 1.1"),
    ):
        with pytest.raises(ViewerError, match=words):
            viewer.save_rrd(logs, tmp_path / "no.rrd", overlay=True)
    assert not (tmp_path / "no.rrd").exists()


@pytest.fixture(scope="module")
def vulkan(settled, tmp_path_factory):
    """Skip, aloud, where there is no Vulkan; never on a CI machine, which must have one."""
    try:
        with headless(viewer.save_rrd([settled], tmp_path_factory.mktemp("vulkan") / "run.rrd"), (400, 300)):
            pass
    except ViewerError as missing:
        if "no graphics adapter" in str(missing) and not os.environ.get("CI"):
            pytest.skip(f"the viewer cannot draw on this machine: {missing}")
        raise


@pytest.mark.usefixtures("vulkan")
def test_the_viewer_draws_both(settled, other, rig, tmp_path):
    with headless(viewer.save_rrd([settled, other], tmp_path / "o.rrd", overlay=True), (1200, 800)) as client:
        _at_rest(client)
        views = client.get_state().views
    assert {view.origin for view in views if view.view_class == "TimeSeries"} == {
        f"/overlay/{name}" for name in ("w", "w_dot", "x1", "x2")
    }
    assert [report for view in views for report in view.reports] == []
    picture = viewer.screenshot([rig], tmp_path / "rig.png", size=(800, 500))
    assert picture.stat().st_size > 20_000
