"""Calibration on half of a campaign whose common error is known, and the score of the other half."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import vines
from vines.rig import Calibration, Uncertain, calibrate, compare_all
from vines.rig.verdict._model import parameter_draws

pytestmark = pytest.mark.long(15)

WRONG = {"A": 1.02, "Omega": 1.0006, "r": 0.006}
"""Factors of A and Omega, and what is added to r, by which all runs are off."""


def run_at(base, k, true):
    """Return a run that shows the 1:1 orbit of the model at true parameters, and states parameters that are off."""
    orbit = vines.find_orbit("LR", true)
    turned = (orbit.phase - base.periods.cut) % (2 * np.pi)
    order = np.argsort(turned)
    assert base.slots is not None
    assert np.array_equal(base.slots.side, orbit.side[order])
    phase = turned[order] + base.slots.phase - base.slots.phase.mean(axis=0)
    stated = {
        "A": (WRONG["A"] * true.A, 1e-3 * true.A),
        "Omega": (WRONG["Omega"] * true.Omega, 3e-5),
        "r_effective": (WRONG["r"] + true.r, 5e-4),
        "mu": (true.mu, 1e-6),
        "lam": (true.lam, 1e-6),
        "max_abs_x1": (orbit.measures.max_abs_x1, 5e-4),
        "kinetic_ratio": (orbit.measures.kinetic_ratio, 5e-5),
    }
    quantities = {**base.quantities, **{name: Uncertain(*pair) for name, pair in stated.items()}}
    slots = replace(base.slots, phase=phase)
    return replace(base, run=replace(base.run, run_id=f"run_{k}"), quantities=quantities, slots=slots)


@pytest.fixture(scope="module")
def compared(dwell):
    """Return four runs compared, with half of the usual ensemble."""
    amplitudes = (0.0125, 0.0135, 0.0145, 0.0157)
    runs = [run_at(dwell, k, vines.Params(mu=0.0084, A=A, r=0.65)) for k, A in enumerate(amplitudes)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("vines.rig.verdict._model.parameter_draws", partial(parameter_draws, draws=16))
        return compare_all(runs)


def test_the_common_error_is_found(compared):
    _, _, found = compared
    assert found.runs == ("run_0", "run_2")
    for name, true in (("A", 1 / WRONG["A"]), ("Omega", 1 / WRONG["Omega"]), ("r", -WRONG["r"])):
        assert abs(getattr(found, name) - true) < 2 * found.u[name]
    # What the runs tell together is told better than what was known beforehand.
    assert found.u["A"] < 0.015
    assert found.u["Omega"] < 3e-4


def test_the_other_half_is_scored_with_it_and_apart(compared):
    measured, calibrated, _ = compared
    assert [one.run.run.run_id for one in measured] == ["run_0", "run_1", "run_2", "run_3"]
    assert {one.basis for one in measured} == {"measured"}
    assert [(one.run.run.run_id, one.basis) for one in calibrated] == [("run_1", "calibrated"), ("run_3", "calibrated")]
    assert [one.verdict for one in (measured[1], measured[3])] == ["pattern_only", "pattern_only"]
    for one in calibrated:
        assert one.verdict == "agree", one.reason
        assert max(one.branches[0].errors.values()) < 0.5


def test_nothing_is_calibrated_where_nothing_tells(compared):
    measured, _, found = compared
    open_ones = [replace(one, verdict="undecidable") for one in measured]
    assert calibrate(open_ones) == Calibration()
    p = measured[0].params
    assert Calibration().on(p) == p
    assert pytest.approx(p.A * found.A) == found.on(p).A
    few = [one.run for one in measured[:3]]
    assert compare_all(few, spread=lambda _, runs: measured[: len(runs)])[1:] == ((), Calibration())
