"""Figures drawn anew from what is stored: for a paper's column, in Python, or as the file that is asked for."""

import re

import matplotlib as mpl
import matplotlib.figure
import matplotlib.image
import pytest

import vines
from vines.errors import DeclarationError, StoreError, UnknownNameError
from vines.figures._saved import save, save_as
from vines.stages import study

FIGURE = "quickstart.figure"


@pytest.fixture(scope="module")
def made(quickstart):
    return study(quickstart.root)


def test_a_figure_is_matplotlibs_own_and_may_be_changed(made):
    figure = vines.figure("quickstart", width="85mm", study=made)
    assert figure.get_size_inches()[0] == pytest.approx(85 / 25.4)
    assert [ax.get_xlabel() for ax in figure.axes][-1] == "forcing amplitude  $A$"
    figure.axes[0].set_ylim(-3, 3)
    assert vines.figure(FIGURE, study=made).get_size_inches()[0] == 7.0


def test_files_have_the_format_that_is_asked_for_and_text_that_can_be_searched(quickstart, tmp_path):
    for ending in ("pdf", "svg", "png"):
        done = quickstart.vines("figure", FIGURE, "--out", tmp_path / f"a.{ending}", "--width", "85mm", "--dpi", "100")
        assert done.stdout.startswith(f"wrote {tmp_path / f'a.{ending}'}")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
    assert b"/Type /Font" in (tmp_path / "a.pdf").read_bytes()
    assert "forcing amplitude" in (tmp_path / "a.svg").read_text("utf-8")
    assert matplotlib.image.imread(tmp_path / "a.png").shape[1] == pytest.approx(335, abs=2)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.pdf", "a.png", "a.svg"]


def test_the_same_figure_has_the_same_bytes(made, tmp_path):
    from vines.stages import save_figure

    one, other = (save_figure(FIGURE, tmp_path / name, study=made) for name in ("a.pdf", "b.pdf"))
    assert one.read_bytes() == other.read_bytes()


def test_a_style_sheet_is_laid_over_the_look_of_vines(made, tmp_path):
    sheet = tmp_path / "thesis.mplstyle"
    sheet.write_text("axes.linewidth: 2.5\nfont.family: DejaVu Serif\n")
    figure = vines.figure(FIGURE, style=sheet, study=made)
    assert figure.axes[0].spines["left"].get_linewidth() == 2.5
    assert figure.axes[0].xaxis.label.get_fontfamily() == ["DejaVu Serif"]
    assert vines.figure(FIGURE, study=made).axes[0].spines["left"].get_linewidth() == 0.7
    assert mpl.rcParams["axes.linewidth"] == 0.8


def looked(made, **look):
    return vines.figure(FIGURE, width="85mm", overrides={"stages.figure.look": look}, study=made)


def test_the_look_of_a_declaration_has_size_letters_colours_labels_and_limits(made):
    plain = looked(made)
    figure = looked(
        made,
        height="150mm",
        font_size=7,
        letters=False,
        labels={"A": "amplitude", "w_dot": "velocity"},
        limits={"w_dot": [-3, 3], "A": [0.016, 0.02]},
        colours={"L": "#117733", "symmetric L": "#117733"},
    )
    assert figure.get_size_inches() == pytest.approx((85 / 25.4, 150 / 25.4))
    above, below = figure.axes
    assert (above.get_ylabel(), below.get_xlabel()) == ("velocity", "amplitude")
    assert (above.get_ylim(), above.get_xlim(), below.get_xlim()) == ((-3, 3), (0.016, 0.02), (0.016, 0.02))
    assert not above.texts
    assert [text.get_text() for text in plain.axes[0].texts] == ["(a)"]
    used = {line.get_color() for line in above.lines}
    assert {"#117733", "#0b4ea2"} <= used
    assert "#c8102e" not in used
    assert "#88bb99" in used  # impacts on L follow, halfway to white
    assert above.title.get_fontsize() == pytest.approx(plain.axes[0].title.get_fontsize() * 7 / 8.5)
    assert figure.legends[0].get_texts()[0].get_fontsize() == pytest.approx(8 * 7 / 8.5)


def test_the_legend_stands_where_it_is_asked_for(made):
    places = {place: looked(made, legend=place) for place in ("below", "above", "right", "none")}
    for figure in places.values():
        figure.draw_without_rendering()
    below, above, right = (places[name].legends[0].get_window_extent() for name in ("below", "above", "right"))
    panels = {name: figure.axes[0].get_window_extent() for name, figure in places.items()}
    assert below.y1 < panels["below"].y0
    assert above.y0 > panels["above"].y1
    assert right.x0 > panels["right"].x1
    assert places["none"].legends == []


def test_ticks_that_come_when_a_limit_is_moved_look_as_those_that_were_there(made):
    figure = vines.figure(FIGURE, study=made)
    ax = figure.axes[0]
    ax.set_ylim(-300, 300)
    figure.draw_without_rendering()
    assert {tick.get_tickdir() for tick in ax.yaxis.get_major_ticks()} == {"in"}
    assert {tick.label1.get_fontsize() for tick in ax.yaxis.get_major_ticks()} == {8.5}


SENSELESS = {
    "millimetres as inches": (["--width", "85"], r'width is 85 inch; allowed is 1\.5 to 20 .*; write "85mm" for mm'),
    "a poster": (["--width", "3m"], "mm, cm, in or pt"),
    "a hair": (["--width", "5mm"], "allowed is 1.5 to 20 inch"),
    "another format": (["--out", "a.jpg"], r"a figure ends in \.pdf, \.png, \.svg, such as a\.pdf"),
    "no folder": (["--out", "none/a.pdf"], "the folder none does not exist"),
    "no style": (["--style", "thesys"], "no style 'thesys'"),
    "no style sheet": (["--style", "none.mplstyle"], "no such style sheet"),
    "an unknown option": (["--set", "stages.figure.colour='red'"], "unknown key 'colour'"),
    "a colour by name": (
        ["--set", 'stages.figure.look.colours={L="red"}'],
        "look.colours.L is 'red'; allowed is \"#rrggbb\"",
    ),
    "no colour": (["--set", 'stages.figure.look.colours={Lft="#ffffff"}'], "no colour 'Lft': .* names"),
    "what no axis can show": (["--set", 'stages.figure.look.labels={w_dt="a"}'], "did you mean 'w_dot'"),
    "what no axis shows": (
        ["--set", "stages.figure.look.limits={reduction=[0, 1]}"],
        "look.limits.reduction: no axis of this figure shows it: .*A, dt, w_dot",
    ),
    "limits the wrong way": (["--set", "stages.figure.look.limits={dt=[1, 0]}"], "give the lower end first"),
    "millimetres as inches of height": (["--set", "stages.figure.look.height=60"], 'write "60mm" for mm'),
    "too low for what is in it": (["--set", "stages.figure.look.height='45mm'"], "do not fit the size of the figure"),
    "a letter of a poster": (["--set", "stages.figure.look.font_size=100"], "allowed is font_size <= 24"),
    "a formula that is none": (
        ["--set", "stages.figure.look.labels={A='$\\frac{$'}"],
        "a text of the figure cannot be set",
    ),
    "a format that is none": (["--set", 'stages.figure.look.formats=["gif"]'], "allowed: pdf, png, svg"),
    "a format twice": (["--set", 'stages.figure.look.formats=["pdf", "pdf"]'], "names a format twice"),
}


@pytest.mark.parametrize("case", SENSELESS)
def test_what_cannot_be_is_one_line_and_leaves_no_file(quickstart, case, tmp_path, monkeypatch):
    arguments, expected = SENSELESS[case]
    before = set(quickstart.root.iterdir())
    done = quickstart.vines("figure", FIGURE, *arguments, check=False)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    assert re.search(expected, done.stderr), done.stderr
    assert set(quickstart.root.iterdir()) == before


def test_a_style_sheet_with_a_mistake_is_named(made, tmp_path):
    sheet = tmp_path / "thesis.mplstyle"
    sheet.write_text("axes.linewidht: 2.5\n")
    with pytest.raises(DeclarationError, match=r"thesis\.mplstyle: .*axes\.linewidht"):
        vines.figure(FIGURE, style=sheet, study=made)
    sheet.write_text("font.family: No Such Font\n")
    with pytest.raises(DeclarationError, match="none of the fonts of 'No Such Font' is installed"):
        vines.figure(FIGURE, style=sheet, study=made)


def test_names_that_are_none_and_results_that_are_stale_are_refused(made):
    with pytest.raises(UnknownNameError, match=r"quickstart has no figure 'up': .*figure"):
        vines.figure("quickstart.up", study=made)
    with pytest.raises(UnknownNameError, match=r"fig2 has 2 figures; name one: fig2\.figure, fig2\.caption_figure"):
        vines.figure("fig2", study=made)
    with pytest.raises(
        StoreError, match=r"quickstart\.\w+ is not computed as it is declared \(.*'vines run quickstart "
    ):
        vines.figure(FIGURE, overrides={"params.r": 0.6}, study=made)


@pytest.mark.parametrize("width", [85, 0.5, -1, "85"])
def test_a_width_that_is_no_width_is_refused_when_it_is_declared(project, width):
    declared = (project.root / "pipelines" / "quickstart.toml").read_text()
    value = f'"{width}"' if isinstance(width, str) else width
    text = declared.replace("[stages.figure]\n", f"[stages.figure]\nwidth = {value}\n")
    (project.root / "pipelines" / "mine.toml").write_text(text)
    done = project.vines("status", "mine", check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "width is" in done.stderr


SMALL = """
[stages.up]
kind = "sweep"
vary.A = [0.015, 0.016]
settle = 50
record = 16
[stages.picture]
kind = "figure"
plot = "bifurcation"
needs = ["up"]
"""


def test_only_the_files_that_are_declared_are_written_and_named(project):
    text = "[params]\nmu = 0.01\n" + SMALL + '[stages.picture.look]\nformats = ["png"]\ndpi = 60\n'
    (project.root / "pipelines" / "small.toml").write_text(text)
    said = project.vines("run", "small", "--jobs", "1").stdout
    assert [path.name for path in (project.data / "figures").iterdir()] == ["small.picture.png"]
    assert re.search(r"figures/small\.picture\.png\n", said)
    assert matplotlib.image.imread(project.data / "figures" / "small.picture.png").shape[1] == 420
    project.vines("report", "small", "--out", "small.html")
    assert "data:image/png;base64," in (project.root / "small.html").read_text()


def test_pictures_lie_under_the_names_of_their_stages_and_a_copy_that_is_changed_comes_back(project):
    (project.root / "pipelines" / "small.toml").write_text("[params]\nmu = 0.01\n" + SMALL)
    said = project.vines("run", "small", "--jobs", "1").stdout
    copies = {path.name: path for path in (project.data / "figures").iterdir()}
    assert sorted(copies) == ["small.picture.pdf", "small.picture.png", "small.picture.svg"]
    assert re.search(r"figures/small\.picture\.png \(and \.svg, \.pdf\)", said)
    (drawn,) = project.data.glob("results/*/picture.pdf")
    right = {ending: drawn.with_suffix(ending).read_bytes() for ending in (".pdf", ".png", ".svg")}
    copies["small.picture.pdf"].write_bytes(b"retouched")
    copies["small.picture.png"].unlink()
    assert drawn.read_bytes() == right[".pdf"]
    assert "nothing to compute" in project.vines("run", "small").stdout
    assert {path.suffix: path.read_bytes() for path in copies.values()} == right


def test_what_fonts_say_of_themselves_reaches_nobody(tmp_path, caplog, capfd):
    """The font of a prime has no date, of which fontTools warns."""
    figure = matplotlib.figure.Figure()
    figure.text(0.5, 0.5, "$w'$")
    save(figure, tmp_path, formats=["pdf"])
    save_as(figure, tmp_path / "a.pdf")
    assert caplog.records == []
    assert capfd.readouterr().err == ""
