"""Every plot with every system: drawn with the system's names, or refused in one line before any work."""

from dataclasses import replace

import numpy as np
import pytest

import vines
from tests.stages.test_sheet import inputs
from vines.errors import DeclarationError
from vines.figures._colours import BALLS
from vines.model import system_names
from vines.stages import load_pipeline, run
from vines.stages.plots import PLOTS
from vines.stages.plots._runs import run_curves

pytestmark = pytest.mark.long(40)

# Of each system a sweep, one of two parameters, a branch and a run; `pair_` and `two_` begin their names.
PARAMETERS = {
    "impact_pair": (
        "pair",
        "r = 0.5, G = 0.05",
        "B",
        "[0.6, 0.65, 0.7]",
        "G",
        "[0.04, 0.05]",
        "LR",
        "B = 0.6",
        "w",
        "w_dot",
    ),
    "parallel": (
        *("two", "mu = [0.01, 0.01], beta = [1.0, 1.4]", "A", "[0.028, 0.029, 0.03]", "Omega", "[0.999, 1.0]"),
        *("L1L2R1R2", "A = 0.03", "x2_1", "phase"),
    ),
    "drag": (
        *("coil", "mu = 0.02, delta = 0.05", "A", "[0.028, 0.029, 0.03]", "Omega", "[0.999, 1.0]"),
        *("LR", "A = 0.03", "x2", "v2"),
    ),
    "friction": (
        *("slid", "mu = 0.02, f = 0.001", "A", "[0.028, 0.029, 0.03]", "Omega", "[0.999, 1.0]"),
        *("LR", "A = 0.03", "x2", "v2"),
    ),
    "modes": (
        *("beam", "mu = 0.05, omega = [1.0, 1.9], phi = [0.8, -0.7], gamma = [0.9, 0.5]", "A", "[0.028, 0.029, 0.03]"),
        *("Omega", "[0.999, 1.0]", "LR", "A = 0.03", "x2", "v2"),
    ),
    "duffing": (
        *("cube", "mu = 0.02, alpha = 0.5", "A", "[0.028, 0.029, 0.03]", "Omega", "[0.999, 1.0]"),
        *("LR", "A = 0.03", "x2", "v2"),
    ),
    "cubic_barriers": (
        *("cubic", "mu = 0.02, k3 = 0.5, l2 = 0.1", "A", "[0.028, 0.029, 0.03]", "Omega", "[0.999, 1.0]"),
        *("LR", "A = 0.03", "x2", "v2"),
    ),
    "hybrid": (
        *("both", "mu = 0.01, mu_n = 0.01, k3 = 1.0, l2 = 0.2", "A", "[0.028, 0.029, 0.03]", "Omega", "[0.999, 1.0]"),
        *("LR", "A = 0.03", "x2", "x3"),
    ),
}
STAGES = """
[stages.{short}_up]
kind = "sweep"
system = "{system}"
params = {{ {params} }}
vary.{axis} = {values}
carry = "{axis}"
settle = 100
record = 16
[stages.{short}_down]
kind = "sweep"
system = "{system}"
params = {{ {params} }}
vary.{axis} = {values}
carry = {{ axis = "{axis}", direction = "down" }}
settle = 100
record = 16
[stages.{short}_map]
kind = "sweep"
system = "{system}"
params = {{ {most} }}
vary.{axis} = {values}
vary.{other} = {others}
settle = 100
record = 16
[stages.{short}_branch]
kind = "branch"
system = "{system}"
params = {{ {params} }}
word = "{word}"
points = 3
vary.{axis} = {{ from = {first}, to = {last} }}
[stages.{short}_run]
kind = "trajectory"
system = "{system}"
params = {{ {params}, {at} }}
settle = 100
record = 3
[stages.{short}_plane]
kind = "basins"
system = "{system}"
params = {{ {params}, {at} }}
x = {{ name = "{x}", from = -0.9, to = 0.9, count = 4 }}
y = {{ name = "{y}", from = -0.9, to = 0.9, count = 4 }}
"""
# What a figure of each plot says beside its name, for each system that it draws.
DRAWN = {
    "basins": ("{short}_plane",),
    "bifurcation": ("{short}_up", "{short}_branch"),
    "multipliers": ("{short}_branch",),
    "regimes": ("{short}_map",),
    "measures": ("{short}_up", "{short}_down"),
    "response": ("{short}_up", "{short}_down"),
    "sheet": ("{short}_run", "{short}_up", "{short}_branch"),
    "designs": ("{short}_map",),
    "best": ("{short}_map",),
}
CELLS = {
    "measures": [{"show": "impact_power"}],
    "response": [{"show": "w_dot"}],
    "sheet": [
        *({"show": show, "of": "{short}_run"} for show in ("ends", "gap", "phase_plane")),
        {"show": "w_dot", "of": "{short}_up"},
    ],
    "designs": [{"show": "over"}],
    "best": [{"show": "map"}, {"show": "lead"}],
}


def _cells(plot, short, needs):
    for cell in CELLS.get(plot, ()):
        shown = (
            [f"set {short}"]
            if plot == "designs"
            else []
            if plot == "best"
            else [cell["of"].format(short=short)]
            if "of" in cell
            else needs
        )
        yield f"[[stages.{plot}_{short}.cells]]\nshow = {cell['show']!r}\nof = {shown}\n"


def figure(plot, system):
    """Return the declaration of a figure of a plot and a system."""
    short = PARAMETERS[system][0]
    needs = [each.format(short=short) for each in DRAWN.get(plot, ("{short}_up",))]
    text = f"[stages.{plot}_{short}]\nkind = 'figure'\nplot = '{plot}'\nneeds = {needs}\n"
    if plot == "designs":
        # the measure of a pair is its power; that less of it were better is not said of it
        pair, two = ("B", "[0.6, 0.7]", "impact_power"), ("A", "[0.028, 0.03]", "reduction")
        axis, span, measure = pair if short == "pair" else two
        text += f"over = '{axis}'\nspan = {span}\nmeasure = '{measure}'\nsets = {{ 'set {short}' = {needs} }}\n"
    if plot == "best":
        measure = "impact_power" if short == "pair" else "reduction"
        text += f"measure = '{measure}'\nsets = {{ one = {needs}, another = {needs} }}\n"
    return text + "".join(_cells(plot, short, needs))


def stages(systems=PARAMETERS):
    """Return the declarations of the stages that are drawn, of some systems."""
    text = ""
    for system in systems:
        short, params, axis, values, other, others, word, at, x, y = PARAMETERS[system]
        most = params.replace(", G = 0.05", "")
        first, last = values.strip("[]").split(", ")[0], values.strip("[]").split(", ")[-1]
        known = {"short": short, "system": system, "params": params, "most": most, "axis": axis, "values": values}
        known |= {"other": other, "others": others, "word": word, "at": at, "x": x, "y": y}
        text += STAGES.format(**known, first=first, last=last)
    return text


@pytest.fixture
def declared(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))

    def declare(text, systems=("impact_pair", "parallel")):
        (project.root / "pipelines" / "each.toml").write_text(stages(systems) + text)
        return project.root

    return declare


def pairs(drawn):
    """Return each plot with each system that it draws, or does not."""
    others = [name for name in system_names() if name != "vi_nes"]
    plots = sorted(PLOTS.all().items())
    return [(name, system) for name, plot in plots for system in others if plot.draws(system) == drawn]


def test_there_is_an_example_of_every_system_and_of_every_plot_that_draws_one():
    assert set(PARAMETERS) | {"vi_nes"} == set(system_names())
    # charts, fronts and exits are drawn where curves, drag and noise are tested
    assert {name for name, _ in pairs(True)} - {"chart", "exits", "front"} == set(DRAWN)


@pytest.mark.parametrize(("plot", "system"), pairs(False))
def test_what_a_plot_cannot_do_is_refused_with_what_it_can_and_what_can_do_it(declared, plot, system):
    declared(figure(plot, system), [system])
    with pytest.raises(DeclarationError) as caught:
        load_pipeline("each")
    said = str(caught.value)
    short = PARAMETERS[system][0]
    can = ", ".join(name for name in system_names() if PLOTS.get(plot).draws(name))
    assert f"the plot {plot!r} cannot draw the system {system!r} of {short}_up; it can draw {can}" in said
    assert f"plots that can draw {system!r}: basins, best, bifurcation, " in said
    assert "\n" not in said


@pytest.mark.parametrize(
    ("plot", "system", "right", "wrong", "said"),
    [
        ("sheet", "impact_pair", "'w_dot'", "'x1'", "the system 'impact_pair' has no x1; a sheet of it shows"),
        ("response", "impact_pair", "'w_dot'", "'energy'", "'impact_pair' has no max_abs_x1"),
        ("measures", "impact_pair", "impact_power", "reduction", "has no column 'reduction' of numbers"),
        ("bifurcation", "parallel", "two_branch", "pair_up", "one and the same parameter"),
        ("multipliers", "parallel", "branch", "up", "name a stage of kind 'branch' in needs"),
        ("regimes", "parallel", "two_map", "two_up", "draws one sweep over two parameters"),
        ("designs", "parallel", "0.028,", "0.02,", "by a factor of 1.071, the span is one of 1.5"),
        ("designs", "parallel", "'reduction'", "'reductio'", "unknown measure 'reductio': did you mean"),
        ("designs", "parallel", "over = 'A'", "over = 'G'", "does not vary G; it varies A, Omega"),
        ("designs", "impact_pair", "[0.6, 0.7]", "[0.6, 0.65]", "is tilted, so that lengths have no free"),
    ],
)
def test_mistakes_in_figures_of_systems_are_one_line(declared, plot, system, right, wrong, said):
    declared(figure(plot, system).replace(right, wrong))
    with pytest.raises(DeclarationError) as caught:
        load_pipeline("each")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def some(plot, system):
    """Say whether the short test draws this: all of a pair and of two balls, each plot of one of the others in turn."""
    whole = ("impact_pair", "parallel")
    others = [name for name in PARAMETERS if name not in whole]
    return system in whole or system == others[sorted(DRAWN).index(plot) % len(others)]


@pytest.mark.parametrize(
    "chosen", [some, pytest.param(lambda *each: True, marks=pytest.mark.full)], ids=["some", "all"]
)
def test_every_plot_draws_every_system_with_names_of_its_own(declared, chosen):
    drawn = [each for each in pairs(True) if each[0] in DRAWN and chosen(*each)]
    assert {plot for plot, _ in drawn} == set(DRAWN)
    root = declared("".join(figure(*each) for each in drawn), PARAMETERS)
    form = load_pipeline("each").stages
    run("each", stages={name for stage in form.values() if stage.kind.name == "figure" for name in stage.needs})
    found = {}
    for stage in form.values():
        if stage.kind.name == "figure":
            ways = {name: form[name].carry for name in stage.needs}
            shown = {
                name: replace(each, carried=ways[name].axis, direction=ways[name].direction) if ways[name] else each
                for name, each in inputs(root, "each", stage.needs).items()
            }
            plot, short = stage.name.split("_")
            found[plot, short] = PLOTS.get(plot).draw(shown, stage.options)
    capsule = "amplitude of the capsule  $B$"
    known = {capsule, "forcing amplitude  $A$", "time  $t/T$", "gap  $w$", "$w$ at the start"}
    known |= {"$x_2$ at the start", "$x_{2,1}$ at the start"}
    for (plot, short), drawn in found.items():
        named = {ax.get_xlabel() for ax in drawn.axes} - {""}
        assert named <= known, plot
        assert (capsule in named) == (short == "pair" and plot != "basins"), plot

    assert [found["basins", s].axes[0].get_ylabel() for s in ("pair", "two")] == [
        "$w'$ at the start",
        r"phase $\phi$ at the start",
    ]

    # impacts and lines of the two balls in their colours, at the speeds of check value a3
    ax = found["bifurcation", "two"].axes[0]
    dots = [line for line in ax.lines if line.get_marker() in "<>"]
    assert {line.get_color() for line in dots} == set(BALLS[:2])
    lines = [line for line in ax.lines if line.get_linestyle() == "-" and line.get_marker() == "None"]
    ends = {(line.get_color(), round(float(line.get_ydata()[-1]), 6)) for line in lines}
    speeds = zip(BALLS[:2], (1.146405, 1.432042), strict=True)
    assert ends == {(colour, sign * speed) for colour, speed in speeds for sign in (1, -1)}
    assert {round(float(np.abs(line.get_ydata()[-1])), 4) for line in dots if line.get_color() == BALLS[1]} == {1.432}
    (legend,) = found["bifurcation", "two"].legends
    assert [text.get_text() for text in legend.get_texts()][:4] == ["ball 1", "ball 2", "simulated impact on L", "on R"]
    # a panel of a pair has two multipliers, one of two balls six
    moduli = [found["multipliers", short].axes[0].lines for short in ("pair", "two")]
    # beside the moduli there is the line 1, and lines and marks of events
    assert [sum(len(line.get_xdata()) > 2 for line in lines) for lines in moduli] == [2, 6]
    assert [found["regimes", s].axes[-1].get_ylabel() for s in ("pair", "two")] == ["power", r"$\sum K_2/K_1$"]
    ends, gap, plane, _ = found["sheet", "two"].axes
    # cavities of half lengths 1 and 1.4, a ball in each
    first, second = (ends.lines[k + 1].get_ydata() - ends.lines[k].get_ydata() for k in (0, 4))
    assert (set(np.round(first, 9)), set(np.round(second, 9))) == ({2.0}, {2.8})
    assert [line.get_color() for line in plane.lines[-2:]] == list(BALLS[:2])
    assert plane.get_xlim() == pytest.approx((-1.61, 1.61))
    assert float(np.abs(gap.lines[2].get_ydata()).max()) == pytest.approx(1.0, abs=1e-9)
    # marks of sweeps up and down; of one attractor both tell the same
    up, down = found["measures", "pair"].axes[0].lines
    assert (up.get_marker(), down.get_marker()) == ("^", "v")
    assert up.get_ydata() == pytest.approx(down.get_ydata(), abs=1e-9)


def test_a_gap_at_a_wall_is_the_wall(declared):
    """It is no difference of two positions: that was beyond the wall by rounding, and the stage was refused."""
    declared("")
    run("each", stages=["pair_map"])
    gaps = vines.query("select distinct w, side from impact_pair_impacts").to_pylist()
    assert {(row["w"], row["side"]) for row in gaps} == {(1.0, 1), (-1.0, -1)}


def test_a_run_of_two_balls_has_a_curve_for_each(declared):
    root = declared("")
    run("each", stages=["two_run"])
    first, second = run_curves(inputs(root, "each", ["two_run"]).values())
    told = [(each.ball, each.length, each.label) for each in (first, second)]
    assert told == [(1, 1.0, "ball 1"), (2, 1.4, "ball 2")]
    for each in (first, second):
        assert np.abs(each.hit_w_dot).min() > 1
        assert float(np.abs(each.w).max()) == pytest.approx(each.length, abs=1e-9)
