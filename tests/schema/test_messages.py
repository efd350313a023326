"""The compiled descriptors are current, documented, and give the layout that protobuf itself writes."""

import shutil

import numpy as np
import pytest
from google.protobuf import descriptor_pb2

from vines import schema
from vines.errors import SchemaError, UnknownNameError
from vines.places import shipped
from vines.schema import _compile, _messages


@pytest.mark.parametrize("name", _compile.DESCRIPTOR_SETS)
def test_committed_set_is_current(name):
    folder = shipped("schemas")
    compiled = _compile.compile_descriptor_set(folder, _compile.DESCRIPTOR_SETS[name])
    there = descriptor_pb2.FileDescriptorSet.FromString((folder / name).read_bytes())
    now = descriptor_pb2.FileDescriptorSet.FromString(compiled)
    assert there == now, "run: python -m vines.schema._compile"


def test_set_that_is_out_of_date_is_told(tmp_path, monkeypatch, capsys):
    shutil.copytree(shipped("schemas"), tmp_path / "schemas")
    (tmp_path / "schemas" / "vines.v1.binpb").write_bytes(b"")
    monkeypatch.setattr(_compile, "shipped", lambda name: tmp_path / name)
    assert _compile.main(["--check"]) == 1
    assert "vines.v1.binpb is out of date" in capsys.readouterr().out
    assert _compile.main([]) == 0
    assert _compile.main(["--check"]) == 0


def test_check_and_write_say_so(capsys):
    assert _compile.main(["--check"]) == 0
    assert _compile.main([]) == 0
    out = capsys.readouterr().out
    assert "is current" in out
    assert "unchanged" in out


def test_source_that_does_not_compile_is_refused(tmp_path, capfd):
    bad = tmp_path / "vines" / "v1" / "bad.proto"
    bad.parent.mkdir(parents=True)
    bad.write_text("message")
    with pytest.raises(SchemaError, match=r"vines/v1/bad\.proto"):
        _compile.compile_descriptor_set(tmp_path)


@pytest.mark.parametrize("name", schema.message_names())
def test_every_field_has_a_unit_and_a_description(name):
    notes = schema.field_notes(name)
    assert set(notes) == set(schema.numpy_dtype(name).names)
    assert all(unit and text.endswith(".") for unit, text in notes.values())


def test_state_has_the_fields_of_a_sample():
    assert schema.numpy_dtype("vines.v1.State").names == (
        *("t", "x1", "v1", "x2", "v2", "w", "w_dot", "phase", "base", "kinetic_1", "kinetic_2"),
        *("potential", "base_work", "damper_loss", "impact_loss", "stuck"),
    )


@pytest.mark.parametrize("name", schema.message_names())
def test_layout_is_what_protobuf_writes(name):
    layout = schema.wire_format(name)
    row = np.frombuffer(bytearray(layout.blank), layout.dtype)
    for number, field in enumerate(layout.dtype.names):
        row[field] = number + 1.0
    message = schema.message_class(name)(**{field: number + 1 for number, field in enumerate(layout.dtype.names)})
    assert row.tobytes() == message.SerializeToString(deterministic=True)


@pytest.mark.parametrize("ask", [schema.numpy_dtype, schema.wire_format, schema.schema_bytes, schema.field_notes])
def test_unknown_message_names_the_nearest(ask):
    with pytest.raises(UnknownNameError, match=r"did you mean 'vines\.v1\.State'"):
        ask("vines.v1.Sate")


def test_field_of_varying_width_is_refused(monkeypatch):
    file = descriptor_pb2.FileDescriptorProto(name="x.proto", package="x")
    message = file.message_type.add(name="X")
    message.field.add(name="label", number=1, type=descriptor_pb2.FieldDescriptorProto.TYPE_STRING, label=1)
    monkeypatch.setattr(_messages, "_descriptors", lambda: {"x.X": (file, 0)})
    with pytest.raises(SchemaError, match=r"'label' of x\.X has no fixed width"):
        _messages.wire_format.__wrapped__("x.X")


def test_unknown_name_of_the_room():
    with pytest.raises(AttributeError, match="nothing_like_it"):
        _ = schema.nothing_like_it
