"""What is said while a run goes on."""

import pytest

from vines.cli import _progress
from vines.pipeline import Event


@pytest.fixture
def clock(monkeypatch):
    """Give a clock that stands where a test puts it."""
    times = [0.0]
    monkeypatch.setattr(_progress.time, "monotonic", lambda: times[0])
    return times


def test_the_time_that_is_left_follows_from_points_and_not_from_imports(clock, capsys):
    lines = _progress.Lines()
    lines(Event("started", "up", 1000, text="never finished"))
    times = ((89.0, 1), (89.4, 21), (89.5, 26), (90.0, 51), (91.5, 126))  # the first takes what is imported as well
    for now, done in times:
        clock[0] = now
        lines(Event("progress", "up", 1000, done))
    said = capsys.readouterr().out.splitlines()
    assert said == [
        "up: never finished",
        "up: 1 of 1000",
        "up: 26 of 1000, 50 points/s, 19 s left",
        "up: 126 of 1000, 50 points/s, 17 s left",
    ]
