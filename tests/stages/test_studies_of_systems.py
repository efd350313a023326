"""The studies of systems that ship, on small grids, and what docs/systems.md says of them."""

import math
import re

import pytest

import vines
from tests.project import REPOSITORY
from vines.dynamics import decay, simulate
from vines.model import Params
from vines.stages import load_pipeline, run
from vines.stages.plots._designs import designs_of
from vines.systems import Parallel

pytestmark = pytest.mark.long(40)

STARTS = ("rest", "slow", "fast", "down")


@pytest.fixture
def root(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    return project.root


def reduction(p, **start):
    found = vines.settle(p, settle=300, record=32, **start)
    return found.measures.max_abs_x1 / vines.no_ball(p), found.name


def test_all_lengths_and_the_forcing_times_a_size_are_the_same_motion():
    p = Parallel(mu=(0.012, 0.008), beta=(1.0, 1.4), A=0.03)
    larger = Parallel(mu=p.mu, beta=(1.7, 2.38), A=0.051)
    known, name = reduction(p, v2=[0.1, -0.3])
    assert (name, reduction(larger, v2=[0.17, -0.51])) == ("1:1|1:1", (pytest.approx(known, rel=1e-8), name))


def test_a_ball_that_rests_in_the_longer_cavity_is_never_hit_unless_the_rig_is_tilted():
    p = Parallel(mu=(0.012, 0.008), beta=(1.05, 1.365), A=0.0245)
    tilted = Parallel(mu=p.mu, beta=p.beta, A=p.A, G=0.0037)
    moving, name = reduction(p, v2=[0.1, -0.3])
    assert name == "1:1|1:1"
    resting, trapped = reduction(p, v2=[0.0, 0.0])
    assert "|0:0" in trapped
    assert resting > 2 * moving
    assert reduction(tilted, v2=[0.0, 0.0]) == (pytest.approx(moving, abs=2e-3), name)


def test_two_cavities_on_a_small_grid_has_its_figure_and_the_query_of_the_page_finds_its_best_design(root):
    small = {}
    for name, stage in load_pipeline("two_cavities").stages.items():
        if stage.kind.name == "sweep":
            small |= {f"stages.{name}.settle": 100, f"stages.{name}.record": 32, f"stages.{name}.watch": 16}
            small[f"stages.{name}.vary.A.count"] = 5 if name.startswith(("one", "two")) else 3
            if name.startswith("two"):
                small |= {f"stages.{name}.vary.mu_1.step": 0.008, f"stages.{name}.vary.beta_2.step": 0.5}
    run("two_cavities", overrides=small)
    assert len(list((root / "data" / "results").rglob("picture.png"))) == 1
    assert vines.query("select count(*) as n from parallel_points where status != 'ok'").to_pylist() == [{"n": 0}]
    page = (REPOSITORY / "docs" / "systems.md").read_text("utf-8")
    (query,) = re.findall(r"^```sql\n(with sizes.*?)^```", page, re.MULTILINE | re.DOTALL)
    first = vines.query(query).to_pylist()[0]
    tables = [vines.query(f'select * from "two_cavities.two_{start}"') for start in STARTS]
    found = designs_of(tables, ("mu_1", "beta_2"), "A", "reduction")
    best = found.best(0.012, 0.06)
    values = [float(each[k]) for each, k in zip(found.values, best.place, strict=True)]
    assert [first["mu_1"], first["beta_2"], first["beta_1"], first["worst"]] == pytest.approx(
        [*values, best.size, best.worst]
    )


def test_no_impact_below_the_first_peak_in_closed_form_and_most_of_the_energy_above_it():
    lam = Params(mu=0.02, A=0.0).lam
    fast = math.sqrt(1 - lam**2 / 4)
    # V exp(-lam t/2) sin(fast t)/fast is largest at t = atan(2 fast/lam)/fast, where it is V exp(-lam t/2)
    threshold = math.exp(lam * math.atan(2 * fast / lam) / fast / 2)
    assert threshold == pytest.approx(1.0094315615882883, abs=1e-15)
    figure = load_pipeline("transients").stages["figure"].options
    assert figure.cells[0].marks == pytest.approx((threshold, threshold / 2), abs=1e-8)
    for beta in (1.0, 0.5):
        balls = {"mu": (0.02,), "beta": (beta,), "A": 0.0}
        reached = threshold * beta
        below, above = (
            decay(simulate(Parallel(**balls), v1=V * reached, v2=[0.0], periods=60)) for V in (1 - 1e-9, 1 + 1e-3)
        )
        assert below.impacts == 0
        assert above.impacts > 30
        assert above.impact_share > 0.5
        assert above.times[1] < 0.5 * 2 * math.log(10) / lam


@pytest.mark.parametrize("V", [1.4, 2.0, 3.0, 6.0])
def test_the_time_to_a_tenth_is_that_of_a_ball_that_hits_each_end_once_a_period(V):
    """Balance of energy: E' = -lam E - mu (1 - r²) U²/(2 pi (1 + mu)), U that of the impact pair at the amplitude."""
    mu, r = 0.02, 0.65
    lam = Params(mu=mu, A=0.0).lam
    square, linear = (1 - r) ** 2 + (math.pi * (1 + r) / 2) ** 2, math.pi * (1 + r)
    energy, time, step = 0.5 * V**2, 0.0, 0.002
    while energy > 0.05 * V**2:
        amplitude = math.sqrt(2 * energy)
        # (1 - r)² U² + (2 - pi (1 + r) U/2)² = 4 amplitude², docs/systems.md
        root = linear**2 - 4 * square * (1 - amplitude**2)
        speed = (linear + math.sqrt(root)) / square
        lost = lam * energy + mu * (1 - r**2) / (1 + mu) * speed**2 / (2 * math.pi)
        energy *= 1 - step
        time += step * energy / lost
    found = decay(simulate(Params(mu=mu, A=0.0, r=r), v1=V, v2=0.0, periods=60))
    assert found.times[0] == pytest.approx(time, rel=0.04)


def test_transients_on_a_small_grid(root):
    form = load_pipeline("transients").stages
    fewer = {f"stages.{name}.vary.V.count": 3 for name, stage in form.items() if stage.kind.name == "transient"}
    run("transients", overrides=fewer)
    rows = vines.query("select V, impact_share from transients where stage = 'one' order by V").to_pylist()
    assert [row["impact_share"] > 0 for row in rows] == [False, True, True]
    assert len(list((root / "data" / "results").rglob("picture.svg"))) == 1


@pytest.mark.full
def test_the_response_of_the_family_on_a_small_grid(root):
    """Four balls compile kernels of their own."""
    form = load_pipeline("family_response").stages
    fewer = {}
    for name, stage in form.items():
        if stage.kind.name == "sweep":
            fewer |= {f"stages.{name}.vary.Omega.count": 3, f"stages.{name}.settle": 50, f"stages.{name}.record": 16}
    run("family_response", overrides=fewer)
    assert len(list((root / "data" / "results").rglob("picture.svg"))) == 1
    found = vines.query("select stage, max(mu_1) as mu from parallel_points group by stage order by stage").to_pylist()
    assert {row["stage"]: row["mu"] for row in found if row["stage"].endswith("_up")} == {
        "one_up": 0.02,
        "two_up": 0.01,
        "four_up": 0.005,
        "tilted_up": 0.02,
    }


@pytest.mark.full
def test_the_response_of_a_duffing_oscillator_jumps_down_later_on_the_way_up(root):
    fewer: dict[str, object] = {"stages.hard_up.random": 0}
    for name in ("linear_up", "linear_down"):
        fewer[f"stages.{name}.vary.Omega.count"] = 3
    for name in ("hard_up", "hard_down"):
        fewer[f"stages.{name}.vary.Omega"] = {"from": 1.04, "to": 1.092, "count": 14}
    run("duffing_response", overrides=fewer)
    assert len(list((root / "data" / "results").rglob("picture.svg"))) == 1
    query = "select Omega, max_abs_x1 from duffing_points where stage = 'hard_{}' and max_abs_x1 > 0.5"
    up, down = ([row["Omega"] for row in vines.query(query.format(way)).to_pylist()] for way in ("up", "down"))
    # docs/systems.md; where chaos is left on the way down is chance
    assert max(up) == pytest.approx(1.076)
    assert max(down) < 1.064


@pytest.mark.full
def test_what_coexists_on_a_small_grid(root):
    fewer = {"stages.harvester.vary.B.count": 3, "stages.harvester.random": 2}
    for name, count in (("harvester_plane", 8), ("cavities", 5)):
        fewer |= {f"stages.{name}.{axis}.count": count for axis in ("x", "y")}
    run("coexisting", overrides=fewer)
    assert len(list((root / "data" / "results").rglob("picture.svg"))) == 3
    found = vines.query("select name from impact_pair_attractors where stage = 'harvester_plane'").to_pylist()
    assert {row["name"] for row in found} == {"1:1", "2:1", "2:2/2T", None}
