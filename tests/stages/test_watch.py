"""A rig that is watched: its log is a run, whole after Ctrl-C and but for a second when the process is killed."""

import json
import signal
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from tests.rig.watch.test_sources import recording
from vines import logs
from vines.cli._rig import command
from vines.errors import PackageMissingError, VinesError
from vines.rig import read_run
from vines.rig.ingest import Cells
from vines.rig.synth import RigSettings
from vines.rig.watch import Block, FolderSource, Stream, SynthSource, channels_of
from vines.stages import watch_rig
from vines.stages.rig import _foxglove

RATE = 2000.0
SHARED = {"unit": "m/s^2", "sign": "+1", "range": "100"}
ROWS = [Cells({"name": role, "role": role, **SHARED}, "test") for role in ("base_acc", "lo_acc")]


class Told:
    def __init__(self):
        self.reports, self.remarks, self.done = [], [], []

    def began(self, stream, log):
        self.log = log

    def report(self, report):
        self.reports.append(report)

    def remark(self, text):
        self.remarks.append(text)

    def ended(self, watched):
        self.done.append(watched)


class Fast:
    """A source that gives so many seconds at once, and then what is asked for."""

    live = True

    def __init__(self, seconds, end=None):
        t = np.arange(round(seconds * RATE)) / RATE
        self.values = np.stack([np.sin(55 * t), 3 * np.sin(55 * t + 0.3)]).astype("<f4")
        self.end, self.closed = end, False

    def streams(self):
        yield None
        yield Stream("fast", channels_of(ROWS), RATE, self.blocks(), run={"start_utc": "2026-01-05T09:00:00Z"})

    def blocks(self):
        for first in range(0, self.values.shape[1], 130):
            yield Block(first, self.values[:, first : first + 130])
        if self.end is not None:
            raise self.end

    def close(self):
        self.closed = True


def test_ctrl_c_leaves_a_complete_log_of_every_sample(tmp_path):
    source, told = Fast(3.2, KeyboardInterrupt()), Told()
    (watched,) = watch_rig(source, told, out=tmp_path)
    log = logs.read(watched.log)
    assert (log.complete, log.kind, source.closed) == (True, "rig", True)
    for name, sent in zip(("base_acc", "lo_acc"), source.values, strict=True):
        np.testing.assert_array_equal(log.raw[name].values, sent)
    assert [each.t for each in told.reports] == pytest.approx([1.0, 2.0, 3.0], abs=0.066)
    lines = (watched.folder / "derived" / "watch.jsonl").read_text().splitlines()
    assert [json.loads(line)["t"] for line in lines] == [each.t for each in told.reports]
    form = json.loads((watched.folder / "run.json").read_text())
    assert form["start_utc"] == "2026-01-05T09:00:00Z"
    assert form["f_cmd"] == pytest.approx(55 / (2 * np.pi), rel=1e-3)
    assert form["proposed"]["f_cmd"]["by"].startswith("recording ")
    assert "M" in watched.missing
    (again,) = watch_rig(Fast(0.5), Told(), out=tmp_path)
    assert again.folder.name == "fast_2"


def test_a_run_that_was_watched_is_read_as_any_other(tmp_path):
    """What the synthetic rig states goes all the way; the samples that ingest reads are those that were sent."""
    source = SynthSource(RigSettings(rate=12800.0, settle=2.0, run_id="up"), 1, speed=float("inf"))
    told = Told()
    (watched,) = watch_rig(source, told, out=tmp_path, seconds=3.0)
    assert watched.missing == ()
    found = read_run(watched.folder)
    assert found.recording.run.run_id == "up"
    channel = found.recording.role("lo_disp")
    raw = logs.read(watched.log).raw["lo_disp"]
    row = found.rows["lo_disp"]
    np.testing.assert_allclose(channel.values, raw.values / row.sensitivity * 1e-3, rtol=1e-6, atol=1e-12)
    assert len(channel.values) == round(3.0 * 12800)
    assert channel.start == pytest.approx(-row.group_delay)


def test_only_what_comes_after_the_transient_is_logged_if_asked_for(tmp_path):
    source = SynthSource(RigSettings(rate=3200.0, settle=0.0, sigma_r=0.005), 3, speed=float("inf"))
    told = Told()
    (watched,) = watch_rig(source, told, out=tmp_path, seconds=1.0, settled_first=True, memory=source.memory)
    form = json.loads((watched.folder / "run.json").read_text())
    log = logs.read(watched.log)
    assert 9.0 < form["settle"] < 40.0
    assert log.raw["lo_acc"].start == 0.0
    assert len(log.raw["lo_acc"].values) == pytest.approx(3200, abs=330)
    assert any(line.startswith("settled after") for line in told.remarks)


def test_in_a_campaign_a_run_states_only_what_is_its_own(tmp_path):
    (tmp_path / "rig.json").write_text("{}")
    (watched,) = watch_rig(Fast(1.2), Told(), out=tmp_path, name="up_7")
    form = json.loads((watched.folder / "run.json").read_text())
    assert "M" not in form
    head = [line for line in (watched.folder / "channels.tsv").read_text().splitlines() if not line.startswith("#")]
    assert head[0].split("\t") == ["name", "file", "field"]
    with pytest.raises(VinesError, match="nothing is overwritten: give another --name"):
        watch_rig(Fast(1.2), Told(), out=tmp_path, name="up_7")


def test_lost_samples_reach_ingest_as_out_of_range(tmp_path):
    source = Fast(2.0)
    source.blocks = lambda: (each for k, each in enumerate(Fast.blocks(source)) if k != 7)
    (watched,) = watch_rig(source, Told(), out=tmp_path)
    from vines.rig.formats import read_file

    found = read_file(watched.log)
    assert watched.report.lost == 130
    assert found.remarks == ("base_acc: 130 samples were lost", "lo_acc: 130 samples were lost")
    assert (found.channel("lo_acc").values == 105.0).sum() == 130


def test_files_get_logs_and_one_that_cannot_be_read_does_not_stop_the_others(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "a.tdms").write_bytes(b"TDSm")
    recording(folder / "b.tdms", 2.5)
    source, told = FolderSource(folder, steady=0.0, present=True), Told()
    plain = source.streams

    def until_idle():
        last = 0
        for each in plain():
            last = 0 if each is not None else last + 1
            if last > 3:
                return
            yield each

    source.streams = until_idle
    (watched,) = watch_rig(source, told, out=tmp_path / "logs")
    assert watched.log == tmp_path / "logs" / "b.mcap"
    assert any("a.tdms" in line for line in told.remarks)
    log = logs.read(watched.log)
    assert set(log.sensors) == {"base_acc", "lo_acc"}
    assert (log.raw, len(told.reports)) == ({}, 2)


KILLED = """
import sys, time
from pathlib import Path
from tests.stages.test_watch import Fast, Told
from vines.stages import watch_rig
class Paced(Fast):
    def blocks(self):
        for block in super().blocks():
            yield block
            print(block.first + block.values.shape[1], flush=True)
            time.sleep(0.065)
watch_rig(Paced(600.0), Told(), out=Path(sys.argv[1]))
"""


def test_a_killed_watch_loses_a_second_at_most(tmp_path):
    with subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path)], stdout=subprocess.PIPE, text=True) as process:
        told = [int(process.stdout.readline()) for _ in range(25)]
        process.send_signal(signal.SIGKILL)
        told += [int(line) for line in process.stdout.read().split()]
    raw = tmp_path / "fast" / "raw"
    saved = logs.recover(raw / "fast.mcap.part", raw / "fast.mcap").path
    found = logs.read(saved).raw["lo_acc"].values
    assert told[-1] - RATE <= len(found) <= told[-1] + 130
    np.testing.assert_array_equal(found, Fast(600.0).values[1, : len(found)])


def test_wrong_use_is_one_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for arguments, said in (
        (["no_folder", "--no-view"], "there is no such folder"),
        (["synth:", "--no-view", "--web"], "exclude each other"),
        (["synth:", "--save", "a.png"], "ends in .rrd"),
        (["synth:", "--no-view", "--set", "rat=3"], "did you mean 'rate'"),
        (["synth:", "--no-view", "--set", "rate=3"], "rate is 3 samples a second"),
        (["synth:", "--no-view", "--set", "recorders=2"], "recorders is 2, allowed is 1"),
        ([".", "--no-view", "--set", "rate=3"], "--set is for the synthetic rig"),
        (["ni://Dev1/ai0?rate=51200", "--no-view"], "a device of National Instruments needs nidaqmx"),
    ):
        result = CliRunner().invoke(command, ["watch", *arguments])
        told = str(result.exception) if isinstance(result.exception, VinesError) else result.output
        assert said in told, (arguments, told)
        assert "Traceback" not in told
    assert list(tmp_path.iterdir()) == []


def test_foxglove_that_is_not_there_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "foxglove", None)
    with pytest.raises(PackageMissingError, match="serving Foxglove needs foxglove-sdk"), _foxglove.foxglove_server(1):
        pass


def test_lines_and_json_say_the_same(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    light = ["--no-view", "--set", "rate=3200", "--speed", "1000", "--seconds", "1.5"]
    lines = CliRunner().invoke(command, ["watch", "synth:", *light], catch_exceptions=False).output.splitlines()
    assert lines[0].startswith("watching synthetic: base_disp, base_acc, lo_disp, lo_acc at 3200 Hz, logged to ")
    assert lines[1].startswith("0:01  E 0.22")
    assert lines[-1].startswith("  vines rig compare watched/synthetic")
    said = CliRunner().invoke(command, ["watch", "synth:", *light, "--json"], catch_exceptions=False).output
    told = [json.loads(line) for line in said.splitlines()]
    assert [next(iter(each)) for each in told] == ["watching", "t", "ended"]
    assert told[-1]["folder"] == "watched/synthetic_2"
    assert (tmp_path / "watched" / "synthetic_2" / "run.json").is_file()
