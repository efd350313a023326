"""A log that was cut or altered is refused in one line, never half read."""

import io

import numpy as np
import pytest
from mcap.writer import Writer

from vines import logs, schema
from vines.errors import LogError


def refused(path, data):
    path.write_bytes(data)
    with pytest.raises(LogError) as caught:
        logs.read(path)
    message = str(caught.value)
    assert "\n" not in message
    assert path.name in message
    return message


def test_cut_anywhere(log_file, tmp_path):
    data = log_file.read_bytes()
    random = np.random.default_rng(4)
    cuts = [0, 1, 7, 8, 20, 45, 46, len(data) // 2, len(data) - 9, len(data) - 8, len(data) - 1]
    for cut in [*cuts, *random.integers(0, len(data), 50).tolist()]:
        message = refused(tmp_path / "cut.mcap", data[:cut])
        assert "cut short" in message or "is not an MCAP file" in message, (cut, message)


def test_flipped_anywhere(log_file, tmp_path):
    data = log_file.read_bytes()
    random = np.random.default_rng(5)
    ends = [*range(48), *range(len(data) - 48, len(data))]
    for place in [*ends, *random.integers(0, len(data), 200).tolist()]:
        flipped = bytearray(data)
        flipped[place] ^= 1 << int(random.integers(0, 8))
        refused(tmp_path / "flipped.mcap", bytes(flipped))


def test_something_in_the_middle_is_missing_or_doubled(log_file, tmp_path):
    data = log_file.read_bytes()
    half = len(data) // 2
    for spoilt in (data[:half] + data[half + 100 :], data[:half] + data[half - 100 :], data + data):
        refused(tmp_path / "spoilt.mcap", spoilt)


def foreign(**records):
    """Return the bytes of an MCAP file with the given metadata and one channel."""
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    for name, values in records.get("metadata", {}).items():
        writer.add_metadata(name, values)
    kind, data, encoding = records.get("schema", ("ours.Pose", b"{}", "jsonschema"))
    number = writer.register_channel(
        records.get("topic", "/pose"),
        records.get("encoding", "json"),
        writer.register_schema(kind, encoding, data),
    )
    writer.add_message(number, 0, records.get("message", b"{}"), 0)
    writer.finish()
    return stream.getvalue()


PROVENANCE = {"vines.provenance": {"key": "0"}}
COMPLETE = {**PROVENANCE, "vines.status": {"status": "complete"}}


def test_no_mcap_at_all(tmp_path):
    assert "is not an MCAP file" in refused(tmp_path / "table.mcap", b"PAR1 and so on, long enough to have an end")


def test_unfinished(tmp_path):
    assert "is incomplete" in refused(tmp_path / "open.mcap", foreign(metadata=PROVENANCE))
    stopped = {**PROVENANCE, "vines.status": {"status": "stopped"}}
    assert "is incomplete" in refused(tmp_path / "open.mcap", foreign(metadata=stopped))


def test_channel_is_missing(tmp_path):
    assert "no channel of vines.v1.State" in refused(tmp_path / "few.mcap", foreign(metadata=COMPLETE))


def test_schema_of_another_version(tmp_path):
    other = schema.schema_bytes("vines.v1.State").replace(b"w_dot", b"w_dut")
    data = foreign(metadata=COMPLETE, schema=("vines.v1.State", other, "protobuf"), encoding="protobuf")
    assert "another version of vines.v1.State (it lacks or changes w_dot)" in refused(tmp_path / "v.mcap", data)


def test_message_that_is_no_protobuf(tmp_path):
    ours = ("vines.v1.State", schema.schema_bytes("vines.v1.State"), "protobuf")
    data = foreign(metadata=COMPLETE, schema=ours, encoding="protobuf", message=b"\xff")
    assert "is damaged" in refused(tmp_path / "v.mcap", data)


def test_counts_do_not_fit(tmp_path):
    ours = ("vines.v1.State", schema.schema_bytes("vines.v1.State"), "protobuf")
    counted = {**PROVENANCE, "vines.status": {"status": "complete", "/state": "2"}}
    data = foreign(metadata=counted, schema=ours, encoding="protobuf", topic="/state", message=b"")
    assert "1 of 2 messages on /state" in refused(tmp_path / "v.mcap", data)
