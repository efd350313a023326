"""How long regimes hold under noise: no noise, cores and counts of runs, plain runs against splitting, refusals."""

import math

import numpy as np
import pytest

from vines.attractors import exits, settle_from
from vines.attractors._exit_splitting import doubt
from vines.attractors._regime import Regime, begun
from vines.dynamics import Scatter
from vines.dynamics._simulate import record
from vines.dynamics.kernels import constants_at, room_of, state_now
from vines.dynamics.kernels import rows as col
from vines.errors import ParameterError, StateError
from vines.model import Params
from vines.systems import ImpactPair, Parallel

FIG_11 = Params(mu=0.05, A=0.1, Omega=1.17)
FEW = {"random": 4, "words": ["LR"]}


def test_without_noise_nothing_leaves():
    found = exits(FIG_11, Scatter(noise=1e-14, seed=1), runs=3, periods=60, **FEW)
    assert [a.name or a.regime for a in found.attractors] == ["chaotic", "1:1"]
    assert found.runs["censored"].all()
    assert (found.runs["T_exit"] == 60).all()
    assert [h.mean for h in found.holdings] == [math.inf, math.inf]
    assert found.basin(0)[0] == 1.0
    # Runs on the orbit are where the orbit is: the regime's state is that of a run without noise.
    assert found.attractors[1].max_multiplier == pytest.approx(0.99742, abs=1e-5)


def test_runs_do_not_depend_on_cores_nor_on_how_many_there_are():
    noise = Scatter(noise=0.1, sigma_r=0.01, phase_diffusion=0.01, ou={"sigma": 0.02, "correlation_time": 1.0}, seed=4)
    one = exits(FIG_11, noise, runs=6, periods=400, threads=1, **FEW)
    two = exits(FIG_11, noise, runs=6, periods=400, threads=2, **FEW)
    assert one.runs.tobytes() == two.runs.tobytes()
    fewer = exits(FIG_11, noise, runs=3, periods=400, **FEW)
    for k in (0, 1):
        own = one.runs[one.runs["regime"] == k][:3]
        assert own.tobytes() == fewer.runs[fewer.runs["regime"] == k].tobytes()
    left = one.runs[(one.runs["regime"] == 1) & ~one.runs["censored"]]
    assert len(left) > 1
    assert set(left["to"]) == {0}
    assert not np.array_equal(one.runs, exits(FIG_11, noise.scaled(1.5), runs=6, periods=400, **FEW).runs)


def test_a_run_has_left_when_it_says_so():
    # The run of one stream again, by the event loop alone: LR until its exit, and then another pattern.
    noise = Scatter(noise=0.2, seed=2)
    found = exits(FIG_11, noise, runs=8, periods=1000, **FEW)
    own = found.runs[(found.runs["regime"] == 1) & ~found.runs["censored"] & (found.runs["excursions"] == 0)]
    assert (found.runs["to"][found.runs["regime"] == 1] <= 0).all()
    row, room = own[0], room_of(FIG_11)
    table, _room = room.scattered(FIG_11.as_array()[None], noise, np.array([row["seed"]]))
    state = begun(FIG_11, Regime.of(found.attractors[1]).start[None])[0]
    last = int(row["T_exit"]) + 8
    rows, status = record(constants_at(table, 0), state, [last * FIG_11.period], 1000, 4 * last)
    hits = rows[rows[:, col.KIND] == col.IMPACT]
    period = np.floor(hits[:, col.TIME] / FIG_11.period)
    sides = ["".join("L" if side > 0 else "R" for side in hits[period == k, col.SIDE]) for k in range(last)]
    assert status == "complete"
    assert not {"LR", "RL"} & set(sides[-8:])
    assert sides[-9] in ("LR", "RL")
    assert sum(each in ("LR", "RL") for each in sides[:-8]) > 0.5 * (last - 8)
    end: dict[str, float] = dict(
        zip(
            ("x1", "v1", "x2", "v2", "phase"),
            state_now(constants_at(table, 0), state, last * FIG_11.period),
            strict=False,
        )
    )
    assert settle_from(FIG_11, end).regime == "chaotic"
    share, low, high = found.law
    assert share[0] > share[1]
    assert np.all(low <= high)
    assert "1:1 by 8 runs" in str(found)


def test_waiting_leaves_out_what_left_early():
    all_of_it, later = (
        exits(FIG_11, Scatter(noise=0.1, seed=3), runs=12, periods=1500, wait=wait, **FEW) for wait in (0, 250)
    )
    assert all_of_it.runs.tobytes() == later.runs.tobytes()
    rows = later.runs[later.runs["regime"] == 1]
    counted = rows["T_exit"] >= 250
    each = later.holdings[1]
    assert each.early == int((~counted).sum())
    assert each.watched == (rows["T_exit"][counted] - 250).sum()
    assert each.exits == int((counted & ~rows["censored"]).sum())


def test_units_differ():
    found = exits(
        Params(mu=0.01, A=0.015),
        Scatter(noise=0.01, spread={"mu": 0.02, "r": 0.01}, seed=5),
        runs=4,
        periods=50,
        random=4,
    )
    assert [a.name for a in found.attractors] == ["1:1"]
    assert found.runs["censored"].all()


@pytest.mark.parametrize(
    ("p", "scatter", "options", "error", "message"),
    [
        (Parallel(mu=(0.01,), A=0.02), Scatter(noise=0.1), {}, ParameterError, "cannot do the system 'parallel'"),
        (FIG_11, Scatter(r_speed=0.1), {}, ParameterError, "scatter has r_speed, which changes the regimes"),
        (
            ImpactPair(B=0.5, G=0.0, r=0.5),
            Scatter(noise=0.1),
            {},
            ParameterError,
            "scatter of the impact pair has noise",
        ),
        (FIG_11, Scatter(phase_diffusion=0.1), {"splitting": 32}, ParameterError, "which splitting cannot do"),
        (FIG_11, Scatter(noise=0.1), {"splitting": 3}, ParameterError, "allowed is splitting >= 16"),
        (FIG_11, Scatter(noise=0.1), {"periods": 10, "wait": 10}, StateError, "allowed is wait < periods"),
        (FIG_11, Scatter(spread={"B": 0.1}), {}, ParameterError, "spread: unknown parameter 'B'"),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(p, scatter, options, error, message):
    with pytest.raises(error, match=message) as caught:
        exits(p, scatter, **options)
    assert "\n" not in str(caught.value)


def test_a_splitting_whose_repetitions_disagree_tells_no_mean():
    # The 1:1 is held for some 10^16 periods: few runs do not find how it is left.
    p = Params(mu=0.05, A=0.125, Omega=1.17)
    found = exits(p, Scatter(noise=0.05, seed=1), runs=2, periods=500, splitting=24, random=2, words=["LR"])
    (rare,) = found.split
    assert rare.remark == "no levels were found that lead to an exit"
    assert all(math.isnan(value) for value in (rare.mean, rare.low, rare.high, rare.relative_error))
    assert f"no mean ({rare.remark})" in str(found)
    assert np.isfinite(found.law).all()


@pytest.mark.parametrize(
    ("rates", "fewest", "told"),
    [
        (np.full(8, 1e-9) * np.geomspace(0.2, 5.0, 8), 9, ""),
        (np.full(8, 1e-9) * np.geomspace(0.02, 50.0, 8), 9, "the repetitions lie between 2e+07 and 5e+10 periods"),
        ([*([1e-9] * 7), 0.0], 0, "1 of 8 repetitions came to no exit"),
        (np.full(8, 1e-9), 3, "only 3 of 64 runs came to one of the levels"),
    ],
)
def test_a_mean_is_told_of_repetitions_that_agree(rates, fewest, told):
    assert doubt(list(rates), fewest, 64) == told


@pytest.mark.full
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(("A", "told"), [(0.115, True), (0.125, False)])
def test_which_amplitudes_a_splitting_can_tell_of(A, told, seed):
    noise = Scatter(noise=0.05, seed=seed)
    found = exits(Params(mu=0.05, A=A, Omega=1.17), noise, runs=4, periods=4000, splitting=64, **FEW)
    (rare,) = found.split
    assert (not rare.remark) == told
    assert told == math.isfinite(rare.mean)


@pytest.mark.full
def test_splitting_agrees_with_plain_runs_where_both_can():
    # The 1:1 beside chaos, held for some thousands of periods.
    p = Params(mu=0.05, A=0.115, Omega=1.17)
    found = exits(p, Scatter(noise=0.1, seed=6), runs=60, periods=4000, splitting=96, **FEW)
    (plain,) = [h for h, a in zip(found.holdings, found.attractors, strict=True) if a.name == "1:1"]
    (rare,) = found.split
    assert plain.exits > 20
    error = math.hypot(1.0 / math.sqrt(plain.exits), rare.relative_error)
    assert abs(math.log(rare.mean / plain.mean)) < 4 * error
    assert rare.relative_error < 0.3
    assert rare.low < rare.mean < rare.high
