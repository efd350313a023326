"""A log that is written while its run goes on, and what is left of it when its process is killed."""

import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from mcap.reader import make_reader

from tests.logs.conftest import made_up
from vines import logs
from vines.errors import FileMissingError, LogError, SchemaError
from vines.logs._live import _EVERY

ABOUT = {"provenance": {"by": "a test"}, "parameters": {"A": 0.02}, "name": "live"}


def test_live_log_reads_as_any_other(run, tmp_path):
    path = tmp_path / "live.mcap"
    with logs.LiveWriter(path, **ABOUT, declaration="x = 1\n") as live:
        for part in np.array_split(run["states"], 40):
            live.add("states", part)
        live.add("impacts", run["impacts"])
        for row in run["sticks"]:
            live.add("sticks", row)
        assert not path.exists()
    log = logs.read(path)
    assert log.complete
    for key in ("states", "impacts", "sticks"):
        for name in run[key].dtype.names:
            np.testing.assert_array_equal(getattr(log, key)[name].to_numpy(), run[key][name])
    assert (log.name, log.declaration, log.parameters) == ("live", "x = 1\n", {"A": 0.02})
    assert list(tmp_path.iterdir()) == [path]
    with path.open("rb") as stream:
        read = list(make_reader(stream, validate_crcs=True).iter_messages())
    ours = ("/state", "/impact", "/stick")
    assert sum(channel.topic in ours for _, channel, _ in read) == 3043
    assert {channel.topic for _, channel, _ in read} - set(ours) >= {
        "/robot_description",
        "/tf",
        "/curves",
        "/impact_log",
    }
    assert [m.sequence for _, c, m in read if c.topic == "/state"] == list(range(3000))


def test_wrong_use_is_told(run, tmp_path):
    path = tmp_path / "live.mcap"
    with logs.LiveWriter(path, **ABOUT) as live:
        live.add("states", run["states"][10:])
        with pytest.raises(SchemaError, match="before the last one"):
            live.add("states", run["states"][:10])
        with pytest.raises(SchemaError, match="no channel 'state'; it has states, impacts, sticks"):
            live.add("state", run["states"])
        with pytest.raises(LogError, match="another process writes it"):
            logs.LiveWriter(path, **ABOUT)
    with pytest.raises(LogError, match="is finished"):
        live.add("states", run["states"][10:])
    with pytest.raises(FileMissingError, match="does not exist"):
        logs.LiveWriter(tmp_path / "no" / "x.mcap", **ABOUT)


def test_run_that_fails_leaves_a_part_to_recover(run, tmp_path):
    path = tmp_path / "live.mcap"

    def fail():
        with logs.LiveWriter(path, **ABOUT) as live:
            live.add("states", run["states"])
            raise RuntimeError("the run failed")

    with pytest.raises(RuntimeError, match="the run failed"):
        fail()
    assert not path.exists()
    part = tmp_path / "live.mcap.part"
    with pytest.raises(LogError, match="cut short"):
        logs.read(part)
    said = logs.recover(part)
    assert said.path == tmp_path / "live.recovered.mcap"
    assert logs.read(said.path).states.num_rows == 3000


WRITER = """
import sys, time
import numpy as np
from vines import logs
from vines.schema import numpy_dtype
row = np.zeros(1, numpy_dtype("vines.v1.State"))
with logs.LiveWriter(sys.argv[1], name="killed", provenance={}, parameters={}) as live:
    while True:
        row["t"] += 0.002
        live.add("states", row)
        print(row["t"][0], flush=True)
        time.sleep(0.002)
"""


def test_killed_process_loses_what_was_not_written_yet(tmp_path):
    path, partial = tmp_path / "killed.mcap", tmp_path / "killed.mcap.part"
    with subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True) as process:
        told, sizes = [], set()
        while len(sizes) < 4:  # of the head, and of what the writer's thread adds now and then
            told.append(process.stdout.readline())
            sizes.add(partial.stat().st_size)
        process.send_signal(signal.SIGKILL)
        told += process.stdout.read().split()
    log = logs.read(logs.recover(partial).path)
    saved = log.states["t"].to_numpy()
    assert 0 < len(saved) <= len(told) + 1  # killed before it told of a row
    assert _EVERY < 1.0  # seconds, as promised
    # Whole up to there: nothing in the middle is missing.
    np.testing.assert_array_equal(saved[: len(told)], [float(text) for text in told[: len(saved)]])


def test_live_log_of_a_rig(tmp_path):
    samples = made_up("vines.v1.SensorSample", 500, "t", 7)
    about = {"quantity": "acceleration", "unit": "m/s^2", "sign": "positive to the right", "rate": "51200"}
    with logs.LiveWriter(tmp_path / "rig.mcap", **ABOUT, sensors={"acc": about}) as live:
        live.add("acc", samples)
    log = logs.read(tmp_path / "rig.mcap")
    assert log.kind == "rig"
    np.testing.assert_array_equal(log.sensors["acc"]["value"].to_numpy(), samples["value"])


def test_what_is_added_is_synced_to_disk_at_the_stated_interval(run, tmp_path, monkeypatch):
    """A file that is only flushed is lost with the machine: what the writer's thread wrote, it has synced."""
    path, synced, real = tmp_path / "live.mcap", threading.Event(), os.fsync
    sizes: list[int] = []

    def fsync(number):
        sizes.append(os.fstat(number).st_size)
        if len(sizes) > 1:
            synced.set()
        real(number)

    monkeypatch.setattr(os, "fsync", fsync)
    with logs.LiveWriter(path, **ABOUT) as live:
        head = sizes[0]
        live.add("states", run["states"][:10])
        assert synced.wait(60)
        assert sizes[1] > head == sizes[0]
