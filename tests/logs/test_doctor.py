"""Every kind of log that vines writes is one that `mcap doctor` finds nothing wrong with."""

import struct

import numpy as np
import pytest

from tests.logs.conftest import made_up
from tests.logs.doctor import findings
from vines import logs

ABOUT = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "100"}


def in_turn(live, **parts):
    """Add the rows of several channels to a live log as a run does: in the order of time."""
    for edge in range(0, 60, 5):
        for key, (rows, time) in parts.items():
            live.add(key, rows[(rows[time] >= edge) & (rows[time] < edge + 5)])


def write(kind, run, folder):
    path = folder / f"{kind}.mcap"
    if kind in ("plain", "bare"):
        return logs.write_run(path, **{**run, "bare": kind == "bare"})
    if kind == "empty":
        return logs.write_run(path, **run | {key: run[key][:0] for key in ("states", "impacts", "sticks")})
    if kind == "orbit":
        return logs.write_run(path, **run, orbit=made_up("vines.v1.Orbit", 1, "t", 4), word="LR")
    samples = {name: made_up("vines.v1.SensorSample", 9000, "t", k) for k, name in enumerate("abc")}
    if kind == "rig":
        sensors = {name: logs.Sensor(rows, ABOUT) for name, rows in samples.items()}
        base = made_up("vines.v1.BaseMotion", 4000, "t", 9)
        return logs.write_rig(path, sensors=sensors, base=base, provenance={}, parameters={}, name="rig")
    if kind == "live":
        with logs.LiveWriter(path, name="live", provenance={}, parameters={}) as live:
            in_turn(live, states=(run["states"], "t"), impacts=(run["impacts"], "t"))
        return path
    cut = folder / "cut.mcap"
    whole = logs.write_run(folder / "whole.mcap", **{**run, "bare": True}).read_bytes()
    cut.write_bytes(whole[: len(whole) * 2 // 3])
    return logs.recover(cut, path).path


@pytest.mark.parametrize("kind", ["plain", "bare", "empty", "orbit", "rig", "live", "recovered"])
def test_nothing_is_found(kind, run, tmp_path):
    found = findings(write(kind, run, tmp_path))
    if kind == "live":  # a chunk may close between states and impacts of the same times, of which it warns
        found = [line for line in found if not line.startswith("warning: ")]
    assert found == []


@pytest.mark.parametrize(
    ("place", "said"),
    [(b"zstd", "chunk indexes"), (b"/state", "summary repeats schemas and channels"), (b"", "statistics")],
)
def test_what_is_wrong_is_found(place, said, log_file):
    """The checks check: a byte of the summary that is another is named."""
    data = bytearray(log_file.read_bytes())
    summary = struct.unpack_from("<Q", data, len(data) - 28)[0]
    at = data.rindex(place) if place else data.index(struct.pack("<BQ", 0x0B, 76), summary) + 9
    data[at] ^= 1
    log_file.write_bytes(data)
    assert said in findings(log_file)


def test_live_log_of_channels_that_are_added_out_of_step_is_sound(run, tmp_path):
    """Only its order is not that of time, since what is on disk cannot be moved."""
    path = tmp_path / "live.mcap"
    with logs.LiveWriter(path, name="live", provenance={}, parameters={}) as live:
        for rows in np.array_split(run["states"], 3):
            live.add("states", rows)
        live.add("impacts", run["impacts"])
    assert all(line.startswith("warning: ") for line in findings(path))
