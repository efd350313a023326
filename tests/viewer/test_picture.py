"""The viewer itself, without a window: its views draw, its picture shows something, its failures are told."""

import sys

import matplotlib.image
import numpy as np
import psutil
import pytest

from vines import viewer
from vines.errors import ViewerError
from vines.viewer._program import headless
from vines.viewer._show import _at_rest

pytestmark = [pytest.mark.long(12), pytest.mark.usefixtures("vulkan")]


def viewers():
    """Return the viewers among our child processes; a test worker has others, such as multiprocessing's tracker."""
    return [each for each in psutil.Process().children(recursive=True) if "rerun" in each.name()]


@pytest.fixture(scope="module")
def recording(settled, tmp_path_factory):
    return viewer.save_rrd([settled], tmp_path_factory.mktemp("viewer") / "run.rrd")


def test_views_draw_without_errors(recording):
    with headless(recording, (800, 500)) as client:
        _at_rest(client)
        state = client.get_state()
        assert sorted((view.view_class, view.origin.rsplit("/", 1)[-1]) for view in state.views) == [
            ("2D", "cavity"),
            ("2D", "dial"),
            ("2D", "phase"),
            ("TextDocument", "about"),
            ("TextLog", "impacts"),
            ("TimeSeries", "balance"),
            ("TimeSeries", "ends"),
            ("TimeSeries", "energy"),
            ("TimeSeries", "lanes"),
            ("TimeSeries", "w"),
            ("TimeSeries", "w_dot"),
        ]
        assert all(view.visible for view in state.views)
        assert [report for view in state.views for report in view.reports] == []
        kinds = {line.name: line.time_type for line in state.recordings[0].timelines}
        assert (kinds["sim_time"], kinds["cycle/1000"], kinds["impact"]) == ("duration", "sequence", "duration")


@pytest.mark.full
def test_bare_rerun_shows_a_log_that_explains_itself(settled):
    """Without our layout: the viewer makes its own from the channels that it understands."""
    with headless(settled, (600, 400), laid_out=False) as client:
        _at_rest(client)
        state = client.get_state()
    kinds = [(view.view_class, view.origin) for view in state.views]
    assert ("3D", "/") in kinds
    assert sum(kind == "TimeSeries" for kind, _ in kinds) >= 3
    assert any(kind == "TextLog" for kind, _ in kinds)
    assert [report for view in state.views for report in view.reports] == []


def test_side_by_side_views_draw_without_errors(settled, chatter, tmp_path):
    both = viewer.save_rrd([settled, chatter], tmp_path / "both.rrd")
    with headless(both, (600, 400)) as client:
        _at_rest(client)
        views = client.get_state().views
    origins = [view.origin for view in views]
    for root in ("/quickstart_settled", "/quickstart_chatter"):
        for part in ("cavity", "phase", "w", "w_dot", "lanes", "dial"):
            assert f"{root}/{part}" in origins
    assert [report for view in views for report in view.reports] == []


def test_listens_on_this_machine_only(recording):
    with headless(recording, (400, 300)):
        mine = viewers()
        listening = {
            each.laddr.ip
            for process in mine
            for each in process.net_connections("inet")
            if each.status == psutil.CONN_LISTEN
        }
    assert listening == {"127.0.0.1"}
    assert [process for process in mine if process.is_running() and process.status() != psutil.STATUS_ZOMBIE] == []


def test_picture_shows_ball_and_both_ends(settled, tmp_path):
    out = viewer.screenshot([settled], tmp_path / "run.png", size=(1200, 800))
    picture = (matplotlib.image.imread(out)[..., :3] * 255).round()
    assert picture.shape == (800, 1200, 3)
    assert picture.std() > 20
    drawn = picture[60:220, :500]
    red, green, blue = drawn[..., 0], drawn[..., 1], drawn[..., 2]
    left = np.argwhere((red > 200) & (green < 120) & (blue < 120))
    right = np.argwhere((blue > 200) & (red < 120))
    ball = np.argwhere((red > 200) & (green > 150) & (blue < 90))
    assert min(len(left), len(right), len(ball)) > 50
    # The ball lies between the red LEFT end and the blue RIGHT end.
    assert left[:, 1].mean() < ball[:, 1].mean() < right[:, 1].mean()


def test_several_runs_at_a_given_time(settled, chatter, no_impact, tmp_path):
    early = viewer.screenshot([settled, chatter], tmp_path / "a.png", at=1.0, size=(500, 400))
    late = viewer.screenshot([settled, chatter], tmp_path / "b.png", at=20.0, size=(500, 400))
    assert early.read_bytes() != late.read_bytes()
    assert viewer.screenshot([no_impact], tmp_path / "c.png", size=(400, 300)).stat().st_size > 10_000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "b.png", "c.png"]


def test_no_vulkan_is_one_line_with_a_remedy(recording, tmp_path, monkeypatch):
    for name in ("VK_ICD_FILENAMES", "VK_DRIVER_FILES"):
        monkeypatch.setenv(name, str(tmp_path / "none.json"))
    message = r"no graphics adapter.*apt-get install mesa-vulkan-drivers"
    with pytest.raises(ViewerError, match=message) as caught, headless(recording, (400, 300)):
        pass
    assert "\n" not in str(caught.value)


def test_viewer_that_stops_answering_is_told(recording):
    def kill_and_ask(client):
        (process,) = viewers()
        process.kill()
        process.wait()
        client.get_state()

    with pytest.raises(ViewerError, match="stopped answering"), headless(recording, (400, 300)) as client:
        kill_and_ask(client)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems always have a display")
def test_no_display_is_one_line_with_a_remedy(settled, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(ViewerError, match=r"needs a display.*--png FILE"):
        viewer.view([settled])
    monkeypatch.setenv("DISPLAY", ":987")
    with pytest.raises(ViewerError, match=r"ended with status.*X server.*--save") as caught:
        viewer.view([settled])
    assert "\n" not in str(caught.value)
