"""The plot of which absorber is best where, the study that ships with it, and what its page says."""

from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pytest

from vines.errors import DeclarationError
from vines.stages import load_pipeline
from vines.stages.plots._best import rank, worth_of

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
