"""A log that is being written is shown as it grows; a rig's log shows curves to who knows nothing of vines."""

import threading
import time

import numpy as np
import pytest
from matplotlib import image

from vines import logs, viewer
from vines.errors import FileMissingError, LogError
from vines.schema import numpy_dtype
from vines.viewer._program import headless
from vines.viewer._show import _at_rest

ABOUT = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "200"}


def written(path, run, pause=0.0):
    """Write a run piece by piece."""
    states = run.sample(per_period=60, at_events=True)
    with logs.LiveWriter(path, name="live", provenance={}, parameters=run.params.as_dict()) as live:
        for part in np.array_split(states, 4):
            live.add("states", part)
            here = (run.impacts["t"] >= part["t"][0]) & (run.impacts["t"] <= part["t"][-1])
            live.add("impacts", run.impacts[here])
            time.sleep(pause)


def rig(path):
    t = np.arange(400) / 200
    rows = np.zeros(len(t), numpy_dtype("vines.v1.SensorSample"))
    rows["t"], rows["value"], rows["valid"] = t, np.sin(55 * t), 1
    with logs.LiveWriter(path, name="rig", provenance={}, parameters={}, sensors={"lo_disp": ABOUT}) as live:
        live.add("lo_disp", rows)
    return path


def test_a_run_is_followed_to_its_end(settled_run, tmp_path):
    path, said, follow = tmp_path / "run.mcap", [], viewer.follow  # imported before there is anything to follow
    logs_it = threading.Thread(target=written, args=(path, settled_run, 0.2))
    logs_it.start()
    while not path.with_name("run.mcap.part").exists() and logs_it.is_alive():
        time.sleep(0.01)
    follow(path, "save", file=tmp_path / "run.rrd", tell=said.append)
    logs_it.join()
    assert said == [f"{path}.part is finished"]
    assert (tmp_path / "run.rrd").stat().st_size > 50_000


def test_a_rig_that_is_finished_is_followed_too(tmp_path):
    said = []
    viewer.follow(rig(tmp_path / "rig.mcap"), "save", file=tmp_path / "rig.rrd", tell=said.append)
    assert said == [f"{tmp_path / 'rig.mcap'} is finished"]
    assert (tmp_path / "rig.rrd").stat().st_size > 2_000


def test_what_cannot_be_followed_is_a_line(tmp_path):
    with pytest.raises(FileMissingError, match=r"there is no log .*none of that name is being written"):
        viewer.follow(tmp_path / "no.mcap", "save", file=tmp_path / "a.rrd")
    (tmp_path / "text.mcap").write_text("no log at all")
    with pytest.raises(LogError, match="is not an MCAP file"):
        viewer.follow(tmp_path / "text.mcap", "save", file=tmp_path / "a.rrd")
    data = bytearray(rig(tmp_path / "rig.mcap").read_bytes())
    data[data.index(b"\x28\xb5\x2f\xfd") + 60] ^= 0xFF  # inside the first chunk that is compressed
    (tmp_path / "hurt.mcap").write_bytes(data)
    with pytest.raises(LogError, match="is damaged"):
        viewer.follow(tmp_path / "hurt.mcap", "save", file=tmp_path / "a.rrd")
    with pytest.raises(FileMissingError, match=r"the folder .* does not exist"):
        viewer.follow(tmp_path / "rig.mcap", "save", file=tmp_path / "no" / "a.rrd")


@pytest.mark.full
@pytest.mark.usefixtures("vulkan")
def test_pictures_show_what_is_followed(settled_run, tmp_path):
    written(tmp_path / "run.mcap", settled_run)
    viewer.follow(tmp_path / "run.mcap", "headless", picture=tmp_path / "run.png", tell=lambda _: None)
    assert image.imread(tmp_path / "run.png").std() > 0.05


@pytest.mark.full
@pytest.mark.usefixtures("vulkan")
def test_bare_rerun_draws_a_curve_for_each_sensor(tmp_path):
    with headless(rig(tmp_path / "rig.mcap"), (600, 400), laid_out=False) as client:
        _at_rest(client)
        views = client.get_state().views
    assert [(view.view_class, view.origin) for view in views] == [("TimeSeries", "/curves/lo_disp")]
    assert [report for view in views for report in view.reports] == []
