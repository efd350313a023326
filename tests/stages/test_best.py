"""The plot of which absorber is best where, the study that ships with it, and what its page says."""

import re
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pytest

import vines
from tests.project import REPOSITORY
from tests.stages.test_sheet import inputs
from vines.errors import DeclarationError
from vines.model import Params
from vines.stages import load_pipeline, run
from vines.stages.plots._best import rank, worth_of
from vines.systems import CubicBarriers, Drag, Friction, Parallel

pytestmark = pytest.mark.long(30)


@dataclass(frozen=True)
class Sweep:
    """What is asked of an input: points and attractors over A and Omega."""

    points: dict
    attractors: dict
    axes: tuple = ("A", "Omega")
    tables: tuple = ("parallel_points", "parallel_attractors")

    def table(self, name=None):
        return pa.table(self.attractors if name == "parallel_attractors" else self.points)


@pytest.fixture
def root(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    return project.root


def sweep(measures, more=()):
    """Return a sweep over two amplitudes and two frequencies; `more` are attractors of random starts."""
    ids = ["a", "b", "c", "d"]
    columns = {"point_id": ids, "A": [0.02, 0.04, 0.02, 0.04], "Omega": [0.9, 0.9, 1.1, 1.1]}
    points = columns | {"max_abs_x1": pa.array(measures, pa.float64()), "x1_no_ball": [1.0, 2.0, 3.0, 4.0]}
    return Sweep(points, {"point_id": [each for each, _ in more], "max_abs_x1": [value for _, value in more]})


def test_all_sweeps_and_their_random_starts_count_and_a_failed_run_gains_nothing():
    both = [sweep([0.1, 0.2, 0.3, 0.4], [("b", 0.9), ("c", 0.05)]), sweep([0.2, 0.1, 0.3, None])]
    found = worth_of(both, "max_abs_x1", "less")
    assert (found.x.tolist(), found.y.tolist()) == ([0.02, 0.04], [0.9, 1.1])
    assert found.worst.tolist() == [[0.2, 0.9], [0.3, np.inf]]
    assert found.best.tolist() == [[0.1, 0.1], [0.05, 0.4]]
    assert found.without.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    more = worth_of(both, "max_abs_x1", "more")
    assert more.worst.tolist() == [[0.1, 0.1], [0.05, -np.inf]]
    assert more.best.tolist() == [[0.2, 0.9], [0.3, 0.4]]


def test_a_size_is_a_factor_on_forcing_and_displacements():
    found = worth_of([sweep([0.1, 0.2, 0.3, 0.4])], "max_abs_x1", "less", 0.5, 1)
    assert (found.x.tolist(), found.y.tolist()) == ([0.01, 0.02], [0.9, 1.1])
    assert found.worst.tolist() == [[0.05, 0.1], [0.15, 0.2]]
    assert found.without.tolist() == [[0.5, 1.0], [1.5, 2.0]]


def test_the_best_is_found_by_counting_and_leads_by_the_ratio_to_the_second():
    rng = np.random.default_rng(3)
    values = list(rng.uniform(0.1, 2.0, (4, 5, 6)))
    values[0][0, 0] = np.inf
    for better in ("less", "more"):
        place, lead = rank(
            values if better == "less" else [np.where(np.isfinite(v), v, -np.inf) for v in values], better
        )
        for at in np.ndindex(5, 6):
            known = sorted((v[at], k) for k, v in enumerate(values) if np.isfinite(v[at]))
            first, second = known[:2] if better == "less" else known[:-3:-1]
            assert place[at] == first[1]
            ratio = second[0] / first[0]
            assert lead[at] == pytest.approx(ratio if better == "less" else 1 / ratio)
    nobody, _ = rank([np.full((1, 1), np.inf)] * 2, "less")
    assert nobody.tolist() == [[-1]]


SMALL = """
title = "two absorbers"
system = "parallel"
[params]
mu = [0.02]
beta = [1.0]
[stages.up]
kind = "sweep"
vary.A = [0.02, 0.03]
vary.Omega = [0.99, 1.0]
[stages.other]
kind = "sweep"
system = "cubic_barriers"
params = { mu = 0.02, k3 = 1.0 }
vary.A = [0.04, 0.06]
vary.Omega = [0.99, 1.0]
[stages.line]
kind = "sweep"
vary.A = [0.02, 0.03]
[stages.gone]
kind = "transient"
vary.V = [1.0, 2.0]
[stages.figure]
kind = "figure"
plot = "best"
needs = ["up", "other", "line", "gone"]
sets = { ball = ["up"], cubic = ["other"] }
sizes = { cubic = 0.5 }
cells = [{ show = "map" }, { show = "over", at = { Omega = 1.0 }, measure = "max_abs_x1" }]
"""


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        (', cubic = ["other"] }', " }", "declare at least two sets and one cell"),
        ('["other"] }', "[] }", "set 'cubic' is empty; name sweeps"),
        ('["other"] }', '["othr"] }', "'othr' is not needed: did you mean 'other'"),
        ('["other"] }', '["gone"] }', "gone is of kind 'transient'; sets are of sweeps"),
        ('["other"] }', '["line"] }', "line varies A; best is over two parameters"),
        ("sizes = { cubic = 0.5 }", "", "2 values from 0.04 to 0.06 of A, others 2 values from 0.02 to 0.03"),
        ("cubic = 0.5", "cubik = 0.5", "sizes: no set 'cubik': did you mean 'cubic'"),
        ('measure = "max_abs_x1"', 'measure = "max_abs_x"', "no column 'max_abs_x' of numbers: did you mean"),
        ('measure = "max_abs_x1"', 'measure = "end_x1"', "how end_x1 grows with a size is not known"),
        ("{ Omega = 1.0 }", "{ Omega = 0.9 }", "cell 2 (over): no Omega = 0.9 on the grid; the nearest is 0.99"),
        ("at = { Omega = 1.0 }, ", "", "is along one parameter; give one value of the other, of A or Omega"),
        ('show = "map"', 'show = "map", at = { A = 0.02 }', "is over both parameters"),
        ('show = "map"', 'show = "map", of = ["ball"]', "is about 'ball' alone; name two or more"),
        ('show = "map"', 'show = "lead", of = ["bal", "cubic"]', "cell 1 (lead): no set 'bal': did you mean 'ball'"),
        ('show = "map"', 'show = "lead", y = [3.0, 1.0]', "y is 3 to 1; give the lower end first"),
    ],
)
def test_mistakes_are_one_line_when_the_file_is_read(root, right, wrong, said):
    assert right in SMALL
    (root / "pipelines" / "small.toml").write_text(SMALL)
    load_pipeline("small")
    (root / "pipelines" / "small.toml").write_text(SMALL.replace(right, wrong))
    with pytest.raises(DeclarationError) as caught:
        load_pipeline("small")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def free(Omega):
    """Return the amplitude of the oscillator alone over that of the base, paper, eq. (8)."""
    lam = Params(mu=0.02, A=0.01).lam
    return abs((1 + 1j * lam * Omega) / (1 - Omega**2 + 1j * lam * Omega))


def linear(Omega, k1, l2, mu=0.02):
    """Return the amplitudes of x1 and of the travel, over that of the base, of a mass on a linear spring."""
    lam = Params(mu=mu, A=0.01).lam
    spring = k1 + 1j * l2 * Omega
    x1 = (1 + 1j * lam * Omega) / (1 - Omega**2 + 1j * lam * Omega - mu * spring * Omega**2 / (spring - Omega**2))
    return np.abs(x1), np.abs(x1 * Omega**2 / (spring - Omega**2))


def test_what_the_page_says_of_linear_absorbers_is_their_closed_form():
    page = " ".join((REPOSITORY / "docs" / "absorbers.md").read_text("utf-8").split())
    Omega, alone = np.linspace(0.8, 1.2, 4001), free(1.0)
    amplitude, travel = linear(Omega, 0.96, 0.16)
    assert f"The TMD travels {travel.max():.1f} A, {0.06 * travel.max():.1f} at A = .06" in page
    assert f"it may travel .8, which it does from A = {0.8 / travel.max():.4f} on".replace("0.", ".") in page
    assert f"k1 = .96, l2 = .16 | {amplitude.max() / alone:.3f} ".replace(" 0.", " .") in page
    peak, l2 = min((linear(Omega, 0.0, l2)[0].max() / alone, l2) for l2 in np.arange(0.5, 1.5, 0.01))
    assert f"has {peak:.3f} (l2 = {l2:.2f}, in closed form)".replace(" 0.", " .") in page
    # detuned in frequency, its square in stiffness; the best of the others has .529
    shares = [linear(Omega, 0.96 * factor**2, 0.16)[0].max() / alone for factor in (0.705, 0.95, 1.05, 1.22)]
    assert [f"{share:.2f}" for share in shares] == ["0.53", "0.17", "0.17", "0.53"]
    assert f"{linear(Omega, 1.0, 0.02)[0].max() / alone:.2f}" == "0.44"


@pytest.mark.parametrize("Omega", [0.97, 1.0, 1.02])
def test_the_reduction_of_every_system_is_over_the_oscillator_alone_in_closed_form(Omega):
    """What they are compared by is one measure: without its spring, drag or friction each is the same ball."""
    p = {"mu": 0.02, "A": 0.03, "Omega": Omega}
    found = {}
    for one in (
        Params(**p),
        Parallel(mu=(0.02,), beta=(1.0,), A=0.03, Omega=Omega),
        CubicBarriers(**p),
        Drag(**p, delta=0.0),
        Friction(**p, f=0.0),
    ):
        assert vines.no_ball(one) == pytest.approx(0.03 * free(Omega), rel=1e-13)
        found[one.system.name] = vines.settle(one, settle=40, record=4, lyapunov=False, errors=False).measures
    ratios = [each.max_abs_x1 / (0.03 * free(Omega)) for each in found.values()]
    assert ratios == pytest.approx([ratios[0]] * 5, rel=1e-9)


def test_all_lengths_times_a_size_are_the_same_motion_of_a_mass_on_a_cubic_spring():
    """So that one sweep over A holds every stiffness, and every distance of barriers."""
    small, large = (CubicBarriers(mu=0.02, A=0.03 * size, k3=1 / size**2, l2=0.3, walls=False) for size in (1.0, 1.5))
    one, other = (
        vines.settle(p, x1=0.0, v1=0.0, x2=0.0, v2=0.1 * size, settle=300, record=4)
        for p, size in ((small, 1.0), (large, 1.5))
    )
    assert other.measures.max_abs_x1 == pytest.approx(1.5 * one.measures.max_abs_x1, rel=1e-8)


def fewer():
    """Return overrides that leave little of the sweeps of the study."""
    small = {}
    for name, stage in load_pipeline("best_absorber").stages.items():
        if stage.kind.name != "sweep":
            continue
        small |= {f"stages.{name}.record": 16, f"stages.{name}.watch": 16}
        if not name.endswith("tmd"):
            small[f"stages.{name}.settle"] = 40
        if name == "tune_tmd":
            small |= {f"stages.{name}.vary.k1.step": 0.1, f"stages.{name}.vary.l2": [0.16]}
            small[f"stages.{name}.vary.Omega.count"] = 3
        elif name.startswith("tune"):
            small |= {f"stages.{name}.vary.A.count": 5, f"stages.{name}.vary.Omega": [0.99, 1.0]}
        else:
            small[f"stages.{name}.vary.A.count"] = 3 if name.startswith("one") else 9
            if not name.startswith("one"):
                small[f"stages.{name}.vary.Omega.count"] = 3
    hybrid = "stages.tune_hybrid.vary"
    return small | {f"{hybrid}.mu_n": [0.01], f"{hybrid}.k3": [1.0], f"{hybrid}.l2": [0.4]}


def test_the_queries_of_the_page_count_as_numpy_does_on_a_small_grid(root):
    search, own = ["tune_ball", "tune_ball_down", "tune_tmd", "tune_hybrid"], ["ball_rest", "ball_down", "tmd"]
    run("best_absorber", stages=search + own, overrides=fewer())
    for row in vines.query('select * from "best_absorber.tmd"').to_pylist():
        amplitude, _ = linear(row["Omega"], row["k1"], row["l2"])
        assert row["max_abs_x1"] == pytest.approx(row["A"] * amplitude, rel=1e-6)

    page = (REPOSITORY / "docs" / "absorbers.md").read_text("utf-8")
    designs, shares = re.findall(r"^```sql\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    found = {row["absorber"]: row for row in vines.query(designs).to_pylist()}
    assert set(found) == {"ball", "hybrid", "tmd"}
    rows = vines.query("select A, max_abs_x1 from parallel_attractors where stage like 'tune%'").to_pylist()
    lows = sorted({row["A"] for row in rows})
    highest = {
        low: max(row["max_abs_x1"] / row["A"] for row in rows if low * 0.999 < row["A"] < low * 5.001)
        for low in lows
        if low * 5 < lows[-1] * 1.001
    }
    best = min(highest, key=lambda low: highest[low])
    assert found["ball"]["size"] == pytest.approx(0.012 / best)
    assert found["ball"]["highest"] == pytest.approx(highest[best] / free(1.0), rel=1e-4)

    stored = inputs(root, "best_absorber", own)
    sets = [[stored["ball_rest"], stored["ball_down"]], [stored["tmd"]]]
    worth = [worth_of(members, "max_abs_x1", "less").worst for members in sets]
    place, _ = rank(worth, "less")
    counted = {row["absorber"]: row for row in vines.query(shares).to_pylist()}
    for number, name in enumerate(("ball", "tmd")):
        assert counted[name]["share"] == pytest.approx(float((place == number).mean()))
        peaks = worth[number] / np.linspace(0.012, 0.06, 9)
        assert counted[name]["highest"] == pytest.approx(float(peaks.max()) / free(1.0), rel=1e-4)


@pytest.mark.full
def test_the_whole_study_on_a_small_grid_has_its_figures(root):
    run("best_absorber", overrides=fewer())
    assert len(list((root / "data" / "results").rglob("picture.png"))) == 2
    for table in ("parallel_points", "cubic_barriers_points"):
        assert vines.query(f"select count(*) as n from {table} where status != 'ok'").to_pylist() == [{"n": 0}]
