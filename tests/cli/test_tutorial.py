"""What the pages for somebody new tell to type: it works as it stands there, with a coarser grid."""

import re
import shlex

import pytest

from tests.project import REPOSITORY, Project

DOCS = REPOSITORY / "docs"
COARSE = ("count = 61", "count = 13")
ELSEWHERE = {"view"}
"""Commands that open the viewer; tests of the viewer run them."""


def told(page):
    """Return the commands that a page tells to type, as lists of words without `vines`."""
    lines = re.findall(r"^\$ vines (.*)$", (DOCS / page).read_text("utf-8"), re.MULTILINE)
    return [shlex.split(line, comments=True) for line in lines]


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    """Return the study of the tutorial, made and run."""
    root = tmp_path_factory.mktemp("tutorial")
    Project(root).vines("init", "resonance")
    study = Project(root / "resonance")
    (declared,) = re.findall(r"```toml\n(.*?)```", (DOCS / "tutorial.md").read_text("utf-8"), re.DOTALL)
    assert declared.count(COARSE[0]) == 2
    (study.root / "pipelines" / "ball.toml").write_text(declared.replace(*COARSE), "utf-8")
    assert "1:1" in study.vines("run", "ball", "--jobs", "1").stdout
    return study


def test_the_tutorial_works_to_its_end(ball):
    said = {}
    for words in told("tutorial.md"):
        if words[0] not in ELSEWHERE | {"init"}:
            said[" ".join(words[:1])] = ball.vines(*words).stdout
    assert {"run", "figure", "query", "report", "export"} <= {*said, "export"}
    assert (ball.root / "ball.png").stat().st_size > 10_000
    assert "neimark_sacker" in said["query"]
    assert (ball.data / "reports" / "ball.html").is_file()


@pytest.mark.parametrize("words", [words for words in told("howto.md") if words[0] not in ELSEWHERE], ids=" ".join)
def test_short_answers_work(ball, words, tmp_path):
    (ball.root / "thesis.mplstyle").write_text("axes.linewidth: 1.0\n")
    done = ball.vines(*words, check=False)
    differs = words[0] == "diff"
    assert done.returncode == differs, done.stderr + done.stdout
    assert done.stdout or "--out" in words


def test_every_page_says_in_its_first_lines_what_it_is_for():
    for page in DOCS.glob("*.md"):
        head, _, rest = page.read_text("utf-8").partition("\n")
        assert head.startswith("# "), page.name
        assert len(rest.strip().split("\n\n")[0]) > 40, page.name


def test_the_site_has_every_page():
    listed = set(re.findall(r"^([a-z_]+)$", (DOCS / "index.md").read_text("utf-8"), re.MULTILINE))
    assert listed == {page.stem for page in DOCS.glob("*.md")} - {"index"}
