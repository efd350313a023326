"""The map of regimes in a coarse version: its pipeline as it is shipped, with fewer points."""

import collections
import json

import pytest

from tests.project import REPOSITORY, Project
from vines.model import Params
from vines.orbits import find_orbit


@pytest.fixture(scope="module")
def coarse(tmp_path_factory):
    root = tmp_path_factory.mktemp("regimes")
    (root / "pipelines").symlink_to(REPOSITORY / "pipelines")
    project = Project(root)
    fewer = {"A.count": 16, "mu.count": 12}
    settings = [part for key, count in fewer.items() for part in ("--set", f"stages.map.vary.{key}={count}")]
    project.vines("run", "regimes", "--quiet", *settings)
    return project


@pytest.fixture(scope="module")
def points(coarse):
    told = coarse.vines("query", "select * from points where pipeline = 'regimes'", "--format", "json")
    return json.loads(told.stdout)


def test_every_point_is_named_and_most_are_settled(coarse, points):
    assert len(points) == 192
    counts = collections.Counter(row["regime"] for row in points)
    assert set(counts) <= {"periodic", "quasiperiodic", "chaotic", "no_impact", "unsettled"}
    assert counts["periodic"] > 60
    assert counts["chaotic"] > 60
    assert counts["unsettled"] < 10
    for row in points:
        assert (row["name"] is not None) == (row["regime"] == "periodic")
        assert row["settled"] == (row["regime"] != "unsettled")
        if row["regime"] == "chaotic":
            # Told with the correlation of its blocks, of which the decision knows nothing.
            assert row["lyapunov"] > 2 * row["lyapunov_error"] > 0
    assert list(coarse.data.glob("results/*/picture.png"))


def test_symmetric_one_to_one_points_are_the_orbits_in_closed_form(points):
    # A complete chatter counts as one contact too: those orbits have more impacts.
    symmetric = [row for row in points if row["name"] == "1:1" and row["symmetric"] and row["sticks_per_period"] == 0]
    assert len(symmetric) > 10
    for row in symmetric:
        orbit = find_orbit("LR", Params(mu=row["mu"], A=row["A"], Omega=row["Omega"], r=row["r"], lam=row["lam"]))
        assert orbit.stable
        assert row["kinetic_ratio"] == pytest.approx(orbit.measures.kinetic_ratio, rel=1e-8)
        assert row["max_abs_x1"] == pytest.approx(orbit.measures.max_abs_x1, rel=1e-8)


def test_recurrent_sticking_is_a_column_of_its_own(points):
    now_and_then = [row for row in points if row["sticks_per_period"] > 0 and not row["recurrent_sticking"]]
    always = [row for row in points if row["recurrent_sticking"]]
    assert now_and_then
    assert always
    for row in always:
        assert row["sticking_share"] >= 0.9 or (row["regime"] == "periodic" and row["sticking_share"] > 0)
    # Sticking in every period takes a ball that is heavy or a base that hardly moves it.
    assert all(row["regime"] != "no_impact" for row in always)
