"""Long runs: thinned to what a screen shows, with every peak and every impact; a stalled viewer is started again."""

import numpy as np
import pytest

from tests.viewer.test_recording import chunks
from vines import viewer
from vines.errors import ParameterError, ViewerError, ViewerStallError
from vines.logs import Sensor, read, write_rig
from vines.schema import numpy_dtype
from vines.viewer import _drawn, _show
from vines.viewer._drawn import drawn
from vines.viewer._thin import chosen_rows, peaks


@pytest.fixture
def low_bounds(monkeypatch):
    """Make short runs long ones."""
    monkeypatch.setattr(_drawn, "MOST_STATES", 300)
    monkeypatch.setattr(_drawn, "_MOST_SAMPLES", 100)


@pytest.mark.parametrize("count", [60_001, 100_000, 131_071])
def test_every_bin_keeps_least_and_greatest(count):
    random = np.random.default_rng(count)
    curves = [random.standard_normal(count), np.cumsum(random.standard_normal(count))]
    most = 10_000
    rows = peaks(curves, most)
    assert len(rows) <= most + 2 * len(curves)
    assert (np.diff(rows) > 0).all()
    size = -(-count // (most // 4))
    for values in curves:
        for start in range(0, count, size):
            mine = values[start : start + size]
            kept = values[rows[(rows >= start) & (rows < start + size)]]
            assert (kept.min(), kept.max()) == (mine.min(), mine.max())


def test_values_that_are_not_finite_hide_no_peak():
    values = np.sin(np.arange(10_000) / 50.0)
    values[4_000], values[4_001:4_100] = 7.0, np.nan
    assert 4_000 in peaks([values], 200)
    assert len(peaks([np.full(1_000, np.nan)], 100)) > 0


@pytest.mark.parametrize("at", [None, -1.0, 0.0, 333.3, 1e9])
def test_stretches_are_whole_and_ends_are_kept(at):
    t = np.linspace(0.0, 1000.0, 200_001)
    rows = chosen_rows(t, [np.sin(t)], at, most=60_000)
    assert rows.thinned
    assert len(rows.chosen) < 62_000
    assert (rows.chosen[0], rows.chosen[-1]) == (0, len(t) - 1)
    for part, (begin, end) in zip(rows.parts(), rows.stretches, strict=True):
        np.testing.assert_array_equal(rows.chosen[part], np.arange(begin, end))
    if at == 333.3:
        begin, end = rows.stretches[1]
        assert t[begin] < at < t[end]
    assert not chosen_rows(t, [], most=len(t)).thinned


@pytest.mark.usefixtures("low_bounds")
def test_long_run_keeps_its_impacts_and_says_what_is_left_out(settled, tmp_path):
    log = read(settled)
    count = log.states.num_rows
    part = drawn(log)
    assert part.log.states.num_rows < 360 < count
    for name in ("x1", "x2", "w", "w_dot"):
        every, kept = log.states[name].to_numpy(), part.log.states[name].to_numpy()
        assert (kept.min(), kept.max()) == (every.min(), every.max())
    found = chunks(viewer.save_rrd([log], tmp_path / "thin.rrd"))
    assert found["/quickstart_settled/cavity/ball"] == part.log.states.num_rows
    assert found["/quickstart_settled/impacts"] == log.impacts.num_rows
    (remark,) = viewer.remarks(log)
    assert remark.startswith(f"drawn are of {count} states about 300")
    assert remark.endswith("--full draws all")
    assert viewer.remarks(log, full=True) == []
    every = chunks(viewer.save_rrd([log], tmp_path / "full.rrd", full=True))
    assert every["/quickstart_settled/cavity/ball"] == count
    with pytest.raises(ParameterError, match="at is 1e\\+09, allowed is"):
        viewer.save_rrd([log], tmp_path / "late.rrd", at=1e9)
    near = drawn(log, at=20.0).log.states["t"].to_numpy()
    assert np.diff(near[np.abs(near - 20.0) < 1.0]).max() < 0.11


@pytest.mark.usefixtures("low_bounds")
def test_long_measurement_keeps_shocks_and_gaps(rig, tmp_path):
    log = read(rig)
    assert drawn(log).log.sensors["lo_disp"].schema.metadata == log.sensors["lo_disp"].schema.metadata
    rows = np.zeros(5_000, numpy_dtype("vines.v1.SensorSample"))
    rows["t"], rows["valid"] = np.arange(5_000) / 1e3, 1
    rows["value"][2_345] = 9.0
    rows["valid"][1_000:1_004] = 0
    about = {"quantity": "acceleration", "unit": "m/s^2", "sign": "positive to the right", "rate": "1000"}
    path = write_rig(
        tmp_path / "shock.mcap",
        sensors={"acc": Sensor(rows, about)},
        base=np.zeros(0, numpy_dtype("vines.v1.BaseMotion")),
        provenance={},
        parameters={},
        name="shock",
    )
    thin = drawn(read(path)).log.sensors["acc"]
    assert thin.num_rows < 150
    assert thin["value"].to_numpy().max() == 9.0
    assert (thin["valid"].to_numpy() == 0).any()


class _Stall:
    """A viewer that stalls so many times."""

    def __init__(self, times: int, error: type[ViewerError] = ViewerStallError):
        self.times, self.error, self.asked = times, error, 0

    def __call__(self) -> bytes:
        self.asked += 1
        if self.asked <= self.times:
            raise self.error(f"stall {self.asked}")
        return b"picture"


def test_a_viewer_that_stalls_is_started_once_more():
    said: list[str] = []
    once = _Stall(1)
    assert _show._twice(once, said.append) == b"picture"
    assert (once.asked, said) == (2, ["stall 1; it is started once more"])
    with pytest.raises(ViewerStallError, match="stall 2"):
        _show._twice(_Stall(2), None)
    lasting = _Stall(1, ViewerError)
    with pytest.raises(ViewerError, match="stall 1"):
        _show._twice(lasting, None)
    assert lasting.asked == 1
