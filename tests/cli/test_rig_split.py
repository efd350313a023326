"""``vines rig split``: dwells become runs that refer to the raw files of the whole."""

import hashlib
import json

import pytest
from click.testing import CliRunner

from vines.cli._app import app
from vines.errors import RigError
from vines.rig import read_run, split_run
from vines.rig.synth import RigSettings, make_run


@pytest.fixture(scope="module")
def stairs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("split") / "stairs"
    course = ((0.0, 1.0), (7.0, 1.0), (7.2, 1.15), (14.0, 1.15))
    made = RigSettings(run_id="stairs", duration=14.0, settle=3.0, rate=3200.0, E_course=course)
    make_run(folder, made, 3)
    return folder


def test_dwells_refer_to_the_raw_files_and_a_second_call_changes_nothing(stairs):
    pieces = split_run(stairs, settle=2.0)
    assert [piece.folder.name for piece in pieces] == ["stairs_1", "stairs_2"]
    assert all(piece.made for piece in pieces)
    assert not any((piece.folder / "raw").exists() for piece in pieces)
    second = read_run(pieces[1].folder)
    (name,) = second.sums
    assert second.sums[name] == hashlib.sha256((stairs / name).read_bytes()).hexdigest()
    assert name in (pieces[1].folder / "SHA256SUMS").read_text()
    channel = second.recording.role("base_disp")
    assert channel.times[0] >= pieces[1].begin - 1e-3
    assert channel.times[-1] <= pieces[1].dwell.end + 1e-3
    assert abs(pieces[1].dwell.size / pieces[0].dwell.size - 1.15) < 0.002
    assert not any(piece.made for piece in split_run(stairs, settle=2.0))


def test_what_cannot_be_split_is_said(stairs):
    split_run(stairs, settle=2.0)
    with pytest.raises(RigError, match="a part of"):
        split_run(stairs.with_name("stairs_1"))
    with pytest.raises(RigError, match="none has 20 periods left"):
        split_run(stairs, settle=30.0)


def test_json_tells_each_dwell(stairs):
    got = CliRunner().invoke(app, ["rig", "split", str(stairs), "--settle", "2", "--json"])
    assert got.exit_code == 0, got.output
    rows = json.loads(got.output)
    assert [row["folder"].rsplit("/", 1)[-1] for row in rows] == ["stairs_1", "stairs_2"]
