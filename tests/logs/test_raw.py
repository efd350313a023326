"""What a recorder gives is kept to the bit at its full rate, gaps included, and any program with protobuf reads it."""

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader

from tests.logs.conftest import made_up
from tests.logs.doctor import findings
from vines import logs
from vines.errors import SchemaError

ABOUT = {"provenance": {"by": "a test"}, "parameters": {}, "name": "watched"}
SENSOR = {"quantity": "acceleration", "unit": "m/s^2", "sign": "positive to the right", "rate": "1000"}


def raw(dtype="<f4", rate="1000"):
    return {"ai0": {"unit": "V", "rate": rate, "dtype": dtype, "range": "10"}}


@pytest.mark.parametrize("dtype", ["<f4", "<f8", "<i4"])
def test_samples_come_back_to_the_bit_whatever_the_pieces(tmp_path, dtype):
    path = tmp_path / "run.mcap"
    rng = np.random.default_rng(3)
    sent = (1e4 * rng.normal(size=3217)).astype(dtype)
    with logs.LiveWriter(path, **ABOUT, sensors={"acc": SENSOR}, raw=raw(dtype)) as live:
        place = 0
        for size in (1, 99, 100, 7, 1310, 1700):
            live.add_raw("ai0", place, sent[place : place + size])
            place += size
        with pytest.raises(SchemaError, match="before the last one at 3216"):
            live.add_raw("ai0", 5, sent[:5])
        with pytest.raises(SchemaError, match="no raw channel 'ai1'; it has ai0"):
            live.add_raw("ai1", place, sent[:5])
    log = logs.read(path)
    assert (log.complete, log.kind, log.raw["ai0"].start, log.raw["ai0"].rate) == (True, "rig", 0.0, 1000.0)
    np.testing.assert_array_equal(log.raw["ai0"].values, sent)
    assert not log.raw["ai0"].lost.any()
    assert findings(path) == []


def test_a_gap_is_lost_samples(tmp_path):
    path = tmp_path / "run.mcap"
    with logs.LiveWriter(path, **ABOUT, sensors={}, raw=raw()) as live:
        live.add_raw("ai0", 50, np.ones(130, "<f4"))
        live.add_raw("ai0", 200, np.full(30, 2, "<f4"))
    found = logs.read(path).raw["ai0"]
    assert (found.start, len(found.values), int(found.lost.sum())) == (0.05, 180, 20)
    assert found.lost[130:150].all()
    assert set(found.values[:130]) == {1.0}
    assert set(found.values[150:]) == {2.0}


def test_protobuf_alone_reads_the_messages(tmp_path):
    """The schema in the file is enough: another reader gets the same numbers."""
    path = tmp_path / "run.mcap"
    sent = np.arange(350, dtype="<i4")
    with logs.LiveWriter(path, **ABOUT, sensors={}, raw=raw("<i4")) as live:
        live.add_raw("ai0", 0, sent)
    with path.open("rb") as stream:
        read = [(s, m) for s, c, m in make_reader(stream, validate_crcs=True).iter_messages() if c.topic == "/raw/ai0"]
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(read[0][0].data).file:
        pool.Add(file)
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName("vines.v1.RawSamples"))
    told = [kind.FromString(message.data) for _, message in read]
    assert [value for each in told for value in each.counts] == sent.tolist()
    assert [each.first for each in told] == [0, 100, 200, 300]
    assert [each.t for each in told] == [0.0, 0.1, 0.2, 0.3]


def test_what_is_not_stated_is_asked_for(tmp_path):
    with pytest.raises(SchemaError, match="does not state its rate, dtype"):
        logs.LiveWriter(tmp_path / "a.mcap", **ABOUT, sensors={}, raw={"ai0": {"unit": "V"}})
    with pytest.raises(SchemaError, match="allowed: <f4, <f8, <i4"):
        logs.LiveWriter(tmp_path / "a.mcap", **ABOUT, sensors={}, raw=raw("<i2"))
    assert list(tmp_path.iterdir()) == []


def test_a_log_is_read_as_it_grows(tmp_path):
    path = tmp_path / "run.mcap"
    samples = made_up("vines.v1.SensorSample", 60, "t", 7)
    live = logs.LiveWriter(path, **ABOUT, sensors={"acc": SENSOR})
    with live:
        tail = logs.Tail(path)
        tail.take()
        assert (tail.name, tail.kind, tail.about["acc"]["unit"]) == ("watched", "rig", "m/s^2")
        found = []
        for part in np.array_split(samples, 3):
            live.add("acc", part)
            live._flush()
            found.append(tail.take().get("acc", samples[:0]))
        assert not tail.ended
    found.append(tail.take().get("acc", samples[:0]))
    assert tail.ended
    assert tail.take() == {}
    np.testing.assert_array_equal(np.concatenate(found)["value"], samples["value"])
    again = logs.Tail(path)
    np.testing.assert_array_equal(again.take()["acc"]["t"], samples["t"])
