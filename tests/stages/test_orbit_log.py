"""An orbit as a log: one period that closes; and a trajectory's log is sharp at its impacts."""

import numpy as np
import pytest

import vines
from vines import logs
from vines.stages import orbit_log
from vines.systems import Friction, ImpactPair, Parallel


@pytest.mark.parametrize(("word", "A"), [("LR", 0.02), ("LLR", 0.0216)])
def test_orbit_log_holds_one_period(tmp_path, word, A):
    orbit = vines.find_orbit(word, vines.Params(mu=0.01, A=A, Omega=1.0, r=0.65))
    log = logs.read(orbit_log(orbit, tmp_path / "orbit.mcap"))
    assert (log.kind, log.word, log.name) == ("orbit", word, orbit.name)
    states = log.states.to_pandas()
    assert states["t"].iloc[-1] - states["t"].iloc[0] == pytest.approx(orbit.period, abs=1e-12)
    for name in ("x1", "v1", "x2", "v2"):
        assert states[name].iloc[0] == pytest.approx(states[name].iloc[-1], abs=1e-8)
    np.testing.assert_allclose(np.sort(log.impacts["w_dot"].to_numpy()), np.sort(orbit.w_dot), atol=1e-9)
    (row,) = log.orbits.to_pylist()
    assert abs(complex(row["multiplier_1_re"], row["multiplier_1_im"])) == pytest.approx(orbit.max_multiplier)
    assert row["stable"] == orbit.stable


@pytest.mark.parametrize(
    ("p", "word"),
    [
        (vines.Params(mu=0.01, A=0.5), "L*R*"),
        (ImpactPair(B=0.6, G=0.05, r=0.5), "LR"),
        (Parallel(mu=(0.01, 0.01), A=0.03, beta=(1.0, 1.4)), "L1L2R1R2"),
        (Friction(mu=0.3, A=0.3, f=0.2), "LsR"),
    ],
)
def test_orbits_of_all_systems_have_logs(tmp_path, p, word):
    orbit = vines.find_orbit(word, p)
    log = logs.read(orbit_log(orbit, tmp_path / "orbit.mcap"))
    assert (log.kind, log.word, log.name, log.system) == ("orbit", word, orbit.name, p.system.name)
    met = log.impacts.to_pandas()
    for speed, side in zip(orbit.w_dot, orbit.side, strict=True):
        assert side == 0 or abs(met["w_dot"] - speed).min() < 1e-9


def test_log_of_a_trajectory_is_sharp_at_impacts(quickstart):
    (path, *_) = sorted(quickstart.data.glob("results/*/logs/*.mcap")) or sorted(quickstart.data.rglob("*.mcap"))
    log = logs.read(path)
    states = log.states.to_pandas()
    assert log.attractor
    for impact in log.impacts.to_pylist():
        at = states[states["t"] == impact["t"]]
        assert impact["w_dot"] in at["w_dot"].to_numpy()
        assert impact["v1_after"] - impact["v2_after"] == pytest.approx(at["w_dot"].iloc[-1], abs=1e-12)
