"""What is stated against what a file says: overruled with a reason, or refused with run, channel and file."""

import json

import numpy as np
import pytest

from vines.errors import RigError
from vines.rig import read_run
from vines.rig.records import channel_rows

RUN = {
    "run_id": "ring_1", "start_utc": "2026-03-02T09:00:00Z", "protocol": "ringdown", "f_cmd": None, "E_cmd": None,
    "settle": 0.0, "M": {"value": 3.8, "u": 0.002}, "m": {"value": 0.032, "u": 1e-5}, "b": {"value": 0.015, "u": 5e-5},
    "ball": False, "temperature_before": 20.0, "temperature_after": 20.0,
}  # fmt: skip
ROW = {
    "name": "lo", "role": "lo_disp", "quantity": "displacement", "file": "rec.csv", "field": "lo", "unit": "V",
    "sensitivity": "0.5", "sensitivity_unit": "V/mm", "u_sensitivity": "0.002", "sign": "+1", "fs": "file", "t0": "0",
    "range": "10", "group_delay": "0",
}  # fmt: skip
RATE = 10240.0
T = np.arange(4096) / RATE
VOLTS = 3 * np.cos(2 * np.pi * 8.8 * T) * np.exp(-T)


@pytest.fixture
def ingest(tmp_path):
    """Return a function that writes a run of one file and reads it."""

    def read(text, *others, **changed):
        (tmp_path / "raw").mkdir(exist_ok=True)
        (tmp_path / "raw" / "rec.csv").write_text(text)
        (tmp_path / "run.json").write_text(json.dumps(RUN))
        rows = [{**ROW, **changed}, *({**ROW, **other} for other in others)]
        names = list(dict.fromkeys(name for row in rows for name in row))
        lines = ["\t".join(names), *("\t".join(row.get(name, "n/a") for name in names) for row in rows)]
        (tmp_path / "channels.tsv").write_text("\n".join(lines) + "\n")
        return read_run(tmp_path)

    return read


def table(head="Time [s],lo [V]", form="{t:.8f},{v:.5f}", start=0.0, tick=1.0, values=VOLTS):
    return f"{head}\n" + "".join(form.format(t=start + t / tick, v=v) + "\n" for t, v in zip(T, values, strict=True))


def check(run, rate=RATE):
    channel = run.recording.channels["lo"]
    assert channel.rate == pytest.approx(rate, rel=2e-5)
    np.testing.assert_allclose(channel.values, VOLTS / 500, atol=1e-7)
    return channel_rows(run)[0]


@pytest.mark.parametrize(
    ("text", "changed", "overruled"),
    [
        (
            table("Time [s],lo [furlong]"),
            {"overrule": "unit: a slip of the pen"},
            "unit: the file says furlong, V is taken",
        ),
        (
            table("Time [s],lo [mm]"),
            {"overrule": "unit: the scale was off"},
            "unit: the file says mm, V is taken: the scale",
        ),
        (
            table("Time [s],lo [V]", tick=1e-3),
            {"fs": "10240", "overrule": "fs: the axis is in ms"},
            "fs: the file says 10.24",
        ),
        (
            "# sampling_rate: 1.0\nlo [V]\n" + "".join(f"{v:.5f}\n" for v in VOLTS),
            {"fs": "10240", "overrule": "fs: wf_increment is 1; unit: not needed"},
            "fs: the file says 1 Hz, 10240 is taken: wf_increment is 1",
        ),
        (
            table(form="{t:.3f},{v:.5f}").replace("0.200,", "0.290,"),
            {"fs": "10240", "overrule": "fs: the clock of the computer"},
            "fs: time stamps are not even",
        ),
    ],
)
def test_what_a_file_says_wrongly_is_overruled_with_a_reason_in_the_table(ingest, text, changed, overruled):
    row = check(ingest(text, **changed))
    assert row["overruled"].startswith(overruled)
    reason = changed["overrule"].partition(": ")[2].partition(";")[0]
    assert row["overruled"].endswith(reason)
    assert row["read_as"].startswith("CSV encoding=utf-8 separator=")
    without = {key: value for key, value in changed.items() if key != "overrule"}
    with pytest.raises(RigError, match=r"run ring_1: lo \(raw/rec\.csv, lo\): .*overrule|uneven|not even") as caught:
        ingest(text, **without)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("form", "start"), [("{t:.3f},{v:.5f}", 0.0), ("{t:.6g},{v:.5f}", 20.0), ("{t:.4f},{v:.5f}", 7.0)]
)
def test_rounded_stamps_leave_the_rate_open_and_agree_with_one_that_is_stated(ingest, form, start):
    text = table(form=form, start=start)
    with pytest.raises(
        RigError, match=r"run ring_1: lo \(raw/rec\.csv, lo\): .*rounded and tell the rate.*write fs in Hz"
    ):
        ingest(text)
    check(ingest(text, fs="10240"))
    with pytest.raises(RigError, match="one of them is wrong"):
        ingest(text, fs="10400")


def test_a_lost_row_is_seen_in_stamps_that_are_exact(ingest):
    lines = table().splitlines(keepends=True)
    del lines[2000]
    for fs in ("file", "10240"):
        with pytest.raises(RigError, match="sample 1999 is 1 sampling intervals off"):
            ingest("".join(lines), fs=fs)


def test_times_without_a_unit_are_never_seconds(ingest):
    for tick, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us")):
        text = table("Time,lo [V]", tick=tick)
        with pytest.raises(RigError, match="its times have no unit: write time_unit=s"):
            ingest(text)
        assert check(ingest(text, fs="10240"))["remarks"].endswith(f"times without a unit fit fs as {unit}")
        check(ingest(text, dialect=f"time_unit={unit}"))
    with pytest.raises(RigError, match="in none of s, ms, us"):
        ingest(table("Time,lo [V]", tick=7.0), fs="10240")


def test_counts_need_what_one_count_is(ingest):
    text = table("Time [s],lo [counts]", "{t:.8f},{v:.0f}", values=np.round(VOLTS / 1e-4))
    with pytest.raises(RigError, match="the file says counts; write what one count is into scale"):
        ingest(text)
    run = ingest(text, scale="1e-4", offset="0.5")
    np.testing.assert_allclose(run.recording.channels["lo"].values, (VOLTS + 0.5) / 500, atol=2e-7)
    with pytest.raises(RigError, match="but the file holds V and no counts"):
        ingest(table(), scale="1e-4")


def test_a_layout_is_stated_once_a_file(ingest):
    both = "".join(f"{512 + k % 7},{v:.0f}\n" for k, v in enumerate(3500 + 1000 * VOLTS))
    other = {"name": "base", "role": "base_disp", "field": "1"}
    with pytest.raises(RigError, match=r"run ring_1: lo, base: raw/rec\.csv: a comma in .* may part two columns"):
        ingest(both, other, fs="10240", field="2", scale="1e-3")
    stated = {"dialect": "separator=comma decimal=point"}
    ingest(both, {**other, "fs": "10240", "scale": "1e-3"}, fs="10240", field="2", scale="1e-3", **stated)
    with pytest.raises(RigError, match=r"lo, base .* state 2 dialects"):
        ingest(both, {**other, "dialect": "separator=tab"}, fs="10240", field="2", **stated)


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"overrule": "unit"}, "write the reason behind unit"),
        ({"overrule": "rate: it is wrong"}, "KEY is"),
        ({"scale": "0"}, "scale is 0"),
        ({"scale": "much"}, "scale is 'much', which is no number"),
        ({"dialect": "separator=slash"}, "allowed for separator are comma"),
        ({"dialect": "colour=red"}, "no such key"),
        ({"dialect": "time_unit=V"}, "no unit of time"),
        ({"dialect": "time=9"}, "there are 2 columns"),
        ({"unit": "furlong"}, r"run ring_1: lo \(raw/rec.csv, lo\): channels.tsv: unit 'furlong' is not known"),
        ({"field": "low"}, r"run ring_1: lo \(raw/rec.csv, low\): there is no field 'low'"),
    ],
)
def test_what_is_stated_wrongly(ingest, changed, reason):
    with pytest.raises(RigError, match=reason) as caught:
        ingest(table(), **changed)
    assert "\n" not in str(caught.value)
