"""The kind ``report``: the page as a result of a pipeline, the same again for the same results."""

import pytest

import vines
from vines.errors import DeclarationError
from vines.stages import current, load_pipeline

STUDY = """
title = "a small study"
[stages.rig]
kind = "dimensionless"
params = { E = 0.0003, omega = 55.39, m = 0.03807 }
[stages.page]
kind = "report"
pipeline = "small"
title = "The rig of Table 1"
needs = ["rig"]
"""


@pytest.fixture
def root(tmp_path, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(tmp_path))
    monkeypatch.delenv("VINES_DATA", raising=False)
    (tmp_path / "pipelines").mkdir()
    (tmp_path / "pipelines" / "small.toml").write_text(STUDY)
    return tmp_path


def page_of(name):
    store = current().store
    return store.result(store.pins(name)["page"]["result"]).folder / "report.html"


def test_the_page_is_a_result_with_the_same_bytes_again(root):
    vines.run("small")
    page = page_of("small")
    first = page.read_bytes()
    text = first.decode()
    assert "<h1>The rig of Table 1</h1>" in text
    assert "small.rig" in text
    assert "written" not in text
    vines.run("small", force=True)
    assert page_of("small") == page
    assert page.read_bytes() == first


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('needs = ["rig"]', "", "name them, needs = "),
        ('pipeline = "small"', 'pipeline = "smal"', "pipeline is 'smal', allowed is the name of this one, 'small'"),
    ],
)
def test_a_wrong_report_is_one_line(root, old, new, said):
    (root / "pipelines" / "small.toml").write_text(STUDY.replace(old, new))
    with pytest.raises(DeclarationError) as caught:
        load_pipeline("small")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
