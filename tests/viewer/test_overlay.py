"""Runs laid over each other, and what sensors measured: in the recording, and drawn by the viewer."""

import signal
import subprocess
import sys

import matplotlib.image
import pytest

from tests.viewer.chromium import chromium
from tests.viewer.conftest import write
from tests.viewer.test_recording import chunks
from vines import viewer
from vines.dynamics import simulate
from vines.errors import ViewerError
from vines.logs import read
from vines.model import Params
from vines.viewer._program import headless
from vines.viewer._show import _at_rest
from vines.viewer._style import BASE, LINE, OVERLAID


def test_every_curve_of_both_runs_is_there(settled, other, tmp_path):
    found = chunks(viewer.save_rrd([settled, other], tmp_path / "both.rrd", overlay=True))
    for k, path in enumerate((settled, other)):
        rows = read(path).states.num_rows
        for name in ("w", "w_dot", "x1", "x2"):
            assert found[f"/overlay/{name}/run_{k}"] == rows
        assert f"/overlay/plane/up/run_{k}" in found


def test_what_cannot_be_laid_over_each_other_is_refused(settled, rig, tmp_path):
    faster = write(tmp_path / "faster.mcap", simulate(Params(mu=0.01, A=0.02, Omega=1.1, r=0.65), periods=4))
    for logs, words in (
        ([settled], "2 to 4 runs over each other, 1 were named"),
        ([settled, rig], "run_1 is what sensors measured"),
        ([settled, faster], "Omega is 1.0 and 1.1"),
    ):
        with pytest.raises(ViewerError, match=words):
            viewer.save_rrd(logs, tmp_path / "no.rrd", overlay=True)
    assert not (tmp_path / "no.rrd").exists()


@pytest.mark.usefixtures("vulkan")
def test_the_viewer_draws_both(settled, other, rig, tmp_path):
    with headless(viewer.save_rrd([settled, other], tmp_path / "o.rrd", overlay=True), (600, 400)) as client:
        _at_rest(client)
        views = client.get_state().views
    assert {view.origin for view in views if view.view_class == "TimeSeries"} == {
        f"/overlay/{name}" for name in ("w", "w_dot", "x1", "x2")
    }
    assert [report for view in views for report in view.reports] == []
    picture = viewer.screenshot([rig], tmp_path / "rig.png", size=(400, 300))
    assert picture.stat().st_size > 10_000


def shown_in_a_browser(program, tmp_path, *arguments):
    """Run ``vines view --web``, open its page, end it with Ctrl-C; return the picture and what the page asked for."""
    command = [sys.executable, "-m", "vines.cli", "view", *map(str, arguments), "--web"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path) as server:
        try:
            url = server.stdout.readline().split()[1]
            with chromium(program) as browser:
                browser.open(url)
                picture = browser.at_rest()
                asked = browser.asked()
        finally:
            server.send_signal(signal.SIGINT)
            said = server.communicate(timeout=30)[1]
    assert "Traceback" not in said
    assert [address for address in asked if not address.startswith(("http://127.0.0.1:", "data:", "blob:"))] == []
    (tmp_path / "page.png").write_bytes(picture)
    return (matplotlib.image.imread(tmp_path / "page.png")[..., :3] * 255).round()


@pytest.mark.full
def test_two_runs_over_each_other_in_a_browser(settled, other, tmp_path, browser_program):
    drawn = shown_in_a_browser(browser_program, tmp_path, settled, other, "--overlay")
    for colour in OVERLAID[:2]:
        assert (abs(drawn - colour[:3]).max(axis=-1) < 30).sum() > 300


@pytest.mark.full
def test_sensors_of_a_rig_in_a_browser(rig, tmp_path, browser_program):
    drawn = shown_in_a_browser(browser_program, tmp_path, rig)
    for colour in (LINE, BASE):
        assert (abs(drawn - colour[:3]).max(axis=-1) < 40).sum() > 300
