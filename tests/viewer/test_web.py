"""The web viewer in a real browser, and the catalogue of many logs: offline, on this machine only, and shown."""

import io
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from urllib.request import urlopen

import matplotlib.image
import psutil
import pytest

from tests.viewer.chromium import chromium
from vines import viewer
from vines.errors import ViewerError
from vines.viewer._program import served

pytestmark = pytest.mark.long(8)


def listening():
    """Return the addresses on which this process and its children listen."""
    mine = [psutil.Process(), *psutil.Process().children(recursive=True)]
    return {
        each.laddr.ip
        for process in mine
        for each in process.net_connections("inet")
        if each.status == psutil.CONN_LISTEN
    }


def both_ends(picture):
    """Say whether a picture shows the red left end and the blue right end of the cavity."""
    drawn = (matplotlib.image.imread(io.BytesIO(picture))[..., :3] * 255).round()
    red = (drawn[..., 0] > 200) & (drawn[..., 1] < 120) & (drawn[..., 2] < 120)
    blue = (drawn[..., 2] > 200) & (drawn[..., 0] < 120)
    return min(red.sum(), blue.sum()) > 500


def test_the_page_is_served_on_this_machine_with_a_policy_that_lets_nothing_out(settled, tmp_path):
    with served(viewer.save_rrd([settled], tmp_path / "run.rrd")) as (url, _):
        assert url.startswith("http://127.0.0.1:")
        assert listening() == {"127.0.0.1"}
        with urlopen(url) as page:
            policy, text = page.headers["Content-Security-Policy"], page.read().decode()
    hosts = {each for each in policy.replace(";", " ").split() if "//" in each}
    assert hosts == {"http://127.0.0.1:*"}
    assert policy.startswith("default-src 'self';")
    assert "re_viewer" in text


@pytest.mark.full
def test_web_viewer_in_chromium(settled, tmp_path, browser_program):
    recording = viewer.save_rrd([settled], tmp_path / "run.rrd")
    with served(recording) as (url, _):
        assert url.startswith("http://127.0.0.1:")
        assert listening() == {"127.0.0.1"}
        with chromium(browser_program, size=(1000, 600)) as browser:
            browser.open(url)
            browser.until(both_ends)  # else out of time: a page without views may look finished too
            asked = browser.asked()
    # Fonts, versions, examples and usage data of Rerun's makers are kept back.
    assert [address for address in asked if not address.startswith(("http://127.0.0.1:", "data:", "blob:"))] == []


def test_catalogue_has_parameters_and_attractors_as_columns(settled, chatter, tmp_path):
    client = pytest.importorskip("rerun.catalog").CatalogClient
    stages = {settled.resolve(): "quickstart.settled"}
    with viewer.catalogue_of([settled, chatter], tmp_path / "cache", stages) as address:
        assert listening() == {"127.0.0.1"}
        root, _, entry = address.partition("/entry/")
        dataset = client(root).get_dataset(name="runs")
        assert str(dataset.id) == entry
        rows = dataset.segment_table().to_pandas()
    assert len(rows) == 2
    one = rows.set_index(rows["property:vines:log"].map(lambda value: value[0]))
    assert one.loc["chatter.mcap", "property:given:mu"] == [0.0084]
    assert one.loc["settled.mcap", "property:got:attractor"] == ["1:1"]
    assert one.loc["settled.mcap", ["property:from:pipeline", "property:from:stage"]].tolist() == [
        ["quickstart"],
        ["settled"],
    ]
    assert one.loc["chatter.mcap", "property:from:stage"] == [""]
    assert one.loc["chatter.mcap", "property:got:sticks"][0] >= 1
    assert [path.suffix for path in (tmp_path / "cache").iterdir()] == [".rrd", ".rrd"]


def test_nothing_to_browse_is_said(tmp_path):
    with pytest.raises(ViewerError, match="no logs to browse"), viewer.catalogue_of([], tmp_path):
        pass


def test_cache_is_made_again_when_log_or_layout_changes(settled, chatter, tmp_path, monkeypatch):
    log, cache = tmp_path / "run.mcap", tmp_path / "cache"
    shutil.copy(settled, log)
    first = viewer.cached_rrd([log], cache)
    made = first.stat().st_mtime_ns
    assert viewer.cached_rrd([log], cache) == first
    assert first.stat().st_mtime_ns == made
    first.unlink()
    first = viewer.cached_rrd([log], cache)
    assert first.is_file()
    # A recording that was cut or altered is not shown as if it were whole.
    whole = first.read_bytes()
    for hurt in (whole[: len(whole) // 2], whole[:-1] + bytes([whole[-1] ^ 1]), b""):
        first.write_bytes(hurt)
        first = viewer.cached_rrd([log], cache)
        assert list(cache.iterdir()) == [first]
        assert first.stat().st_size > len(whole) // 2

    shutil.copy(chatter, log)
    second = viewer.cached_rrd([log], cache)
    assert second != first
    assert list(cache.iterdir()) == [second]

    monkeypatch.setattr("vines.viewer._cache._drawing", lambda: "another layout")
    third = viewer.cached_rrd([log], cache)
    assert list(cache.iterdir()) == [third]
    assert third != second
    both = viewer.cached_rrd([log, settled], cache)
    assert sorted(cache.iterdir()) == sorted([third, both])


def test_server_that_cannot_start_is_told(tmp_path):
    with pytest.raises(ViewerError, match="ended with status"), served(Path(tmp_path / "none.rrd")):
        pass


def test_sigterm_ends_the_server_too(settled):
    """What a batch system or `timeout` sends must not leave Rerun's server behind."""
    command = [sys.executable, "-m", "vines.cli", "view", str(settled), "--web"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert "open http://127.0.0.1:" in process.stdout.readline()
        servers = psutil.Process(process.pid).children(recursive=True)
        assert servers
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=60) == 0
    assert psutil.wait_procs(servers, timeout=60)[1] == []
