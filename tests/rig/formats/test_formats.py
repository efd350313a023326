"""Formats: what is written is read, and files that nobody here wrote are read or refused with one line."""

import site
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from vines.errors import FileMissingError, RigError
from vines.rig.formats import RawChannel, RawFile, read_file
from vines.rig.synth._write import file_name, write_raw

FORMS = ["tdms", "uff", "mat", "mat73", "csv", "hdf5", "wav"]
STEP = 20 / 2**24
CODES = arrays(np.int32, st.integers(3, 40), elements=st.integers(-(2**23), 2**23 - 1))


@pytest.mark.parametrize("form", FORMS)
@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(codes=CODES, rate=st.sampled_from([2048.0, 12800.0, 51200.0]), unit=st.sampled_from(["V", "mV"]))
def test_values_and_attributes_round_trip(tmp_path_factory, form, codes, rate, unit):
    path = tmp_path_factory.mktemp("form") / file_name(form)
    names = ("daq/one", "daq/two") if form == "tdms" else ("one", "two")
    channels = tuple(
        RawChannel(name, part, unit, rate, 0.0, about={"slope": repr(STEP)})
        for name, part in zip(names, (codes, codes[::-1].copy()), strict=True)
    )
    write_raw(path, form, RawFile(form, channels, "2026-01-05T09:00:00Z"))
    found = read_file(path)
    assert {each.name for each in found.channels} == set(names)
    for before in channels:
        after = found.channel(before.name)
        np.testing.assert_allclose(after.values, before.values * STEP, rtol=1e-12, atol=1e-15)
        assert after.unit == unit
        assert after.rate == pytest.approx(rate, rel=1e-5)


def refusal(path):
    """Return why a file is refused, None if it is read; anything else that is raised is a failure."""
    try:
        read_file(path)
    except RigError as error:
        return str(error)
    return None


@pytest.mark.parametrize("form", ["tdms", "uff", "mat", "mat73", "hdf5", "wav"])
def test_same_run_same_bytes_and_damage_is_one_line(tmp_path, form):
    channel = RawChannel(
        "daq/a" if form == "tdms" else "a",
        np.arange(500, dtype=np.int32),
        "V",
        2048.0,
        0.0,
        about={"slope": repr(STEP)},
    )
    files = [tmp_path / f"{k}_{file_name(form)}" for k in range(2)]
    for path in files:
        write_raw(path, form, RawFile(form, (channel,), "2026-01-05T09:00:00Z"))
    data = files[0].read_bytes()
    if form != "tdms":  # its title is the name of the file
        assert data == files[1].read_bytes()
    for cut in (5, len(data) // 3, len(data) - 40):
        files[0].write_bytes(data[:cut])
        said = refusal(files[0])
        assert said is None or "\n" not in said


def test_a_recording_that_was_cut_off_is_refused_and_nothing_else_is_said(tmp_path, capfd):
    channels = tuple(RawChannel(f"daq/{name}", np.arange(5000.0), "V", 2048.0, 0.0) for name in "ab")
    write_raw(tmp_path / "a.tdms", "tdms", RawFile("tdms", channels, "2026-01-05T09:00:00Z"))
    data = (tmp_path / "a.tdms").read_bytes()
    for cut, words in ((len(data) - 40, "its end is missing"), (len(data) // 3, "its end is missing"), (60, "no chan")):
        (tmp_path / "a.tdms").write_bytes(data[:cut])
        assert words in refusal(tmp_path / "a.tdms")
    assert capfd.readouterr() == ("", "")


def strange_files():
    for place in map(Path, site.getsitepackages()):
        for name in ("nptdms", "scipy", "pyuff", "h5py", "soundfile", "pymatreader", "matplotlib"):
            for path in sorted((place / name).rglob("*")):
                if path.suffix.lower() in (".tdms", ".uff", ".unv", ".mat", ".wav", ".h5", ".hdf5", ".csv"):
                    yield path


def test_files_that_nobody_here_wrote():
    """Each is read or refused with a reason of one line that names no folder of this machine."""
    from vines.rig import channel_facts, spark

    read = refused = 0
    for path in strange_files():
        try:
            found = read_file(path)
        except RigError as error:
            text = str(error)
            assert path.name in text
            assert "\n" not in text
            assert str(path.parent) not in text
            refused += 1
            continue
        read += 1
        for channel in found.channels:
            assert channel_facts(channel).samples == len(channel.values) > 0
            assert spark(channel)
    assert read >= 30, (read, refused)
    assert refused >= 30


def test_what_is_no_recording(tmp_path):
    for name, data in (("a.tdms", b""), ("b.xyz", b"hello"), ("c.csv", b"1,2\n3,4\n"), ("d.mat", b"nonsense" * 40)):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(RigError, match=name):
            read_file(tmp_path / name)
    with pytest.raises(FileMissingError):
        read_file(tmp_path / "none.wav")


def test_a_csv_with_times_and_units(tmp_path):
    path = tmp_path / "lab.csv"
    path.write_text("# a note\ntime [ms];lo (V)\n0,0;1,5\n0,5;2,5\n1,0;3,5\n")
    (channel,) = read_file(path).channels
    assert channel.name == "lo"
    assert channel.unit == "V"
    np.testing.assert_allclose(channel.times, [0, 5e-4, 1e-3])
    np.testing.assert_allclose(channel.values, [1.5, 2.5, 3.5])
