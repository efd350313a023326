"""Logs that are hurt, rewritten or of other people: shown, with what is missing said."""

import pytest

from tests.logs.rewriting import rewritten
from tests.logs.test_damage import foreign
from tests.viewer.test_recording import chunks
from vines import viewer
from vines.errors import LogError, ViewerError
from vines.logs import read, read_damaged


def without_name(path, out):
    """Copy a log with one bit of its record vines.run flipped."""
    data = bytearray(path.read_bytes())
    data[data.index(b"vines.run") + 14] ^= 64
    out.write_bytes(data)
    return out


@pytest.mark.parametrize("log", ["settled", "rig"])
def test_log_whose_name_is_hurt_is_shown(log, request, tmp_path):
    hurt = without_name(request.getfixturevalue(log), tmp_path / "hurt.mcap")
    with pytest.raises(LogError, match="damaged"):
        read(hurt)
    shown = read_damaged(hurt)
    (remark,) = viewer.remarks(shown)
    assert remark.startswith("damaged, shown as `vines recover` would save it; lost: record vines.run")
    assert shown.kind == ("rig" if log == "rig" else "run")
    found = chunks(viewer.save_rrd([shown], tmp_path / "hurt.rrd"))
    assert max(found.values()) > 100
    assert sorted(path.name for path in tmp_path.iterdir()) == ["hurt.mcap", "hurt.rrd"]


def test_log_that_lost_messages_is_not_shown(settled, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(settled.read_bytes()[: settled.stat().st_size // 2])
    with pytest.raises(LogError, match="cut short"):
        read_damaged(cut)


def test_foreign_log_is_shown_as_rerun_does_and_the_rest_is_named(settled, tmp_path):
    path = tmp_path / "ros.mcap"
    kept = ("/curves", "/robot_description", "/tf", "/tf_static", "/impact_log")
    path.write_bytes(rewritten(settled.read_bytes(), keep=lambda t: t in kept, metadata=lambda name: False))
    found = chunks(viewer.save_rrd([path], tmp_path / "ros.rrd"))
    assert found["/curves/position"] > 100
    assert viewer.remarks(read(path)) == ["not a log of vines: Rerun shows what it knows"]
    with pytest.raises(ViewerError, match="view it alone"):
        viewer.save_rrd([path, settled], tmp_path / "two.rrd")
    path.write_bytes(foreign(topic="/pose\x1b[31m"))
    with pytest.raises(ViewerError, match=r"nothing that can be drawn: Rerun does not draw /pose\\x1b\[31m \(json\)"):
        viewer.save_rrd([path], tmp_path / "json.rrd")


def test_log_without_metadata_is_drawn(settled, rig, tmp_path):
    for log in (settled, rig):
        path = tmp_path / log.name
        path.write_bytes(rewritten(log.read_bytes(), metadata=lambda name: False))
        assert max(chunks(viewer.save_rrd([path], tmp_path / "bare.rrd")).values()) > 100
        assert "no provenance: nothing vouches that these are the messages that vines wrote" in viewer.remarks(
            read(path)
        )
