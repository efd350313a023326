"""Logs of orbits and rigs, the profile for bare viewers, and files that vines did not write."""

import io
import struct

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

from tests.logs.conftest import made_up
from tests.logs.test_damage import foreign
from tests.logs.test_round_trip import rows, same
from vines import logs, schema
from vines.errors import LogError, SchemaError

ABOUT = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "25600"}
KEEP = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@KEEP
@given(
    base=rows("vines.v1.BaseMotion", "t"),
    samples=st.dictionaries(
        st.text("abcdefgh_", min_size=1, max_size=6), rows("vines.v1.SensorSample", "t"), max_size=3
    ),
    about=st.dictionaries(st.text(min_size=1, max_size=6), st.text(max_size=9), max_size=3),
)
def test_any_rig_round_trips(tmp_path, base, samples, about):
    sensors = {name: logs.Sensor(values, {**about, **ABOUT}) for name, values in samples.items()}
    log = logs.read(
        logs.write_rig(
            tmp_path / "rig.mcap", sensors=sensors, base=base, provenance={}, parameters={"b [m]": 0.015}, name="rig"
        )
    )
    assert (log.kind, log.complete, log.parameters) == ("rig", True, {"b [m]": 0.015})
    same(log.base, base)
    assert set(log.sensors) == set(samples)
    for name, values in samples.items():
        same(log.sensors[name], values)
        told = {key.decode(): text.decode() for key, text in log.sensors[name].schema.metadata.items()}
        assert told == {**about, **ABOUT}
    assert log.states.num_rows == 0


@KEEP
@given(orbit=rows("vines.v1.Orbit", "t"))
def test_any_orbit_round_trips(run, tmp_path, orbit):
    log = logs.read(logs.write_run(tmp_path / "orbit.mcap", **run, orbit=orbit, word="LLR"))
    assert (log.kind, log.word) == ("orbit", "LLR")
    same(log.orbits, orbit)
    same(log.states, run["states"])


@pytest.mark.parametrize("lacking", ABOUT)
def test_sensor_that_does_not_say_what_it_measures_is_refused(tmp_path, lacking):
    about = {key: text for key, text in ABOUT.items() if key != lacking}
    samples = made_up("vines.v1.SensorSample", 3, "t", 1)
    none = made_up("vines.v1.BaseMotion", 0, "t", 1)
    with pytest.raises(SchemaError, match=f"sensor 'laser' does not state its {lacking}"):
        logs.write_rig(
            *(tmp_path / "rig.mcap",),
            **{"sensors": {"laser": logs.Sensor(samples, about)}, "base": none},
            **{"provenance": {}, "parameters": {}, "name": "rig"},
        )


def bare(path, run):
    return logs.write_run(path, **{**run, "bare": True})


def test_bare_profile_can_be_left_out_and_changes_no_table(run, log_file, tmp_path):
    with_it = logs.read(bare(tmp_path / "bare.mcap", run))
    same(with_it.states, run["states"])
    same(with_it.impacts, run["impacts"])
    size = with_it.path.stat().st_size
    assert log_file.stat().st_size < size < 1.5 * log_file.stat().st_size
    assert bare(tmp_path / "again.mcap", run).read_bytes() == with_it.path.read_bytes()


def test_bare_profile_is_what_other_programs_expect(run, tmp_path):
    seen: dict[str, list] = {}
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema.foxglove_schema()).file:
        pool.Add(file)
    with bare(tmp_path / "bare.mcap", run).open("rb") as stream:
        for kind, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            if kind.name.startswith("foxglove."):
                decoded = message_factory.GetMessageClass(pool.FindMessageTypeByName(kind.name)).FromString(
                    message.data
                )
                seen.setdefault(channel.topic, []).append((message.log_time, decoded))
            elif channel.message_encoding == "cdr":
                seen.setdefault(channel.topic, []).append((message.log_time, message.data))
    assert [each.child_frame_id for each in seen["/tf_static"][0][1].transforms] == ["rig"]
    kept = {round(t * 1e9): row for t, row in zip(run["states"]["t"], run["states"], strict=True)}
    assert len(seen["/tf"]) == len(seen["/curves"]) > 900
    for time, message in seen["/tf"]:
        mass, ball, base = message.transforms
        assert (mass.child_frame_id, ball.child_frame_id, base.child_frame_id) == ("mass", "ball", "base")
        assert mass.timestamp.seconds * 10**9 + mass.timestamp.nanos == time
        assert mass.translation.x == pytest.approx(kept[time]["x1"], rel=1e-6)
        assert ball.translation.x == pytest.approx(kept[time]["x2"], rel=1e-6)
        assert mass.rotation.w == 1.0
    for time, data in seen["/curves"]:
        assert struct.unpack_from("<iI", data, 4) == divmod(time, 10**9)
        last = struct.unpack_from("<3d", data, len(data) - 24)
        assert last == pytest.approx([kept[time][name] for name in ("kinetic_1", "kinetic_2", "potential")], rel=1e-6)
    lines = [message.message for _, message in seen["/impact_log"]]
    assert len(lines) == 43
    assert sum(" impact " in line for line in lines) == 40
    assert b"<robot" in seen["/robot_description"][0][1]


def test_no_bare_profile_where_there_is_nothing_to_show(run, tmp_path):
    empty = {**run, "states": run["states"][:0]}
    assert bare(tmp_path / "a.mcap", empty).read_bytes() == logs.write_run(tmp_path / "b.mcap", **empty).read_bytes()


def test_tables_of_somebody_else(tmp_path):
    file = tmp_path / "robot.mcap"
    file.write_bytes(foreign(message=b'{"x": 1.5, "frame": "map"}'))
    log = logs.read(file)
    assert (log.kind, log.status, log.complete) == ("foreign", "unknown", False)
    assert log.others["/pose"].to_pylist() == [{"log_time": 0, "x": 1.5, "frame": "map"}]
    assert log.states.num_rows == 0


def test_protobuf_of_somebody_else(tmp_path):
    descriptors = schema.foxglove_schema()
    pool = descriptor_pool.DescriptorPool()
    for each in descriptor_pb2.FileDescriptorSet.FromString(descriptors).file:
        pool.Add(each)
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName("foxglove.FrameTransforms"))
    message = kind()
    message.transforms.add(parent_frame_id="a", child_frame_id="b").translation.x = 2.0
    schema_of = ("foxglove.FrameTransforms", descriptors, "protobuf")
    file = tmp_path / "tf.mcap"
    file.write_bytes(foreign(schema=schema_of, encoding="protobuf", topic="/tf", message=message.SerializeToString()))
    (row,) = logs.read(file).others["/tf"].to_pylist()
    assert row["transforms"][0]["translation"] == {"x": 2.0, "y": 0.0, "z": 0.0}
    assert row["transforms"][0]["rotation"] is None


def test_what_cannot_be_decoded_is_named(tmp_path):
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    for topic, encoding in (("/image", "cdr"), ("/odd", "cbor"), ("/fine", "json")):
        number = writer.register_channel(topic, encoding, 0)
        writer.add_message(number, 0, b"{}", 0)
    writer.finish()
    file = tmp_path / "mixed.mcap"
    file.write_bytes(stream.getvalue())
    log = logs.read(file)
    assert log.others["/fine"].to_pylist() == [{"log_time": 0}]
    (remark,) = log.remarks
    assert "cannot decode" in remark
    assert remark.endswith("/image (cdr), /odd (cbor)")
    file.write_bytes(foreign(message=b"{not json"))
    with pytest.raises(LogError, match="messages on /pose do not fit their schema"):
        logs.read(file)


def test_sha256_of_the_status_is_checked(log_file):
    """Our own digest finds what a forged checksum hides: the CRC of the data section is switched off here."""
    data = bytearray(log_file.read_bytes())
    place = data.index(b"made up")
    data[place : place + 7] = b"madE up"
    status = data.index(b"vines.status") - 13
    (length,) = struct.unpack_from("<Q", data, status + 1)
    crc = status + 9 + length + 9
    data[crc : crc + 4] = bytes(4)
    log_file.write_bytes(data)
    with pytest.raises(LogError, match="its SHA-256 does not fit"):
        logs.read(log_file)
