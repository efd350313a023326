"""Files and runs of strangers that once failed, where they are at hand; made anew, they are in formats/ and ingest/."""

from pathlib import Path

import numpy as np
import pytest

from vines.rig import read_run
from vines.rig.formats import read_file
from vines.rig.ingest._inspect import channel_facts

CASES = Path(__file__).parents[3] / "shared" / "cases"
TEXTS = sorted(CASES.glob("csv/*"))
RUNS = {"run_volts": 16384, "run_trailing_comma": 7998, "run_stale_index": 16384}
pytestmark = pytest.mark.skipif(not TEXTS, reason="the cases are not at hand")


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_texts_that_hold_the_same_two_channels(path):
    lo, base = read_file(path).channels
    k = np.arange(2048)
    assert lo.values[0] == pytest.approx(0.01)
    assert base.values[0] == pytest.approx(1.5)
    np.testing.assert_allclose(base.values, 1.5 * np.cos(2 * np.pi * 8.8 * k / 10240), atol=1e-3)
    said = channel_facts(lo)
    if path.name.startswith("17"):
        assert "rounded and tell the rate" in said.gaps
    elif path.name.startswith("19"):
        assert said.gaps == "its times have no unit"
    else:
        assert said.rate == pytest.approx(10240, rel=1e-6)
        assert lo.unit == base.unit == "V"


@pytest.mark.parametrize("name", RUNS)
def test_runs(name):
    channel = read_run(CASES / "rig" / name).recording.channels["lo_disp"]
    assert len(channel.values) == RUNS[name]
    assert channel.rate == pytest.approx(2048.0)
    assert np.abs(channel.values).max() == pytest.approx(6e-3, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "channels", "count"),
    [("appended.tdms", ["g/lo"], 7120), ("padded.uff", ["lo"], 2045), ("struct_array.mat", ["ch(1)", "ch(2)"], 5120)],
)
def test_other_files(name, channels, count):
    found = read_file(CASES / "rig" / name)
    assert [each.name for each in found.channels] == channels
    assert {len(each.values) for each in found.channels} == {count}
