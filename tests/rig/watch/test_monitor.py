"""What is said while a run goes on, against the truth of the synthetic rig, which shares no equation with it."""

import numpy as np
import pytest

from vines.rig.ingest import COLUMNS, Cells
from vines.rig.synth import LiveRig, RigSettings
from vines.rig.watch import Block, Monitor, channels_of

RATE = 6400.0


def cells_of(rows):
    every = [
        {name: str(getattr(row, name)) for name in COLUMNS if getattr(row, name) not in (None, "")} for row in rows
    ]
    return [Cells(each, "test") for each in every]


def watch(values, rows, rate, *, b=0.015, memory=3.0, size=None, skip=()):
    """Return the reports of a second each."""
    channels = channels_of(cells_of(rows))
    monitor = Monitor(channels, rate, b=b, memory=memory)
    size = size or round(rate / 10)
    reports, due = [], 1.0
    for number, first in enumerate(range(0, values.shape[1], size)):
        if number not in skip:
            monitor.take(Block(first, values[:, first : first + size]))
        if monitor.time >= due - 1e-9:
            reports.append(monitor.report())
            due += 1.0
    return monitor, reports


@pytest.fixture(scope="module")
def rig():
    """Return a rig and two and twenty seconds of it, from rest to 1:1."""
    live = LiveRig(RigSettings(rate=RATE, settle=0.0, sigma_r=0.005), 3)
    return live, live.take(round(22 * RATE))


def test_a_dwell_is_told_as_it_was_made(rig):
    live, values = rig
    monitor, reports = watch(values, live.rows, RATE)
    last = reports[-1]
    assert pytest.approx(2.25e-4, rel=5e-3) == last.E
    assert last.f == pytest.approx(8.815555, rel=2e-5)
    assert last.r == pytest.approx(0.65, abs=0.01)
    assert (last.pattern, last.share, last.periods) == ("1:1", 1.0, pytest.approx(63, abs=1))
    assert last.rate == 2.0
    assert abs(monitor.impacts - live.impacts) <= 2  # those of the last tenth of a second are to come
    assert (last.settled, last.wait, last.lost) == (True, None, 0)
    assert not reports[3].settled
    assert 0 < reports[8].wait < 12
    assert [each.clipped_since for each in last.levels.values()] == [0, 0, 0, 0]
    # The ball comes to L a half period before it comes to R, in a symmetric 1:1.
    assert abs((last.phases["R"] - last.phases["L"]) % (2 * np.pi) - np.pi) < 0.25


def test_pieces_of_any_size_say_the_same(rig):
    live, values = rig
    values = values[:, : round(9 * RATE)]
    whole = watch(values, live.rows, RATE)[1][-1]
    odd = watch(values, live.rows, RATE, size=round(RATE))[1][-1]
    assert odd.impacts == pytest.approx(whole.impacts, abs=1)
    assert (odd.pattern, odd.f) == (whole.pattern, pytest.approx(whole.f, rel=1e-9))


def test_lost_samples_are_counted_and_the_rest_goes_on(rig):
    live, values = rig
    monitor, reports = watch(values[:, round(10 * RATE) :], live.rows, RATE, skip=(25, 26))
    assert monitor.lost == 1280
    assert "1280 samples lost" in reports[-1].remarks
    assert reports[-1].pattern == "1:1"


def test_clipping_is_told_for_each_channel(rig):
    live, values = rig
    clipped = values[:, : round(3 * RATE)].copy()
    place = [row.name for row in live.rows].index("lo_disp")
    limit = 10.0
    clipped[place] = np.clip(40 * clipped[place], -limit, limit)
    last = watch(clipped, live.rows, RATE)[1][-1]
    assert last.levels["lo_disp"].clipped > 0.01
    assert any(line.startswith("lo_disp clipped") for line in last.remarks)
    assert last.levels["lo_acc"].clipped_since == 0


def test_another_amplitude_is_another_point():
    first = LiveRig(RigSettings(rate=RATE, settle=12.0, E=2.0e-4), 4)
    before = first.take(round(10 * RATE))
    after = LiveRig(RigSettings(rate=RATE, settle=12.0, E=2.6e-4), 4).take(round(4 * RATE))
    reports = watch(np.concatenate([before, after * _scale(first.rows)], axis=1), first.rows, RATE)[1]
    assert reports[8].since == 0.0
    assert reports[-1].since == pytest.approx(10.0, abs=2.5)
    assert not reports[-1].settled


def _scale(rows):
    """Return by how much the second run would be larger in the first one's volts; both chose the same ranges."""
    return np.ones((len(rows), 1), np.float32)


def test_a_base_at_rest_and_one_that_is_not_measured_are_said():
    live = LiveRig(
        RigSettings(rate=RATE, settle=0.0, E=0.0, protocol="ringdown", ball=False, start=(0.004, 0, 0, 0)), 1
    )
    values = live.take(round(3 * RATE))
    last = watch(values, live.rows, RATE)[1][-1]
    assert (last.E, last.settled, last.pattern) == (None, False, "")
    assert last.why == "the base does not move"
    only = watch(values[2:], live.rows[2:], RATE)[1][-1]
    assert only.why == "no channel measures the base"


def test_a_live_rig_goes_on_where_it_was():
    """Pieces follow each other as a whole does, but for the noise of the instruments."""
    quiet = RigSettings(rate=RATE, settle=0.0, laser_noise=0.0, acc_noise=0.0, enob=24.0, sigma_r=0.0)
    whole = LiveRig(quiet, 7).take(4000)
    rig = LiveRig(quiet, 7)
    parts = np.concatenate([rig.take(size) for size in (1000, 17, 2983)], axis=1)
    scale = np.abs(whole).max(axis=1, keepdims=True)
    assert np.abs((parts - whole) / scale).max() < 2e-4
