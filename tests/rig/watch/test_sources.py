"""Where samples come from: a socket, a device, files that appear; what is wrong with one is a line."""

import enum
import importlib.machinery
import json
import re
import socket
import struct
import sys
import threading
import types
from pathlib import Path

import numpy as np
import pytest

from vines.errors import FileMissingError, RigError, VinesError
from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest import Cells
from vines.rig.synth._write import write_raw
from vines.rig.watch import FolderSource, Refusal, SocketSource, channels_of, open_source, physical_channels

REPOSITORY = Path(__file__).resolve().parents[3]
ROW = {"name": "lo_acc", "role": "lo_acc", "unit": "V", "sign": "-1", "sensitivity": 100, "sensitivity_unit": "mV/g"}
HEAD = {"name": "up 7", "rate": 1000, "type": "f4", "channels": [ROW, {**ROW, "name": "base", "role": "base_acc"}]}


def frame(first, values):
    return struct.pack("<4sIQ", b"VINE", len(values), first) + np.asarray(values, "<f4").tobytes()


def sent(data):
    """Return what a listening source makes of bytes that are sent to it."""
    source = SocketSource("", 0, listen=True)

    def send():
        with socket.create_connection(("127.0.0.1", source.port)) as to:
            to.sendall(data)

    thread = threading.Thread(target=send)
    thread.start()
    try:
        stream = next(each for each in source.streams() if each is not None)
        return stream, [each for each in stream.blocks if each is not None]
    finally:
        thread.join()
        source.close()


def test_a_stream_arrives_as_it_was_sent():
    values = np.arange(400, dtype="<f4").reshape(200, 2)
    frames = b"".join(frame(first, values[first : first + 40]) for first in range(0, 200, 40))
    stream, blocks = sent(json.dumps(HEAD).encode() + b"\n" + frames + frame(300, values[:7]) + b"VINE")
    assert (stream.name, stream.rate, stream.dtype) == ("up_7", 1000.0, "<f4")
    assert [each.name for each in stream.channels] == ["lo_acc", "base"]
    assert stream.channels[0].factor == pytest.approx(-9.80665 / 0.1)
    np.testing.assert_array_equal(np.concatenate([each.values for each in blocks[:-1]], axis=1), values.T)
    assert [blocks[-1].first, blocks[-1].values.shape] == [300, (2, 7)]
    assert blocks[-2].first + blocks[-2].values.shape[1] == 200


def test_the_sender_of_the_docs_sends(tmp_path):
    """What docs/rig.md shows is a program that works."""
    text = (REPOSITORY / "docs" / "rig.md").read_text("utf-8")
    code = re.search(r"```python\n(# sender\.py.*?)```", text, re.DOTALL)[1]
    assert len(code.splitlines()) <= 18
    source = SocketSource("", 0, listen=True)
    thread = threading.Thread(target=exec, args=(code.replace("5555", str(source.port)), {"SECONDS": 0.2}))
    thread.start()
    stream = next(each for each in source.streams() if each is not None)
    blocks = [each for each in stream.blocks if each is not None]
    thread.join()
    source.close()
    assert {each.role for each in stream.channels} == {"base_acc", "lo_disp"}
    assert sum(each.values.shape[1] for each in blocks) >= 0.2 * stream.rate - 1


def channels(**changes):
    return {"channels": [{**ROW, **changes}]}


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"GET / HTTP/1.1\r\n\r\n", "its first line is no JSON: b'GET / HTTP/1.1"),
        (b"[1]\n", "is no object"),
        (b"{}", "it ended without a first line that describes the stream"),
        ({"rate": 0.02}, "rate is 0.02 samples a second, allowed is 50 to 1e+06"),
        ({"rate": 1e12}, "allowed is 50 to 1e+06"),
        ({"rate": "fast"}, "rate is 'fast', allowed is a number"),
        ({"rates": 5}, "unknown entry 'rates' in its first line: did you mean 'rate'"),
        ({"type": "f2"}, "type is 'f2', allowed are f4, f8, i4"),
        ({"channels": []}, "no channels are described"),
        (channels(role="lo_axx"), "role 'lo_axx' of lo_acc is not known: did you mean 'lo_acc'"),
        (channels(role=None), "no role: one of base_disp"),
        (channels(unit="Vlots"), "unit 'Vlots' is not known"),
        (channels(unit="mm"), "mm is a displacement, but lo_acc is a acceleration"),
        (channels(sign=None), "no sign"),
        (channels(sensitivity="x"), "sensitivity is 'x', which is no number"),
        (channels(sensitivty=3), "unknown entry 'sensitivty'"),
        ({"channels": [ROW, ROW]}, "two channels are called 'lo_acc'"),
        ({"run": {"mass": 3}}, "unknown entry 'mass' in run"),
        (json.dumps(HEAD).encode() + b"\n" + b"\0" * 32, "frame 0 begins with b'\\x00\\x00\\x00\\x00', not b'VINE'"),
        (json.dumps(HEAD).encode() + b"\n" + struct.pack("<4sIQ", b"VINE", 2**31, 0), "allowed is 1 to 4194304"),
    ],
)
def test_what_is_wrong_with_a_stream_is_a_line(data, said):
    if isinstance(data, dict):
        data = json.dumps({**HEAD, **data}).encode() + b"\n"
    with pytest.raises(RigError) as caught:
        sent(data)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_sources_that_are_not_there_are_a_line(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(RigError, match="in use"):
            open_source(f"listen://{port}")
    for text, said in (
        (f"tcp://127.0.0.1:{port}", "start the program that sends first"),
        ("tcp://127.0.0.1", "write it as tcp://127.0.0.1:5555"),
        ("listen://0", "with a port from 1 to 65535"),
        ("listen://0.0.0.0:5555", "it listens on this machine only"),
        ("udp://127.0.0.1:5", "no source 'udp'; allowed are a folder, tcp"),
        ("synth:E=3", "given by --set"),
        (str(tmp_path / "no"), "there is no such folder"),
    ):
        with pytest.raises(VinesError, match=re.escape(said)) as caught:
            open_source(text)
        assert "\n" not in str(caught.value)


class DaqError(Exception):
    pass


def stand_in(monkeypatch, fail_at=None):
    """Put a module in the place of nidaqmx that has what is used of it, by the names of version 1.7."""
    made = {}

    class Inputs:
        def add_ai_voltage_chan(
            self, physical, name_to_assign_to_channel="", terminal_config=None, min_val=-5, max_val=5
        ):
            made.setdefault("inputs", {})[physical] = one = types.SimpleNamespace(
                limits=(min_val, max_val), terminal=terminal_config, ai_coupling=None
            )
            return one

    class Timing:
        samp_clk_rate = 0.0

        def cfg_samp_clk_timing(self, rate, source="", active_edge=None, sample_mode=None, samps_per_chan=1000):
            made.update(mode=sample_mode, buffer=samps_per_chan)
            self.samp_clk_rate = round(rate / 100) * 100.0

    class Task:
        def __init__(self):
            self.ai_channels, self.timing, self.in_stream = Inputs(), Timing(), object()

        def start(self):
            made["started"] = True

        def close(self):
            made["closed"] = True

    class AnalogMultiChannelReader:
        calls = 0

        def __init__(self, in_stream):
            del in_stream

        def read_many_sample(self, data, number_of_samples_per_channel=-1, timeout=10.0):
            self.calls += 1
            if fail_at == self.calls:
                raise DaqError("The application is not able to keep up.\nStatus Code: -200279")
            data[:] = self.calls + np.arange(len(data))[:, None] / 10
            return number_of_samples_per_channel

    def choice(name, *values):
        return enum.Enum(name, {value: value for value in values})

    modules = {
        "nidaqmx": {"Task": Task},
        "nidaqmx.constants": {
            "TerminalConfiguration": choice("TerminalConfiguration", "DEFAULT", "DIFF", "PSEUDO_DIFF"),
            "AcquisitionType": choice("AcquisitionType", "CONTINUOUS", "FINITE"),
            "Coupling": choice("Coupling", "AC", "DC"),
            "ExcitationSource": choice("ExcitationSource", "INTERNAL", "NONE"),
            "ExcitationVoltageOrCurrent": choice("ExcitationVoltageOrCurrent", "USE_CURRENT", "USE_VOLTAGE"),
        },
        "nidaqmx.stream_readers": {"AnalogMultiChannelReader": AnalogMultiChannelReader},
        "nidaqmx.errors": {"DaqError": DaqError},
    }
    for name, content in modules.items():
        module = types.ModuleType(name)
        module.__spec__ = importlib.machinery.ModuleSpec(name, None)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    return made


def rows_of_a_device(count=2):
    return [
        Cells({**{k: str(v) for k, v in ROW.items()}, "name": f"a{k}", "field": f"Dev1/ai{k}"}, "t")
        for k in range(count)
    ]


def test_a_device_of_national_instruments_is_read_in_pieces(monkeypatch):
    made = stand_in(monkeypatch, fail_at=3)
    source = open_source("ni://Dev1/ai0:1?rate=51234&iepe=ai1&range=5", rows=rows_of_a_device())
    stream = next(source.streams())
    assert stream.rate == 51200.0
    assert "the device runs at 51200 Hz, not 51234" in stream.remarks[0]
    one, two = next(stream.blocks), next(stream.blocks)
    assert (one.first, two.first, two.values.shape) == (0, 5120, (2, 5120))
    assert two.values[:, 0].tolist() == [2.0, 2.1]
    assert made["inputs"]["Dev1/ai0"].limits == (-5.0, 5.0)
    assert [each.ai_coupling and each.ai_coupling.name for each in made["inputs"].values()] == [None, "AC"]
    assert made["mode"].name == "CONTINUOUS"
    with pytest.raises(RigError, match=r"^ni://Dev1/ai0:1: NI-DAQmx: The application is not able to keep up\.$"):
        next(stream.blocks)
    source.close()
    assert made["closed"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("ni://Dev1/ai0:1", "no rate: write ni://Dev1/ai0:1?rate=51200"),
        ("ni://Dev1/ai0:1?rate=5", "allowed is 50 to 1e+06"),
        ("ni://Dev1?rate=51200", "no channel of a device"),
        ("ni://Dev1/ai0:3?rate=51200", "Dev1/ai2, Dev1/ai3 is not described; give --channels FILE.tsv"),
        ("ni://Dev1/ai0:1?rate=51200&iepe=ai7", "iepe names 'ai7'"),
        ("ni://Dev1/ai0:1?rate=51200&rang=3", "unknown option 'rang': did you mean 'range'"),
    ],
)
def test_what_is_wrong_with_a_device_is_a_line(monkeypatch, text, said):
    stand_in(monkeypatch)
    with pytest.raises(RigError, match=re.escape(said)):
        open_source(text, rows=rows_of_a_device())


def test_channels_of_a_device_are_counted_either_way():
    assert physical_channels("cDAQ1Mod1/ai3:1") == ["cDAQ1Mod1/ai3", "cDAQ1Mod1/ai2", "cDAQ1Mod1/ai1"]
    assert physical_channels("Dev1/ai0:ai1") == ["Dev1/ai0", "Dev1/ai1"]


def recording(path, seconds=1.0):
    t = np.arange(round(1000 * seconds)) / 1000
    values = {"daq/base_acc": np.sin(55 * t), "daq/lo_acc": 2 * np.sin(55 * t + 1)}
    channels = tuple(RawChannel(name, each, "m/s^2", 1000.0, 0.0) for name, each in values.items())
    write_raw(path, "tdms", RawFile("tdms", channels, "2026-01-05T09:00:00Z"))


def until(streams, count):
    """Return the next things that a source yields."""
    return [next(each for each in streams if each is not None) for _ in range(count)]


def test_files_are_taken_once_they_are_complete(tmp_path):
    recording(tmp_path / "before.tdms")
    source = FolderSource(tmp_path, steady=0.0)
    streams = source.streams()
    assert next(streams) is None
    recording(tmp_path / "run_1.tdms")
    (tmp_path / "run_1.tdms_index").write_bytes(b"no recording")
    (tmp_path / "broken.tdms").write_bytes(b"TDSm and nothing else")
    one, two = until(streams, 2)
    assert isinstance(one, Refusal)
    assert one.file.name == "broken.tdms"
    assert "\n" not in one.reason
    assert (two.name, two.rate, [each.role for each in two.channels]) == ("run_1", 1000.0, ["base_acc", "lo_acc"])
    assert any("signs are not stated" in each for each in two.remarks)
    assert sum(each.values.shape[1] for each in two.blocks) == 1000
    assert next(streams) is None
    recording(tmp_path / "run_1.tdms", 2.0)  # it grew
    assert until(streams, 1)[0].name == "run_1"


def test_a_recording_that_broke_off_is_watched_as_far_as_it_goes(tmp_path):
    """Its last lead-in has no length, as NI leaves it; what is whole before it is read."""
    whole = tmp_path / "whole.tdms"
    recording(whole)
    data = bytearray(whole.read_bytes())
    data[12:20] = b"\xff" * 8
    source = FolderSource(tmp_path, steady=0.0)
    streams = source.streams()
    assert next(streams) is None
    (tmp_path / "crashed.tdms").write_bytes(bytes(data))
    (found,) = until(streams, 1)
    assert any("broke off" in each for each in found.remarks)
    assert sum(each.values.shape[1] for each in found.blocks) > 0


def test_the_table_of_the_campaign_describes_its_files(tmp_path):
    (tmp_path / "channels.tsv").write_text(
        "name\trole\tfield\tunit\tsign\n*\tn/a\tn/a\tm/s^2\t-1\nlo\tlo_acc\tlo_acc\tn/a\tn/a\n", "utf-8"
    )
    recording(tmp_path / "run_1.tdms")
    (stream,) = until(FolderSource(tmp_path, steady=0.0, present=True).streams(), 1)
    assert [(each.name, each.factor) for each in stream.channels] == [("lo", -1.0)]


def test_a_folder_that_is_none_is_refused(tmp_path):
    with pytest.raises(FileMissingError, match="there is no such folder"):
        FolderSource(tmp_path / "no")


def test_a_row_for_all_channels_describes_each():
    rows = [Cells({"name": "*", "sign": "+1", "unit": "V"}, "t"), Cells({"name": "x", "role": "lo_disp"}, "t")]
    (one,) = channels_of(rows)
    assert (one.si, one.calibrated, one.factor) == ("V", False, 1.0)
