"""A run beside the model: verdicts on the synthetic rig's own physics, and on planted faults."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from tests.rig.conftest import DWELL
from vines.errors import RigError
from vines.model import Params, Word
from vines.rig import Finding, compare, reconstruct
from vines.rig.ingest._run_form import Stated
from vines.rig.quantities._pattern import cut_into_periods, find_pattern
from vines.rig.recording import Uncertain
from vines.rig.synth import raw_run, read_raw
from vines.rig.uncertainty import error_ratio
from vines.rig.verdict._match import candidates, same_pattern
from vines.rig.verdict._verdict import decide, order

pytestmark = pytest.mark.long(22)


@pytest.fixture(scope="module")
def told(dwell):
    """Return it compared."""
    return compare(dwell)


def test_a_good_run_shows_the_models_pattern_and_numbers(told):
    best = told.branches[0]
    assert told.verdict in ("agree", "pattern_only"), told.reason
    assert (best.predicted.candidate.name, best.predicted.holding) == ("1:1", 1.0)
    assert set(best.errors) == {"phase", "max_abs_x1", "kinetic_ratio"}
    assert max(best.errors.values()) < 2
    assert best.rms_w < 0.05
    assert best.rms_w_dot < 0.15


def test_without_a_good_run_nothing_is_decided(dwell):
    spoilt = replace(dwell, findings=(*dwell.findings, Finding("forcing", False, "the response is turned", True)))
    assert (compare(spoilt).verdict, compare(spoilt).reason) == ("undecidable", "the response is turned")
    rng = np.random.default_rng(0)
    train = np.cumsum(rng.uniform(1.0, 5.0, 200))
    periods = cut_into_periods(train, np.where(rng.random(200) < 0.5, 1.0, -1.0), (0.0, float(train[-1])))
    mixed = replace(dwell, pattern=find_pattern(periods, train), periods=periods)
    assert mixed.pattern.name == "mixed"
    assert compare(mixed).verdict == "undecidable"
    assert "mixed or chaotic" in compare(mixed).reason


def test_a_run_whose_numbers_are_not_the_models_does_not_agree(dwell):
    quantities = dict(dwell.quantities)
    quantities["max_abs_x1"] = Uncertain(1.2 * quantities["max_abs_x1"].value, quantities["max_abs_x1"].u)
    found = compare(replace(dwell, quantities=quantities))
    assert found.verdict == "pattern_only"
    assert "E_n(max_abs_x1)" in found.reason


def test_a_model_that_is_chaotic_without_scatter_decides_nothing(told):
    best = told.branches[0]
    chaos = replace(best.predicted, candidate=replace(best.predicted.candidate, name="chaotic", regime="chaotic"))
    other = replace(best, predicted=chaos)
    verdict, reason = decide(told.run, order([other]))
    assert (verdict, reason.split(": ")[0]) == (
        "undecidable",
        "the model shows 1:1 with scatter only; without, it is chaotic",
    )
    assert order([other, best])[0] is best


def test_agreement_that_is_only_vague_is_none(told):
    best = told.branches[0]
    model = {**best.model, "phase": Uncertain(best.model["phase"].value, 0.3)}
    vague = replace(best, model=model, errors=dict.fromkeys(best.errors, 0.1))
    verdict, reason = decide(told.run, (vague,))
    assert verdict == "undecidable"
    assert "phase to 0.3" in reason


def test_a_pattern_that_the_model_does_not_have_is_a_disagreement(dwell):
    t = np.cumsum(np.tile([1.0, 1.0, 1.5, 2 * np.pi - 3.5], 60))
    periods = cut_into_periods(t, np.tile([1.0, 1.0, -1.0, -1.0], 60), (0.0, float(t[-1])))
    other = replace(dwell, pattern=find_pattern(periods, t), periods=periods, slots=None)
    assert other.pattern.name == "2:2"
    assert compare(other).verdict in ("disagree", "undecidable")


@pytest.mark.parametrize(
    "fault",
    [
        "sign of the base", "sign of one", "g for m/s^2", "mm for m", "gap", "ball", "clock",
        pytest.param("delay", marks=pytest.mark.full),  # the slowest
    ],
)  # fmt: skip
def test_planted_faults_never_agree(raw, ringdown, fault):
    def rows(roles, **change):
        return replace(
            raw, rows=tuple(msgspec.structs.replace(r, **change) if r.role in roles else r for r in raw.rows)
        )

    form = raw.form
    spoilt = {
        "sign of the base": lambda: rows(("base_disp", "base_acc"), sign="-1"),
        "sign of one": lambda: rows(("lo_disp",), sign="-1"),
        "g for m/s^2": lambda: rows(("lo_acc",), sensitivity_unit="mV/(m/s^2)"),
        "mm for m": lambda: rows(("lo_disp",), sensitivity_unit="V/m"),
        "gap": lambda: replace(raw, form=msgspec.structs.replace(form, b=Stated(1.05 * form.b.value, form.b.u))),
        "ball": lambda: replace(raw, form=msgspec.structs.replace(form, m=Stated(1.1 * form.m.value, form.m.u))),
        "delay": lambda: rows(("lo_disp",), group_delay=2.1e-3),
        "clock": lambda: raw_run(msgspec.structs.replace(DWELL, fault="clock"), 7),
    }[fault]()
    try:
        found = reconstruct(read_raw(spoilt), [ringdown])
    except RigError:
        return
    assert not found.accepted
    assert compare(found).verdict != "agree"


def test_coexisting_branches_come_with_their_mirror_images():
    found = candidates(Params(mu=0.01, A=0.0235), Word("LLR"))
    words = {one.word for one in found if one.stable}
    assert {"LLR", "LRR"} <= words
    assert same_pattern(Word("LLR"), Word("LRR"))


def test_a_long_word_is_followed_from_the_catalogue():
    from vines.orbits import all_orbits

    p = Params(mu=0.01, A=0.0208)
    doubled = next(orbit for orbit in all_orbits("LRLR/2T", p) if orbit.stable)
    row = {**p.replace(A=0.0207).as_dict(), "word": str(doubled.word), "t": doubled.t, "branch_id": "b1"}
    from vines.rig.verdict import _match

    (first, *_) = list(_match._followed(row, p))
    assert (first.name, first.branch_id, first.source) == ("2:2/2T", "b1", "catalogue")
    assert first.orbit is not None
    assert np.allclose(np.sort(first.orbit.t), np.sort(doubled.t), atol=1e-8)


def test_e_n_is_half_the_distance_in_combined_uncertainties():
    assert error_ratio(Uncertain(1.0, 0.3), Uncertain(2.0, 0.4)) == 1.0
