"""The report: one page that asks nothing of a network, in a real browser."""

from html.parser import HTMLParser

import pytest

from tests.viewer.chromium import chromium
from vines.stages.reports._page import Figure, Head, Run, Section, StageFacts, page

SVG = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 20"><rect width="40" height="20" fill="#c8102e"/></svg>'


@pytest.fixture(scope="module")
def written(quickstart, tmp_path_factory):
    """Give the report of the quickstart."""
    path = tmp_path_factory.mktemp("report") / "quickstart.html"
    told = quickstart.vines("report", "quickstart", "--out", path).stdout
    assert str(path) in told
    return path


class Links(HTMLParser):
    """Collects what a page refers to."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        self.found += [value for name, value in attrs if name in ("src", "href") and value]


def test_the_page_in_chromium(written, browser_program):
    with chromium(browser_program) as browser:
        browser.open(written.as_uri())
        browser.wait_for("document.readyState === 'complete'")
        images = "[...document.images].every(image => image.complete && image.naturalWidth > 0 && image.width > 300)"
        browser.wait_for(images)
        assert browser.ask("document.images.length") == 1
        assert browser.ask("document.querySelectorAll('td.verdict.reproduced').length") == 5
        # zoom by button, by keys, and back
        browser.ask("document.querySelector('button[data-act=in]').click()")
        assert browser.ask("document.querySelector('figure').dataset.scale") == "1.500"
        before = browser.ask("document.images[0].width")
        browser.ask("document.querySelector('.frame').dispatchEvent(new KeyboardEvent('keydown', {key: '+'}))")
        assert browser.ask("document.images[0].width") == pytest.approx(1.5 * before, rel=0.01)
        browser.ask("document.querySelector('.frame').dispatchEvent(new KeyboardEvent('keydown', {key: '0'}))")
        assert browser.ask("document.querySelector('figure').dataset.scale") == "1.000"
        # sort and filter the checks
        head = "document.querySelector('#quickstart-checks thead tr').cells[0]"
        rows = "[...document.querySelectorAll('#quickstart-checks tbody tr')].filter(r => !r.hidden)"
        cells = f"{rows}.map(r => r.cells[0].textContent)"
        browser.ask(f"{head}.querySelector('button').click()")
        assert browser.ask(cells) == sorted(browser.ask(cells))
        browser.ask(f"{head}.querySelector('button').click()")
        assert browser.ask(cells) == sorted(browser.ask(cells), reverse=True)
        browser.ask(
            "const i = document.querySelector('input'); i.value = 'fig2_a'; i.dispatchEvent(new Event('input'))"
        )
        assert browser.ask(cells) == ["fig2_a"]
        # light and dark
        paper = "getComputedStyle(document.body).backgroundColor"
        colours = []
        for scheme in ("light", "dark"):
            browser.media(prefers_color_scheme=scheme)
            colours.append(browser.ask(paper))
        assert colours == ["rgb(255, 255, 255)", "rgb(25, 26, 27)"]
        assert browser.console == []
        asked = [address for address in browser.asked() if not address.startswith(("data:", "about:"))]
    assert asked == [written.as_uri()]


def test_the_page_refers_only_to_itself_and_to_logs_beside_it(written):
    links = Links()
    links.feed(written.read_text("utf-8"))
    others = [link for link in links.found if not link.startswith(("#", "data:"))]
    assert len(others) == 4
    assert all(link.endswith(".mcap") and (written.parent / link).is_file() for link in others)
    text = written.read_text("utf-8")
    assert "vines view quickstart.two_one_run" in text
    assert "default-src &#x27;none&#x27;" in text


def section(name, **changes):
    told = {
        "title": f"<b>{name}</b>",
        "source": "Fig. 1",
        "figures": [Figure(f"{name}.figure", "A <figure>", SVG, "svg")],
        "checks": [{"id": "c", "verdict": "differs", "statement": "a < b & c", "remark": '"x"'}],
        "comparisons": [],
        "runs": [Run(f"{name}.run", "1:1", "run.mcap")],
        "tables": [Head(f"{name}.up", "points", 300, ["A", "name"], [[0.1, None], [float("nan"), "<2:1>"]])],
        "stages": [StageFacts("up", "sweep", 300, 0, 12_345, 75.0, {"key": "ab" * 32})],
    }
    return Section(name=name, **{**told, **changes})


def test_text_is_escaped_and_a_collection_has_contents():
    text = page("both", "Two & more", "", [section("one"), section("two", figures=[], checks=[], stages=[])])
    assert "<b>one</b>" not in text
    assert "a &lt; b &amp; c" in text
    assert "&lt;2:1&gt;" in text
    assert '<a href="#two">' in text
    assert "1 min 15 s" in text
    assert "300 rows, the first 2" in text
    links = Links()
    links.feed(text)
    assert "#one" in links.found


def test_what_cannot_be_reported_is_one_line(quickstart, tmp_path):
    for arguments, words in (
        (("quikstart",), "did you mean 'quickstart'"),
        (("diagram",), "nothing is stored of the pipeline 'diagram' yet; 'vines run diagram' computes it"),
        (("quickstart", "--out", tmp_path / "no" / "such.html"), "does not exist"),
    ):
        done = quickstart.vines("report", *arguments, check=False)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert words in done.stderr
