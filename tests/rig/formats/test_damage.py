"""Files that were damaged, padded or are laid out in another way: all of it is read, or what is not is said."""

import numpy as np
import pytest

from vines.errors import RigError
from vines.rig.formats import RawChannel, RawFile, read_file
from vines.rig.synth._write import write_raw

nptdms = pytest.importorskip("nptdms")

STARTED = np.datetime64("2026-03-02T09:00:00", "us")
LO = np.sin(np.arange(2000) / 30.0)
BASE = np.cos(np.arange(2000) / 30.0)
LEAD_IN = 28
OPEN = b"\xff" * 8


def write_tdms(path, *segments, starts=(0, 0), **properties):
    """Write segments of two channels, each begun at its own time [us]."""
    about = {"wf_increment": 1 / 2048, "wf_samples": 1000, "wf_start_offset": 0.0, "unit_string": "Volts", **properties}
    with nptdms.TdmsWriter(path) as file:
        for pair in segments:
            file.write_segment(
                [
                    nptdms.ChannelObject(
                        "daq", name, part, properties={**about, "wf_start_time": STARTED + np.timedelta64(start, "us")}
                    )
                    for name, part, start in zip(("lo", "base"), pair, starts, strict=True)
                ]
            )


def lead_ins(data):
    """Return where the segments begin."""
    places, place = [], 0
    while place < len(data):
        places.append(place)
        place += LEAD_IN + int.from_bytes(data[place + 12 : place + 20], "little")
    return places


def test_a_stale_index_is_not_looked_at(tmp_path):
    path = tmp_path / "a.tdms"
    with nptdms.TdmsWriter(str(path), index_file=True) as file:
        file.write_segment([nptdms.ChannelObject("daq", "lo", LO[:1000])])
    index = path.with_suffix(".tdms_index").read_bytes()
    write_tdms(path, (LO[:1000], BASE[:1000]), (LO[1000:], BASE[1000:]))
    for stale in (index, index[:-9]):
        path.with_suffix(".tdms_index").write_bytes(stale)
        found = read_file(path)
        np.testing.assert_array_equal(found.channel("daq/lo").values, LO)
        np.testing.assert_array_equal(found.channel("daq/base").values, BASE)
    with pytest.raises(RigError, match="index of a TDMS file"):
        read_file(path.with_suffix(".tdms_index"))


@pytest.mark.parametrize("missing", [0, 40, 9000])
def test_a_recording_that_broke_off_is_read_to_its_last_whole_chunk(tmp_path, missing):
    path = tmp_path / "a.tdms"
    write_tdms(path, (LO[:1000], BASE[:1000]), (LO[1000:], BASE[1000:]))
    data = bytearray(path.read_bytes())
    last = lead_ins(data)[-1]
    data[last + 12 : last + 20] = OPEN
    path.write_bytes(data[: len(data) - missing])
    found = read_file(path)
    count = 1000 if missing else 2000
    for name, values in (("daq/lo", LO), ("daq/base", BASE)):
        np.testing.assert_array_equal(found.channel(name).values, values[:count])
    assert any("broke off" in remark for remark in found.remarks)
    assert any("left out" in remark for remark in found.remarks) == bool(missing)


def test_the_same_bytes_without_that_mark_are_a_cut_copy(tmp_path):
    path = tmp_path / "a.tdms"
    write_tdms(path, (LO, BASE))
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(RigError, match="its end is missing"):
        read_file(path)


def test_channels_that_begin_at_other_times_and_axes_in_milliseconds(tmp_path):
    write_tdms(tmp_path / "a.tdms", (LO, BASE), starts=(250, 0))
    found = read_file(tmp_path / "a.tdms")
    assert found.channel("daq/lo").start == pytest.approx(250e-6, abs=1e-12)
    assert found.channel("daq/base").start == 0
    write_tdms(tmp_path / "b.tdms", (LO, BASE), wf_increment=0.5, wf_xunit_string="ms")
    assert read_file(tmp_path / "b.tdms").channel("daq/lo").rate == pytest.approx(2000.0)
    write_tdms(tmp_path / "c.tdms", (LO, BASE), wf_xunit_string="Hz")
    with pytest.raises(RigError, match=r"no channel with samples; it holds daq/lo .* over Hz"):
        read_file(tmp_path / "c.tdms")


def test_structure_arrays_cells_and_matrices_of_matlab(tmp_path):
    from scipy.io import savemat

    one, two = ({"data": part, "unit": unit, "fs": 5120.0} for part, unit in ((LO, "V"), (BASE, "mV")))
    cells = np.empty((1, 2), object)
    cells[0, 0], cells[0, 1] = one, two
    vectors = np.empty((1, 2), object)
    vectors[0, 0], vectors[0, 1] = LO, BASE[:500]
    array = np.zeros((1, 2), [(key, object) for key in ("name", "data", "unit", "fs")])
    array[0, 0], array[0, 1] = ("lo", LO, "V", 5120.0), ("base", BASE, "mV", 5120.0)
    block = {"data": np.stack([LO, BASE], axis=1), "unit": "g", "dt": 1 / 5120}
    savemat(
        tmp_path / "a.mat",
        {"ch": array, "cells": cells, "v": vectors, "block": block, "deep": {"s": array}, "z": np.zeros((9, 9))},
    )
    found = read_file(tmp_path / "a.mat")
    pairs = ["ch({})", "cells{{{}}}", "v{{{}}}", "block[{}]", "deep.s({})"]
    assert {each.name for each in found.channels} == {pair.format(k) for pair in pairs for k in (1, 2)}
    for pair in pairs:
        np.testing.assert_array_equal(found.channel(pair.format(1)).values, LO)
        second = found.channel(pair.format(2))
        np.testing.assert_array_equal(second.values, BASE[: len(second.values)])
        if not pair.startswith("v"):
            assert second.rate == pytest.approx(5120.0)
            assert second.unit == ("g" if pair.startswith("block") else "mV")
    assert found.channel("ch(2)").about["name"] == "base"
    assert any(text.startswith("z ") for text in found.other)


def test_matrices_compound_types_and_shared_rates_of_hdf5(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs["sampling_rate"] = 5120.0
        matrix = file.create_dataset("daq/block", data=np.stack([LO, BASE]))
        matrix.attrs["unit"] = [b"V", b"mV"]
        file["table"] = np.rec.fromarrays([LO, BASE, np.full(2000, b"x")], names="lo,base,note")
        file["square"] = np.zeros((9, 9))
    found = read_file(tmp_path / "a.h5")
    assert [each.name for each in found.channels] == ["daq/block[1]", "daq/block[2]", "table.lo", "table.base"]
    assert [each.unit for each in found.channels] == ["V", "mV", None, None]
    assert {each.rate for each in found.channels} == {5120.0}
    np.testing.assert_array_equal(found.channel("daq/block[2]").values, BASE)
    np.testing.assert_array_equal(found.channel("table.base").values, BASE)
    assert [text.split()[0] for text in found.other] == ["square"]


@pytest.mark.parametrize("count", [2045, 2046, 2047, 2048])
def test_padding_of_uff_is_no_sample(tmp_path, count):
    values = np.sin(np.arange(count) / 30.0) + 2
    lines = [
        "    -1", "    58", "lo", "x", "NONE", "NONE", "NONE",
        "    1         1    0         0       NONE         1   1       NONE         0   0",
        f"         4{count:10d}         1  0.00000e+00  1.95313e-04  0.00000e+00",
        "        17    0    0    0 NONE                 s                   ",
        "        12    0    0    0 NONE                 m/s^2               ",
        "         0    0    0    0 NONE                 NONE                ",
        "         0    0    0    0 NONE                 NONE                ",
    ]  # fmt: skip
    padded = [*values, *np.zeros(-count % 4)]
    lines += ["".join(f"{value:20.11e}" for value in padded[k : k + 4]) for k in range(0, count, 4)]
    (tmp_path / "a.uff").write_text("".join(f"{line:80}\n" for line in lines) + "    -1\n")
    found = read_file(tmp_path / "a.uff")
    np.testing.assert_allclose(found.channel("lo").values, values, rtol=1e-10)
    lines[8] = lines[8].replace(f"{count:10d}", f"{count + 40:10d}")
    (tmp_path / "a.uff").write_text("".join(f"{line:80}\n" for line in lines) + "    -1\n")
    with pytest.raises(RigError, match="its end is missing"):
        read_file(tmp_path / "a.uff")


def test_text_that_begins_with_a_negative_number_is_no_uff(tmp_path):
    (tmp_path / "a.csv").write_text("-1.5,2.5\n-1.25,2\n-1,3.5\n")
    assert read_file(tmp_path / "a.csv").form == "CSV"


def test_a_dialect_is_for_text(tmp_path):
    write_raw(tmp_path / "a.h5", "hdf5", RawFile("hdf5", (RawChannel("a", LO, "V", 1.0, 0.0),), "2026-01-05T09:00:00Z"))
    with pytest.raises(RigError, match="is HDF5, which has none"):
        read_file(tmp_path / "a.h5", "separator=comma")
