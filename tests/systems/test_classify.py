"""classify_many for other systems: the same as settling each alone, by whatever names starts are given."""

import numpy as np
import pytest

import vines
from vines.attractors import coexisting
from vines.errors import ParameterError, StateError
from vines.systems import CubicBarriers, Drag, Duffing, Friction, Hybrid, ImpactPair, Modes, Parallel

TWO = Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), A=0.03)


def test_balls_in_parallel_from_several_starts():
    v2 = np.array([[0.1, -0.3], [0.3, 0.2], [-0.4, 0.6]])
    many = vines.classify_many(TWO, {"v2": v2, "x1": [0.0, 0.1, -0.1], "phase": 0.3}, impacts=True, threads=2)
    assert len(many) == 3
    for k in range(3):
        alone = vines.settle(TWO, v2=v2[k], x1=(0.0, 0.1, -0.1)[k], phi=0.3)
        found = many.attractor(k)
        assert (found.regime, found.word) == (alone.regime, alone.word)
        assert found.measures == alone.measures
        assert found.final == pytest.approx(alone.final, abs=0)
        assert np.array_equal(found.impacts, alone.impacts)
        assert many.measures["kinetic_ratio"][k] == pytest.approx(alone.measures.kinetic_ratio, rel=1e-14)
    assert many.name.tolist() == ["1:1|1:1"] * 3
    assert many.parameters.shape == (3, len(TWO.as_dict()))
    assert many.starts[:, 5].tolist() == v2[:, 1].tolist()
    assert many.final.shape == (3, 7)
    assert many.settled.all()
    assert (many.sticks == 0).all()


def test_points_of_the_pair():
    points = [ImpactPair(B=B, G=0.05, r=0.5) for B in (0.6, 0.95, 0.97)]
    many = vines.classify_many(points)
    assert many.name.tolist() == ["1:1", "1:1", "2:2/2T"]
    assert many.attractor(2).word == "LRLR/2T"
    assert many.lyapunov.max() < 0
    assert many.measures["impact_loss_left"][0] == pytest.approx(many.attractor(0).measures.impact_loss_left)
    assert len(many.attractor(0).impacts) == 0
    assert vines.classify_many(points[0], {"w_dot": [0.1, 0.5]}).name.tolist() == ["1:1", "1:1"]


@pytest.mark.parametrize(
    "p",
    [
        TWO,
        ImpactPair(B=0.6, G=0.05, r=0.5),
        Drag(mu=0.02, A=0.03, delta=0.01),
        Friction(mu=0.02, A=0.03, f=0.001),
        CubicBarriers(mu=0.02, A=0.03, k3=0.5, l2=0.1),
        Duffing(mu=0.02, A=0.03, alpha=0.5),
        Hybrid(mu=0.02, A=0.03, mu_n=0.01, k3=0.5, l2=0.1),
        Modes(mu=0.05, A=0.03, omega=(1.0, 1.9), phi=(0.8, -0.7), gamma=(0.9, 0.5)),
    ],
    ids=lambda p: p.system.name,
)
def test_many_measure_as_one_and_random_starts_come_to_what_is_known(p):
    many = vines.classify_many(p)
    alone = many.attractor(0)
    for name in ("kinetic_1", "kinetic_2", "kinetic_ratio", "max_abs_x1", "rms_x1", "base_work", "damper_loss"):
        assert many.measures[name][0] == pytest.approx(getattr(alone.measures, name), rel=1e-14, nan_ok=True)
    [listed] = coexisting([alone], random=2, seed=1, settle=1000, record=64, watch=300, largest_p=None, impacts=False)
    known = [(found.name, round(found.measures.kinetic_ratio, 6)) for found, _ in listed if found.settled]
    assert len(set(known)) == len(known)


def test_equal_balls_start_apart():
    p = Parallel(mu=(0.01, 0.01), A=0.02)
    assert vines.classify_many(p).attractor(0).word == "L1L2R1R2"
    assert vines.classify_many(p, settle=50, patience=0, apart=0.0, ties="together").attractor(0).measures.ties > 0


def test_what_does_not_fit_is_refused():
    with pytest.raises(ParameterError, match="classify those of each alone"):
        vines.classify_many([TWO, ImpactPair(B=0.6, G=0.0, r=0.5)])
    with pytest.raises(StateError, match="x1 has 2 values, others have 3"):
        vines.classify_many([TWO] * 3, {"x1": [0.0, 0.1]})
    with pytest.raises(StateError, match="unknown coordinate 'w'"):
        vines.classify_many(TWO, {"w": 0.1})
