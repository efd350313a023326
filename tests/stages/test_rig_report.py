"""The page about a campaign: what it tells, in every form, and what is refused in one line."""

import json

import pytest

from vines.errors import FileMissingError, ParameterError
from vines.rig.synth import RigSettings, make_run
from vines.stages.reports._document import Heading, Picture, Table, write_document

PARTS = [
    Heading("Verdicts", ["1 agree <of> 2"]),
    Table(["run", "r", "verdict"], [["01_up", "0.6508(11)", "agree"], ["02|x", "", "failed"]]),
    Picture("Beside the model", b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'/>"),
]


def test_a_page_is_whole_and_asks_nothing_of_a_network(tmp_path):
    write_document(tmp_path / "a.html", "Report & all", "below", PARTS)
    text = (tmp_path / "a.html").read_text()
    assert "default-src 'none'" in text
    assert "Report &amp; all" in text
    assert "1 agree &lt;of&gt; 2" in text
    assert '<td class="number">0.6508(11)</td>' in text
    assert '<td class="short agree">agree</td>' in text
    assert "http" not in text.replace("http-equiv", "")


def test_markdown_has_its_pictures_beside_it(tmp_path):
    write_document(tmp_path / "a.md", "Report", "below", PARTS)
    text = (tmp_path / "a.md").read_text()
    assert "| run | r | verdict |\n| --- | --- | --- |\n| 01_up | 0.6508(11) | agree |\n| 02\\|x |  | failed |" in text
    assert "![Beside the model](a_figures/1.svg)" in text
    assert (tmp_path / "a_figures/1.svg").is_file()


def test_pdf_without_chromium_and_other_endings_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    with pytest.raises(
        FileMissingError, match=r"Chromium prints PDF, but there is none .*; install it, or write \.html"
    ):
        write_document(tmp_path / "a.pdf", "Report", "below", PARTS)
    with pytest.raises(ParameterError, match=r"a report ends in \.html, \.pdf, \.md, not in \.txt"):
        write_document(tmp_path / "a.txt", "Report", "below", PARTS)
    with pytest.raises(FileMissingError, match="does not exist; make it first"):
        write_document(tmp_path / "no" / "a.html", "Report", "below", PARTS)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.full
def test_a_campaign_is_told_and_asked_what_is_next(project):
    free = RigSettings(
        run_id="free", protocol="ringdown", ball=False, E=0.0, duration=10.0, start=(0.012, 0.0, 0.0, 0.0),
        rate=12800.0, settle=0.0,
    )  # fmt: skip
    make_run(project.root / "runs" / "free", free, 1)
    good = RigSettings(run_id="good", duration=12.0, settle=30.0, rate=12800.0, ringdown=("free",))
    make_run(project.root / "runs" / "good", good, 8)
    (project.root / "runs" / "bad").mkdir()
    (project.root / "runs" / "bad" / "run.json").write_text("{")
    project.vines("rig", "report", "runs", "--out", "page.md")
    text = (project.root / "page.md").read_text()
    for said in ("## Verdicts", "| good | yes |", "## Calibration", "synthetic-lo_acc", "2026-01-02", "## Ring-downs",
                 "| free | 55.3", "## Uncertainty budget", "Half length of the cavity by gauge", "SHA-256", "| bad |",
                 "1 agree"):  # fmt: skip
        assert said in text
    asked = ("rig", "next", "runs", "--json", "--count", "3", "--amplitudes", "0.013", "0.019")
    rows = json.loads(project.vines(*asked).stdout)
    assert 1 <= len(rows) <= 3
    assert rows[0]["u_tilt_after"] < rows[0]["u_tilt"]
