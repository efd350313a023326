"""Ingest: what is refused, with its reason; what is kept; and that a second time does nothing."""

import json
import shutil

import msgspec
import numpy as np
import pytest

from vines.errors import FileMissingError, RigError, StoreError
from vines.places import shipped
from vines.rig import init_run, read_folder, read_run
from vines.rig.formats import RawChannel
from vines.rig.ingest._calibrate import calibrate
from vines.rig.ingest._run_form import schemas
from vines.rig.ingest._sampling import even_rate
from vines.rig.synth import RigSettings, simulate_rig
from vines.rig.units import volts_per_unit


@pytest.fixture
def run(short_run, tmp_path):
    """Return a copy of the run folder that may be changed."""
    return shutil.copytree(short_run[0], tmp_path / "run_1")


def edit(run, column, value, channel="lo_acc"):
    head, *rows = (run / "channels.tsv").read_text().splitlines()
    place = head.split("\t").index(column)
    changed = []
    for row in rows:
        cells = row.split("\t")
        if cells[0] == channel:
            cells[place] = value
        changed.append("\t".join(cells))
    (run / "channels.tsv").write_text("\n".join([head, *changed]) + "\n")


@pytest.mark.parametrize(
    ("column", "value", "reason"),
    [
        ("unit", "n/a", "no unit"),
        ("sign", "n/a", "no sign"),
        ("fs", "n/a", "no sampling rate"),
        ("sensitivity", "n/a", "no sensitivity"),
        ("sensitivity_unit", "n/a", "no sensitivity unit"),
        ("range", "n/a", "no range"),
        ("group_delay", "n/a", "no group delay"),
        ("u_sensitivity", "n/a", "no uncertainty"),
        ("unit", "furlong", "not known"),
        ("unit", "mV", "the file says V"),
        ("unit", "g", "the file says V"),
        ("sensitivity_unit", "mV/mm", "is of a sensor of displacement"),
        ("sensitivity_unit", "pC/g", "not one of volts"),
        ("sensitivity", "-100", "positive"),
        ("sensitivity", "scaled", "give its sensitivity"),
        ("fs", "25600", "one of them is wrong"),
        ("sign", "-1", "opposite signs"),
        ("sensitivity", "1000", "unit or a sensitivity is wrong"),
        ("role", "lo_disp", "is a displacement"),
        ("field", "daq/nothing", "no field"),
        ("file", "../run.json", "not below raw/"),
        ("group_delay", "soon", "no number"),
        ("range", "0.05", "are clipped"),
    ],
)
def test_refused_with_the_reason(run, column, value, reason):
    edit(run, column, value)
    with pytest.raises(RigError, match=reason) as caught:
        read_run(run)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value", "reason"),
    [
        ("M", None, "M"),
        ("temprature_before", 1, "temperature_before"),
        ("protocol", "walk", "protocol"),
        ("f_cmd", 9.9, "f_cmd"),
        ("E_cmd", 0.01, "E_cmd"),
        ("b", {"value": -1.0, "u": 0.1}, "b > 0"),
        ("f_cmd", None, "ringdown"),
    ],
)
def test_a_wrong_run_is_refused(run, key, value, reason):
    form = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps({**form, key: value}))
    with pytest.raises(RigError, match=reason):
        read_run(run)


def test_a_changed_raw_file_is_refused(run):
    folder = read_folder(run)
    (run / "SHA256SUMS").write_text("0" * 64 + f"  raw/{folder.rows[0].file}\n")
    with pytest.raises(RigError, match="not the file that was recorded"):
        read_run(run)
    (run / "raw" / folder.rows[0].file).unlink()
    with pytest.raises(FileMissingError, match="is missing"):
        read_run(run)


@pytest.mark.parametrize("channel", ["base_disp", "base_acc", "lo_disp", "lo_acc"])
@pytest.mark.parametrize("fault", ["sign", "unit"])
def test_planted_faults_are_seen_where_two_channels_saw_one_motion(fault, channel):
    with pytest.raises(RigError):
        simulate_rig(RigSettings(duration=4.0, settle=1.0, rate=12800.0, fault=fault, fault_channel=channel), 2)


def test_lost_samples_are_seen():
    with pytest.raises(RigError, match="jumps by about"):
        simulate_rig(RigSettings(duration=30.0, settle=1.0, rate=12800.0, fault="clock"), 2)


def test_separate_clocks_need_something_shared(short_run):
    folder = read_folder(short_run[0])
    rows = tuple(msgspec.structs.replace(row, recorder="b" if row.name == "lo_disp" else "a") for row in folder.rows)
    from vines.rig.formats import read_file
    from vines.rig.ingest._read_run import assemble

    files = {rows[0].file: read_file(folder.raw_files[0])}
    with pytest.raises(RigError, match="share no moving signal"):
        assemble(folder.form, rows, files, {})


def test_a_gap_in_the_time_stamps():
    times = np.arange(1000) / 1000.0
    assert even_rate(np.round(times, 6), "a") == pytest.approx(1000.0, rel=1e-6)
    times[500:] += 0.01
    with pytest.raises(RigError, match="sample 500 is 10 sampling intervals off"):
        even_rate(times, "a")


def test_clipped_samples_are_flagged_and_nan_refused(short_run):
    row = msgspec.structs.replace(read_folder(short_run[0]).rows[2], t0=0.0, high_pass=0.0)
    values = np.sin(np.arange(20000) / 50.0)
    values[5000:5020] = 10.0
    found = calibrate(row, RawChannel("a", values, "V", row.fs), max_clipped=0.01)
    assert found.clipped == 20
    assert not found.valid[4998:5022].any()
    assert found.valid.sum() == 20000 - 24
    values[7] = np.nan
    with pytest.raises(RigError, match="1 of 20000 samples are NaN"):
        calibrate(row, RawChannel("a", values, "V", row.fs), max_clipped=0.01)


def test_high_pass_is_undone(short_run):
    """Against the filter itself: what went in comes out, but for its mean."""
    from scipy.signal import lfilter

    row = msgspec.structs.replace(
        read_folder(short_run[0]).rows[1],
        high_pass=0.8,
        sensitivity="scaled",
        sensitivity_unit="",
        unit="m/s^2",
        range=50.0,
    )
    rate, f = row.fs, 8.8
    t = np.arange(round(20 * rate)) / rate
    true = np.sin(2 * np.pi * f * t) + 0.2 * np.sin(6 * np.pi * f * t + 1)
    a = np.exp(-2 * np.pi * 0.8 / rate)
    passed = lfilter([0.5 * (1 + a), -0.5 * (1 + a)], [1.0, -a], true)
    found = calibrate(row, RawChannel("a", passed, "m/s^2", rate), max_clipped=0.01)
    late = slice(len(t) // 4, -len(t) // 4)
    assert np.abs(found.values[late] - true[late] - np.mean(found.values[late] - true[late])).max() < 5e-3
    assert np.abs(passed[late] - true[late]).max() > 0.08


def test_units():
    assert volts_per_unit(100.0, "mV/g")[1] == pytest.approx(0.1 / 9.80665)
    assert volts_per_unit(10.0, "mV/(m/s^2)") == ("acceleration", 0.01)
    assert volts_per_unit(10.0, "mV/m/s^2") == ("acceleration", 0.01)
    assert volts_per_unit(2.0, "um/V") == ("displacement", 5e5)


def test_schemas_follow_the_types():
    for name, text in schemas().items():
        assert (shipped("schemas") / "rig" / name).read_text("utf-8") == text


def test_template_says_what_is_missing(tmp_path):
    written = init_run(tmp_path / "new").files
    assert [path.name for path in written] == ["run.json", "channels.tsv", "README.md"]
    with pytest.raises(StoreError, match="exists already"):
        init_run(tmp_path / "new")
    with pytest.raises(RigError, match=r"run\.json"):
        read_folder(tmp_path / "new")


def test_ingest_keeps_raw_files_and_a_second_time_does_nothing(run, project):
    from vines import logs

    first = project.process("rig", "ingest", run)
    assert "1 run ingested" in first.stdout
    rows = json.loads(project.vines("query", "select * from rig_channels", "--format", "json").stdout)
    assert [row["channel"] for row in rows] == ["base_disp", "base_acc", "lo_disp", "lo_acc"]
    (kept,) = project.data.glob("results/*/runs/*/raw/run.tdms")
    assert kept.read_bytes() == (run / "raw" / "run.tdms").read_bytes()
    assert rows[0]["sha256"] in (kept.parent.parent / "SHA256SUMS").read_text()
    assert read_run(kept.parent.parent).recording.sha256
    (log,) = project.data.glob("results/*/*.mcap")
    assert set(logs.read(log).sensors) == {"base_disp", "base_acc", "lo_disp", "lo_acc"}
    seen = project.vines("view", "rig_run_1.ingest", "--save", project.root / "run.rrd")
    assert "wrote" in seen.stdout
    assert (project.root / "run.rrd").stat().st_size > 100_000
    before = sorted(path.stat().st_mtime_ns for path in project.data.glob("results/*"))
    again = project.vines("rig", "ingest", run)
    assert "nothing to do" in again.stdout
    assert sorted(path.stat().st_mtime_ns for path in project.data.glob("results/*")) == before
    edit(run, "sign", "-1")
    refused = project.vines("rig", "ingest", run, check=False)
    assert refused.returncode == 2
    assert "opposite signs" in refused.stderr
    assert refused.stderr.count("\n") == 1
