"""The pipeline ``sticking`` with fewer points: its bound lies between the simulated points that stick and others."""

import numpy as np
import pytest

import vines
from vines.stages import run

pytestmark = [pytest.mark.full, pytest.mark.long(30)]


def test_the_bound_is_that_of_the_simulated_points(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))
    run(
        "sticking",
        overrides={
            "stages.map.vary.A.count": 12,
            "stages.map.vary.mu.count": 10,
            "stages.down.vary.A.count": 19,
            "stages.one_one.points": 20,
        },
    )
    assert len(list((project.root / "data" / "results").rglob("picture.png"))) == 2
    (end,) = vines.query("select type, A from bifurcations where pipeline = 'sticking'").to_pylist()
    assert (end["type"], end["A"]) == ("incomplete_chatter", pytest.approx(0.448656398669, abs=1e-10))
    curve = vines.query("select A, mu from curves where special is null order by mu").to_pylist()
    mu, A = np.array([row["mu"] for row in curve]), np.array([row["A"] for row in curve])
    points = vines.query("select A, mu, name, recurrent_sticking from points where stage = 'map'").to_pylist()
    for row in points:
        bound = np.interp(np.log(row["mu"]), np.log(mu), A, right=np.inf)
        sticks = row["name"] == "1:1" and row["recurrent_sticking"]
        if abs(row["A"] / bound - 1) > 0.02:
            assert sticks == (row["A"] > bound), row
