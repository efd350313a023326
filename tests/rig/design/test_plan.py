"""What to measure next: branches as other code finds them, and dwells of the synthetic rig that tell what was said."""

from dataclasses import replace

import numpy as np
import pytest

from vines.errors import ParameterError, RigError
from vines.model import Params
from vines.orbits import find_orbit
from vines.rig import Uncertain, reconstruct
from vines.rig.design import PARAMETERS, branch_map, informed, known_of, plan_runs
from vines.rig.design._known import STATE, measured_by, slopes_of
from vines.rig.synth import RigSettings, simulate_rig

RIG = Params(mu=0.0084, A=0.015, Omega=1.0, r=0.65)


@pytest.fixture(scope="module")
def plan(dwell):
    return plan_runs([dwell], amplitudes=(0.013, 0.024), omegas=(0.999, 1.001), grid=(8, 3))


def test_stretches_end_where_continuation_says():
    (column,) = branch_map(RIG, np.linspace(0.013, 0.024, 8).tolist(), [1.0])
    ends = {(one.name, one.symmetric): (one.low, one.high, one.ends) for one in column.stretches}
    low, high, kinds = ends["1:1", True]
    assert (low, kinds) == (0.013, ("range", "symmetry_breaking"))
    assert high == pytest.approx(0.01615, abs=1e-4)
    assert ends["1:1", False][:2] == pytest.approx((0.01615, 0.01875), abs=1e-4)
    assert ends["2:1", False][0] == pytest.approx(0.01931, abs=1e-4)
    for one in column.stretches:
        for orbit in one.orbits:
            assert orbit.stable
            assert one.low <= orbit.params.A <= one.high


def test_amplitudes_that_do_not_rise_are_refused():
    with pytest.raises(ParameterError, match=r"amplitudes are .* allowed are two and more that rise"):
        branch_map(RIG, [0.02, 0.01], [1.0])


def test_slopes_are_those_of_neighbouring_orbits(dwell):
    known = known_of([dwell])
    orbit = find_orbit("LR", RIG)
    slopes = slopes_of(orbit, known)
    step = 1e-5
    for name, at in (("A", RIG.replace(A=0.015 * (1 + step))), ("omega0", RIG.replace(Omega=1 / (1 + step)))):
        moved = find_orbit("LR", at, guess=orbit)
        by = slopes[:, STATE.index(name)]
        assert (moved.phase - orbit.phase) / step == pytest.approx(by[:2], rel=2e-3)
        assert np.log(moved.measures.max_abs_x1 / orbit.measures.max_abs_x1) / step == pytest.approx(by[2], rel=2e-3)


def test_a_plan_is_sorted_and_says_why(plan):
    bits = [one.bits for one in plan.suggestions]
    assert bits == sorted(bits, reverse=True)
    assert 3 <= len(plan.suggestions) <= 8
    first = plan.suggestions[0]
    assert "5 more dwells of" in first.reason
    assert "bring u(" in first.reason
    assert all(first.after[name] <= first.before[name] * (1 + 1e-9) for name in PARAMETERS)
    assert first.f == pytest.approx(first.Omega * plan.known.values["omega0"] / (2 * np.pi))
    assert pytest.approx(first.A * plan.known.values["b"]) == first.E
    jumps = [one for one in plan.suggestions if one.purpose == "jump"]
    assert jumps
    assert all("u(A) away" in one.reason and one.bits == 0 for one in jumps)
    assert not np.isfinite(first.volts)


@pytest.mark.full
def test_more_dwells_and_longer_ones_tell_more(dwell, plan):
    more = plan_runs([dwell], amplitudes=(0.013, 0.024), omegas=(0.999, 1.001), grid=(8, 3), dwells=20)
    assert more.suggestions[0].bits > plan.suggestions[0].bits
    known, longer = known_of([dwell]), known_of([dwell], 4 * plan.known.length)
    assert longer.noise["phase"] == pytest.approx(known.noise["phase"] / 2, rel=1e-6)


def test_the_voltage_at_the_shaker_goes_with_the_amplitude(dwell):
    told = replace(dwell, run=replace(dwell.run, more={**dwell.run.more, "voltage": 1.5}))
    known = known_of([told])
    assert dwell.quantities["E"].value / known.values["volts"] == pytest.approx(1.5)


def test_no_run_and_no_range_are_said():
    with pytest.raises(RigError, match="no run is at hand"):
        plan_runs([])


def test_a_range_that_is_none_is_refused(dwell):
    with pytest.raises(ParameterError, match=r"amplitudes are 0\.02 to 0\.01, allowed are 0 < from < to"):
        plan_runs([dwell], amplitudes=(0.02, 0.01))


@pytest.mark.full
def test_dwells_of_the_synthetic_rig_scatter_as_is_said(ringdown):
    """Ten dwells of one rig, by the scatter between them: ten draws tell a deviation to a quarter.

    The noise of r, phase and sizes is at most twice what is said, and a third of it at least: blocks are few. The tilt
    that follows from the phases by the derivatives scatters as the design says within a factor of two.
    """
    settings = RigSettings(duration=12.0, settle=30.0, rate=25600.0, sigma_r=0.01, friction=0.002, u_mass=0.0, u_b=0.0)
    runs = [reconstruct(simulate_rig(settings, seed)[0], [ringdown]) for seed in range(40, 50)]
    assert all(run.accepted for run in runs)
    known = known_of(runs)
    orbit = find_orbit("LR", known.params)
    slopes = slopes_of(orbit, known)
    noise = np.sqrt(np.diag(measured_by(slopes, known)))
    rows = []
    for run in runs:
        assert run.slots is not None
        first = np.argsort(run.slots.side)[::-1]
        phases = np.angle(np.exp(1j * (run.slots.phase + run.periods.cut)).mean(axis=0))[first]
        q = run.quantities
        ratio = q["kinetic_ratio"].value / q["mu"].value
        rows.append([*phases, np.log(q["max_abs_x1"].value), np.log(ratio), q["r_effective"].value])
    seen = np.array(rows)
    seen[:, :2] = np.angle(np.exp(1j * (seen[:, :2] - seen[0, :2])))
    scatter = (seen - seen.mean(axis=0)).std(axis=0, ddof=1)
    assert np.all(scatter / noise < 2)
    assert np.all(scatter / noise > 1 / 3)
    # The tilt by the difference of the two phases, which nothing else turns apart.
    column = slopes[:, STATE.index("tilt")]
    tilts = (seen[:, 0] - seen[:, 1]) / (column[0] - column[1])
    loose = np.diag(np.full(len(STATE), 1e-12))
    loose[STATE.index("tilt"), STATE.index("tilt")] = 1.0
    said = np.sqrt(informed(loose, slopes, measured_by(slopes, known))[STATE.index("tilt"), STATE.index("tilt")])
    assert 0.5 < tilts.std(ddof=1) / said < 2
    halves = np.std([tilts[k : k + 5].mean() for k in (0, 5)], ddof=1)
    assert halves < 3 * said / np.sqrt(5)
    assert isinstance(runs[0].quantities["tilt"], Uncertain)
