"""Sheets: six figures of the paper on small grids, runs that start where a sweep had settled, and bad declarations."""

import numpy as np
import pytest

import vines
from vines.errors import DeclarationError
from vines.figures._colours import FAMILIES
from vines.logs import read
from vines.pipeline import Input
from vines.stages import find_logs, load_pipeline, run
from vines.stages.plots._runs import run_curves
from vines.stages.plots.sheet import PLOT
from vines.store import Store

pytestmark = [pytest.mark.long(14), pytest.mark.usefixtures("coarse_look")]


@pytest.fixture
def root(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    return project.root


def inputs(root, pipeline, names):
    """Return finished stages as a figure gets them."""
    store = Store(root / "data")
    found = {}
    for name in names:
        result = store.result(store.pins(pipeline)[name]["result"])
        form = result.manifest["ingredients"]
        axes = tuple(axis[0] for axis in form["vary"])
        known = dict(form["params"])
        found[name] = Input(
            name, result.manifest["kind"], result.key, known, axes, result.tables, result.logs, result.folder
        )
    return found


def drawn(root, pipeline, stage):
    """Return the figure of a sheet from finished stages."""
    declared = load_pipeline(pipeline).stages[stage]
    return PLOT.draw(inputs(root, pipeline, declared.needs), declared.options)


def test_fig2_has_a_row_a_run_and_each_run_opens_as_a_log(root):
    runs = ["symmetric_run", "asymmetric_run", "doubled_run", "two_one_run"]
    run("fig2", stages=runs, overrides={f"stages.{name}.settle": 400 for name in runs})
    names = {name: read(*find_logs(f"fig2.{name}")).attractor for name in runs}
    assert list(names.values()) == ["1:1", "1:1", "2:2/2T", "2:1"]
    axes = drawn(root, "fig2", "figure").axes
    assert [ax.get_title(loc="left") for ax in axes] == [f"({letter})" for letter in "abcdefghijkl"]
    assert [ax.get_title() for ax in axes[::3]] == ["$A = 0.015$", "$A = 0.020$", "$A = 0.021$", "$A = 0.023$"]
    for ends, gap, plane in zip(axes[::3], axes[1::3], axes[2::3], strict=True):
        assert ends.get_xlim() == gap.get_xlim() == (0, 4)
        curve = max(plane.lines, key=lambda line: len(line.get_xdata()))
        assert np.abs(curve.get_xdata()).max() == pytest.approx(1, abs=1e-12)
        # The impact law as vertical lines: at both walls the velocity jumps by the factor -r.
        jumps = [(w, a, b) for w, a, b in _jumps(curve) if abs(abs(w) - 1) < 1e-9]
        assert {round(w) for w, _, _ in jumps} == {-1, 1}
        assert all(b == pytest.approx(-0.65 * a, rel=1e-9) for _, a, b in jumps)


def _jumps(curve):
    w, v = curve.get_data()
    return [(w[k], v[k], v[k + 1]) for k in range(len(w) - 1) if w[k] == w[k + 1] and v[k] * v[k + 1] < 0]


def test_fig4_panels_lines_and_bifurcations(root):
    coarse = {"from": 0.015, "to": 0.0215, "step": 0.0001}
    small = {f"stages.{name}.vary.A": coarse for name in ("up", "down")}
    runs = ["symmetric_run", "asymmetric_run", "before_doubling_run", "doubled_run"]
    small |= {f"stages.{name}.settle": 200 for name in ("up", "down", *runs)} | {"stages.one_one.points": 40}
    run("fig4", stages=["up", "down", "one_one", *runs], overrides=small)
    axes = drawn(root, "fig4", "figure").axes
    assert [ax.get_title(loc="left") for ax in axes] == [f"({letter})" for letter in "abcdef"]
    assert [ax.get_xlim() for ax in axes[::3]] == [(0.015, 0.020), (0.020, 0.0215)]
    assert [ax.get_xlim() for ax in axes[2::3]] == [(0.015, 0.020), (0.020, 0.0215)]
    assert [text.get_text() for ax in axes for text in ax.texts] == ["$B_1$", "$B_1$", "$B_2$", "$B_2$"]
    for ax, values in ((axes[1], ("0.017", "0.019")), (axes[4], ("0.0204", "0.0207"))):
        assert [text.get_text() for text in ax.get_legend().get_texts()] == [f"$A = {value}$" for value in values]
    for ax in axes[2::3]:
        assert any(list(line.get_ydata()) == [1.0, 1.0] for line in ax.lines)
    labels = [text.get_text() for text in axes[0].figure.legends[0].get_texts()]
    assert "$B_1$: symmetry breaking (0.018008)" in labels
    assert "$B_2$: period doubling (0.020474)" in labels
    # The impact speeds of both ends are the same, so only flight times and places show that symmetry is broken.
    broken = drawn(root, "fig4", "broken_symmetry").axes
    assert [ax.get_ylabel().split("  ")[0] for ax in broken] == ["time to next impact", "displacement at impact"]


def test_fig5_shows_regular_motion_solid_and_chaos_pale(root):
    coarse = {"from": 0.002, "to": 0.065, "step": 0.001}
    sweeps = ["up", "down", "random_1", "random_2"]
    small = {f"stages.{name}.vary.A": coarse for name in sweeps} | {f"stages.{name}.settle": 100 for name in sweeps}
    branches = ["one_one", "two_one", "one_two"]
    small |= {f"stages.{name}.points": 40 for name in branches}
    run("fig5", stages=[*sweeps, *branches], overrides=small)
    (ax,) = drawn(root, "fig5", "figure").axes
    low, high = ax.get_xlim()
    assert low <= 0.002 < 0.065 <= high
    assert not ax.get_title(loc="left")
    dots = ax.collections
    assert len(dots) == 2 * len(sweeps)
    places = dots[0].get_offsets()[:, 0]
    regular = dots[0].get_alpha()[(places > 0.0105) & (places < 0.0195)]
    chaos = dots[0].get_alpha()[(places > 0.04) & (places < 0.0415)]
    assert len(regular)
    assert len(chaos)
    assert regular.min() > 0.95 > 0.1 > chaos.max()
    colours = {line.get_color() for line in ax.lines}
    assert {colour for name in ("symmetric", "asymmetric", "unequal") for colour in FAMILIES[name]} <= colours


def test_fig6_has_two_panels_against_mu_and_one_against_omega(root):
    sweeps = {f"stages.mass_{way}.vary.mu": {"from": 0.38, "to": 0.82, "step": 0.02} for way in ("up", "down")}
    sweeps |= {f"stages.frequency_{way}.vary.Omega": {"from": 1.15, "to": 1.85, "step": 0.05} for way in ("up", "down")}
    small = {f"{key.split('.vary')[0]}.settle": 100 for key in sweeps}
    branches = [f"mass_{word}" for word in ("one_one", "two_one", "one_two")] + ["frequency_one_one"]
    small |= {f"stages.{name}.points": 30 for name in branches} | sweeps
    run("fig6", stages=[key.split(".")[1] for key in small if key.endswith(("settle", "points"))], overrides=small)
    axes = drawn(root, "fig6", "figure").axes
    assert [ax.get_xlabel() for ax in axes] == [
        r"mass ratio  $\mu$",
        r"mass ratio  $\mu$",
        r"frequency ratio  $\Omega$",
    ]
    assert [ax.get_xlim() for ax in axes] == [(0.4, 0.8), (0.66, 0.8), (1.2, 1.8)]
    drawn_colours = [{line.get_color() for line in ax.lines} for ax in axes]
    assert set(FAMILIES["unequal"]) <= drawn_colours[0]
    assert not set(FAMILIES["unequal"]) & (drawn_colours[1] | drawn_colours[2])
    assert set(FAMILIES["asymmetric"]) <= drawn_colours[1] & drawn_colours[2]


def test_fig10_has_a_row_a_mass_ratio(root):
    runs = {"peak_run": "1:1", "beyond_run": "1:1", "two_one_run": "2:1", "complex_run": "chaotic"}
    run("fig10", stages=list(runs), overrides={f"stages.{name}.settle": 400 for name in runs})
    assert {name: read(*find_logs(f"fig10.{name}")).attractor for name in runs} == runs
    axes = drawn(root, "fig10", "figure").axes
    assert [ax.get_title(loc="left") for ax in axes] == ["(a)", "", "(b)", "", "(c)", "", "(d)", ""]
    assert [ax.get_title() for ax in axes[::2]] == [rf"$\mu = {mu}$" for mu in (0.4, 0.45, 0.24, 0.6)]
    assert {ax.get_xlabel() for ax in axes[-2:]} == {"gap  $w$", "time  $t/T$"}


def test_fig11_has_two_attractors_at_the_same_parameters(root):
    small = {"stages.up.settle": 300, "stages.down.settle": 100}
    small |= {f"stages.{name}.settle": 100 for name in ("one_one_run", "complex_run")}
    run("fig11", stages=["figure"], overrides=small)
    assert len(list(root.glob("data/results/*/picture.svg"))) == 1
    one, other = (read(*find_logs(f"fig11.{name}")) for name in ("one_one_run", "complex_run"))
    assert one.parameters == other.parameters
    assert one.parameters["Omega"] == 1.17
    sizes = [np.abs(log.states["x1"].to_numpy()).max() for log in (one, other)]
    assert sizes[0] < 0.2 < 0.4 < sizes[1]
    axes = drawn(root, "fig11", "figure").axes
    assert [ax.get_title(loc="left") for ax in axes] == ["(a)", "", "(b)", ""]


CARRIED = """
title = "carried"
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = [0.019, 0.0205]
carry = "A"
settle = 300
record = 8
[stages.run]
kind = "trajectory"
settle = 0
record = 2
vary.A = [0.0205]
carry = { axis = "A", start = { from = "up", at = { A = 0.0205 } } }
"""


def test_a_run_starts_where_the_sweep_ended(root):
    (root / "pipelines" / "carried.toml").write_text(CARRIED)
    run("carried")
    (start,) = vines.query(
        "select end_x1, end_v1, end_x2, end_v2 from points where stage = 'up' and A > 0.02"
    ).to_pylist()
    (own,) = vines.query("select x1, v1, x2, v2, carry from points where stage = 'run'").to_pylist()
    assert [own[name] for name in ("x1", "v1", "x2", "v2")] == list(start.values())
    assert own["carry"] == "A"
    first = read(*find_logs("carried.run")).states.to_pylist()[0]
    assert [first[name] for name in ("x1", "v1", "x2", "v2")] == list(start.values())
    (curves,) = run_curves(inputs(root, "carried", ["run"]).values())
    assert curves.t[0] == 0
    assert curves.t[-1] == pytest.approx(2)


SHEET = """
title = "sheet"
[params]
mu = 0.01
[stages.up]
kind = "sweep"
vary.A = [0.019, 0.0205]
[stages.run]
kind = "trajectory"
params.A = 0.02
[stages.branch]
kind = "branch"
word = "LR"
vary.A = { from = 0.015, to = 0.016 }
[stages.figure]
kind = "figure"
plot = "sheet"
needs = ["up", "run", "branch"]
[[stages.figure.cells]]
show = "ends"
of = ["run"]
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('of = ["run"]', "of = []", "name stages"),
        ('of = ["run"]', 'of = ["runs"]', "'run'"),
        ('of = ["run"]', 'of = ["up"]', "kind 'trajectory'"),
        ('show = "ends"', 'show = "w_dot"', "vary one and the same parameter"),
        ('show = "ends"\nof = ["run"]', 'show = "multipliers"\nof = ["branch"]', "name it in families"),
        ('show = "ends"', 'show = "end"', "end"),
        ('plot = "sheet"', 'plot = "sheet"\ncolumns = 0', "columns is 0, allowed is columns >= 1"),
        ('plot = "sheet"', 'plot = "bifurcation"', "unknown key 'cells'"),
    ],
)
def test_a_wrong_sheet_is_one_line(root, old, new, said):
    assert old in SHEET
    (root / "pipelines" / "wrong.toml").write_text(SHEET.replace(old, new))
    with pytest.raises(DeclarationError, match=said) as caught:
        load_pipeline("wrong")
    assert "\n" not in str(caught.value)


def test_a_family_that_there_is_not_is_named(root):
    text = SHEET.replace('show = "ends"\nof = ["run"]', 'show = "multipliers"\nof = ["branch"]\nfamilies = ["2:1"]')
    (root / "pipelines" / "family.toml").write_text(
        text.replace('needs = ["up", "run", "branch"]', 'needs = ["branch"]')
    )
    with pytest.raises(vines.errors.VinesError, match="no branch '2:1'"):
        run("family")
