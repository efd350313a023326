"""The version stands once, in ``vines/__init__.py``, and what else says it says the same."""

import re
import tomllib
from pathlib import Path

import vines

REPOSITORY = Path(__file__).resolve().parent.parent


def test_the_version_is_one():
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))
    assert "version" in project["project"]["dynamic"]
    assert project["tool"]["hatch"]["version"]["path"] == "vines/__init__.py"
    citation = (REPOSITORY / "CITATION.cff").read_text("utf-8")
    told = re.search(r"^version: (.+)$", citation, re.MULTILINE)
    dated = re.search(r"^date-released: (.+)$", citation, re.MULTILINE)
    changes = (REPOSITORY / "CHANGELOG.md").read_text("utf-8")
    released = re.search(r"^## ([\d.]+) \((.+)\)$", changes, re.MULTILINE)
    assert told is not None
    assert dated is not None
    assert released is not None
    assert told[1] == released[1] == vines.__version__
    assert dated[1] == released[2]


def test_an_entry_of_the_changelog_stands_once():
    changes = (REPOSITORY / "CHANGELOG.md").read_text("utf-8")
    entries = [" ".join(entry.split()) for entry in re.split(r"^- ", changes, flags=re.MULTILINE)[1:]]
    again = [
        entry for entry in entries if any(other != entry and other.startswith(entry.rstrip(".")) for other in entries)
    ]
    assert again == []
    assert len(set(entries)) == len(entries)
