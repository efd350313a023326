"""Whatever stands where pins should: named by each command, mended by a run, and no other pipeline suffers."""

import json

import pytest

from tests.stages.test_faults import OTHER, SQL, contents, named, run_two

READERS = (
    ("status", "small"),
    ("query", SQL),
    ("verify", "small"),
    ("gc",),
    ("report", "small"),
    ("view", "small.run", "--save", "x.rrd"),
    ("diff", "small.up", "other.up"),
    ("export", "exported", "small"),
)
KEY = "0" * 64
STRANGE = {
    "empty": "",
    "another form": "[]",
    "nothing in it": "{}",
    "nested deeply": "[" * 100_000,
    "no text": b"\xff\xfe{",
    "a number for a pin": json.dumps({"up": 3}),
    "a pin of nothing": json.dumps({"up": {}}),
    "a number for a key": json.dumps({"up": {"result": 7}}),
    "a way out of the store": json.dumps({"up": {"result": "../../../etc"}}),
    "a pool that is none": json.dumps({"up": {"result": KEY, "pool": ["x"]}}),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Return a project with two pipelines that were run."""
    return run_two(tmp_path_factory.mktemp("whole"))


def test_whatever_stands_where_pins_should(whole):
    path = whole.data / "pipelines" / "small.pins.json"
    right, before, answer = contents(whole), path.read_bytes(), whole.vines("query", OTHER).stdout
    for what, content in STRANGE.items():
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        for command in READERS if what in ("empty", "a pin of nothing") else READERS[:2]:
            said = whole.vines(*command, check=False)
            where = "small.pins.json is damaged"
            if command[0] in ("status", "verify"):  # these tell it in a table
                assert "small.pins.json" in said.stdout + said.stderr, (what, command, said)
            else:
                assert named(said), (what, command, said)
                assert where in said.stderr, (what, command, said)
        assert whole.vines("query", OTHER).stdout == answer, what
        whole.vines("run", "small", "--jobs", "1", "--quiet")
        assert contents(whole) == right, what
        assert path.read_bytes() == before, what
        assert not (whole.root / "exported").exists(), what


def test_what_the_system_does_not_let_be_read_is_not_forgotten(whole, monkeypatch):
    """A refusal that may pass, such as too many open files, costs no pin and no point; it is told as what it is."""
    import errno
    import os
    from pathlib import Path

    real, path = Path.read_bytes, whole.data / "pipelines" / "small.pins.json"
    before, answer = path.read_bytes(), whole.vines("query", OTHER).stdout

    def refused(self):
        if self == path:
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE), str(self))
        return real(self)

    with monkeypatch.context() as patched:
        patched.setattr(Path, "read_bytes", refused)
        for command in (*READERS[1:], ("run", "small", "--jobs", "1")):
            said = whole.vines(*command, check=False)
            assert said.returncode in (1, 2), (command, said)
            assert "Too many open files" in said.stderr, (command, said)
        assert (
            "Too many open files" in whole.vines("status", "--json").stdout
        )  # a table is cut to the width of the screen
        assert whole.vines("query", OTHER).stdout == answer
    assert path.read_bytes() == before


def test_a_folder_where_pins_should_be(whole):
    path = whole.data / "pipelines" / "small.pins.json"
    before, answer = path.read_bytes(), whole.vines("query", OTHER).stdout
    path.unlink()
    path.mkdir()
    try:
        for command in READERS[1:]:
            said = whole.vines(*command, check=False)
            assert said.returncode in (1, 2), (command, said)
            assert "small.pins.json" in said.stderr, (command, said)
        assert whole.vines("query", OTHER).stdout == answer
    finally:
        path.rmdir()
        path.write_bytes(before)


def test_a_result_that_is_gone(whole):
    pins = json.loads((whole.data / "pipelines" / "small.pins.json").read_text())
    right, folder = contents(whole), whole.data / "results" / pins["run"]["result"]
    away = whole.root / "away"
    folder.rename(away)
    for command in (READERS[1], *READERS[4:6], ("diff", "small.run", "other.run"), READERS[7]):
        said = whole.vines(*command, check=False)
        assert named(said), (command, said)
        assert pins["run"]["result"][:12] in said.stderr, (command, said)
    page = (whole.data / "reports" / "small.html").read_text()
    assert "Not on this page:" in page
    assert "small.run: result " in page
    whole.vines("run", "small", "--jobs", "1", "--quiet")
    assert contents(whole) == right
    assert whole.vines("report", "small").stderr == ""
    assert "Not on this page:" not in (whole.data / "reports" / "small.html").read_text()
