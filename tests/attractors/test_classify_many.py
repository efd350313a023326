"""Many runs at once are judged as `settle` judges one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vines.attractors import Attractor, Classified, classify_many, settle, settle_from
from vines.errors import StateError
from vines.model import PARAMETER_NAMES, Params

NAMES = ("x1", "v1", "x2", "v2", "phase")


def _random(n: int, seed: int) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    rng = np.random.default_rng(seed)
    parameters = {
        "mu": 10 ** rng.uniform(-3, 0, n),
        "A": 10 ** rng.uniform(-2.3, 0.3, n),
        "Omega": rng.uniform(0.6, 1.6, n),
        "r": rng.uniform(0.3, 0.9, n),
    }
    starts = {name: rng.uniform(-1, 1, n) for name in ("x1", "v1", "v2")}
    starts["x2"] = starts["x1"] - rng.uniform(-1, 1, n)
    return parameters, starts


def _alone(many: Classified, **options: float) -> Iterator[Attractor]:
    for row, start in zip(many.parameters, many.starts, strict=True):
        p = Params(**dict(zip(PARAMETER_NAMES, row.tolist(), strict=True)))
        yield settle_from(p, dict(zip(NAMES, start.tolist(), strict=True)), **options)


def test_on_its_attractor_a_run_is_judged_as_settle_judges_it() -> None:
    # From the ends of other runs and without a transient both follow the same kernels.
    parameters, starts = _random(150, 5)
    first = classify_many(parameters, starts, settle=300, watch=64)
    # Where one is watched on for longer, chaos makes two of a difference in rounding.
    options = {"settle": 0, "patience": 0, "watch": 64, "errors": False}
    many = classify_many(
        dict(zip(PARAMETER_NAMES, first.parameters.T, strict=True)),
        dict(zip(NAMES, first.final.T, strict=True)),
        **options,
    )
    for k, one in enumerate(_alone(many, **options)):
        assert (one.regime, one.settled, one.name) == (many.regime[k], many.settled[k], many.name[k])
        assert one.lyapunov == pytest.approx(many.lyapunov[k], rel=1e-6, abs=1e-6, nan_ok=True)


def test_from_random_starts_they_differ_only_where_a_transient_is_chaotic() -> None:
    """Lanes and the scalar kernel round differently, and a chaotic transient forgets which orbit was to be reached.

    Both answers must then come up among starts of the scalar kernel that differ in the ninth digit. Where chaos lasts
    (points 10 and 242 leave it after some 5,000 and 900 periods, 365 after some 45,000) one of them may be rare. A run
    that one of them calls unsettled, such as a ball that chaos has left nearly at rest, needs no second one.
    """
    parameters, starts = _random(400, 1)
    many = classify_many(parameters, starts)
    other = []
    for k, one in enumerate(_alone(many)):
        if (one.regime, one.name) != (many.regime[k], many.name[k]):
            other.append((k, {(one.regime, one.name), (many.regime[k], many.name[k])}))
        elif one.name:
            assert one.measures.max_abs_x1 == pytest.approx(many.measures["max_abs_x1"][k], rel=1e-8)
    assert len(other) <= 18
    assert sum(("unsettled", None) in answers for _, answers in other) <= 5
    for k, answers in other:
        p = Params(**dict(zip(PARAMETER_NAMES, many.parameters[k].tolist(), strict=True)))
        start = dict(zip(NAMES, many.starts[k].tolist(), strict=True))
        wanted = answers - {("unsettled", None)}
        for j in range(1, 1000):
            near = settle_from(p, start | {"v1": start["v1"] + j * 1e-9})
            wanted.discard((near.regime, near.name))
            if not wanted:
                break
        assert not wanted, f"point {k}: {wanted} of {answers} is not among neighbouring starts"


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**31), st.integers(1, 40))
def test_what_else_is_in_the_call_does_not_matter(seed: int, cut: int) -> None:
    parameters, starts = _random(48, seed)
    options = {"settle": 50, "record": 16, "watch": 16, "patience": 300}
    whole = classify_many(parameters, starts, threads=1, **options)
    for part in (slice(0, cut), slice(cut, None)):
        some = classify_many(
            {name: values[part] for name, values in parameters.items()},
            {name: values[part] for name, values in starts.items()},
            threads=2,
            **options,
        )
        assert np.array_equal(some.verdicts, whole.verdicts[part], equal_nan=True)
        assert np.array_equal(some.totals, whole.totals[part], equal_nan=True)


def test_arrays_and_objects_say_the_same() -> None:
    many = classify_many({"mu": 0.01, "A": [0.002, 0.015, 0.021, 0.03]}, {"v2": [0.0, 0.1, 0.1, 0.1]}, impacts=True)
    assert many.regime.tolist() == ["no_impact", "periodic", "periodic", "chaotic"]
    objects = [many.attractor(k) for k in range(len(many))]
    assert [a.name for a in objects] == many.name.tolist() == [None, "1:1", "2:2/2T", None]
    assert [a.symmetric for a in objects] == [None, True, False, None]
    assert [a.measures.kinetic_ratio for a in objects] == many.measures["kinetic_ratio"].tolist()
    assert [len(a.impacts) > 0 for a in objects] == [False, True, True, True]
    # A recording ends when the run is seen to repeat, and only then.
    assert [a.recorded for a in objects] == [64, 4, 4, 64]
    assert objects[1].measures.duration == pytest.approx(2 * np.pi)
    assert many.p.tolist() == [0, 1, 2, 0]
    assert np.all(many.sticks == 0)
    assert many.status.tolist() == ["complete"] * 4


def test_a_cap_and_bad_options_are_said() -> None:
    capped = classify_many(Params(mu=0.0084, A=0.015), max_impacts_per_period=5)
    assert capped.status.tolist() == ["impact_cap"]
    assert (capped.regime[0], capped.settled[0]) == ("unsettled", False)
    assert "cap" in capped.reason[0]
    with pytest.raises(StateError, match="watch is 3 periods"):
        classify_many(Params(mu=0.01, A=0.015), watch=3)
    with pytest.raises(StateError, match="settle is -1 periods"):
        settle(Params(mu=0.01, A=0.015), settle=-1)
