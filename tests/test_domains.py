"""Every argument of every public function of the science has a domain: what lies outside is refused in one line.

Each argument in turn is given what no argument takes, and what only few take. The answer is a result or a `VinesError`
whose message is one line; never another exception, a text of numpy or numba, or a hang.
"""

from __future__ import annotations

import inspect
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from numba.core import event

import vines
from vines import attractors, dynamics, orbits
from vines.domains import Number, Whole, stated
from vines.dynamics import Scatter
from vines.errors import ParameterError, VinesError
from vines.model import VI_NES, Params, PhysicalParams, Word
from vines.systems import ImpactPair, Parallel

NONSENSE = ["a", b"x", 1j, object(), {"a": 1}, {}, [], [1.0, "b"], True, None, np.array([1.0, 2.0]), np.array([])]
NUMBERS = [float("nan"), float("inf"), -float("inf"), -1, 0, 2.5, 1e300, -1e300, 1e-300, 1e9, 10**400]
SECONDS = 60
"""A call may take no longer, on a busy machine: each takes some milliseconds on one that is not."""

P = Params(mu=0.01, A=0.017)
FLIGHT = Params(mu=0.1, A=0.3, Omega=1.2)
SHORT: dict[str, Any] = {"settle": 2, "record": 4, "patience": 0, "watch": 16}
AXES = {"A": [0.017, 0.0175], "Omega": [1.0]}
STATE = {"x1": 0.0, "v1": 0.0, "x2": 0.0, "v2": 0.1}


def _orbit(**changed: float) -> Any:
    return vines.find_orbit("LR", P.replace(**changed))


Calls = dict[str, tuple[Callable[..., Any], dict[str, Any]]]


def _by_name(function: Callable[..., Any], *first: Any, **rest: Any) -> Callable[..., Any]:
    """Return a function of keywords that gives them to another one as one mapping."""
    return lambda **given: function(*first, given, **rest)


@pytest.fixture(scope="module")
def calls() -> Calls:
    run = vines.simulate(P, periods=20)
    orbit = vines.find_orbit("LR", P)
    [bifurcation] = vines.continue_orbit(orbit, "A", 0.0185).bifurcations
    known = attractors.atlas(P, {"A": [0.017], "Omega": [1.0]}, words=["LR"])
    walk = {"within": None, "at": (), "step": 0.02, "max_points": 50}
    options = {**SHORT, "tolerance": 1e-10, "largest_p": 2, "max_impacts_per_period": 100}
    scatter = {name: each.default for name, each in inspect.signature(Scatter).parameters.items()}
    table = {"mu": 0.01, "A": 0.02, "Omega": 1.0, "r": 0.65, "lam": 0.01}
    return {
        "Params": (Params, table),
        "ImpactPair": (ImpactPair, {"B": 0.5, "G": 0.0, "r": 0.5}),
        "Parallel": (Parallel, {**table, "mu": (0.01, 0.02), "beta": 1.0, "G": 0.0}),
        "PhysicalParams": (PhysicalParams, {each.name: each.default for each in VI_NES.rig}),
        "PhysicalParams.dimensionless": (PhysicalParams().dimensionless, {"E": 0.001, "omega": 55.0, "m": 0.1}),
        "Word": (Word, {"text": "LR"}),
        "Scatter": (lambda **given: vines.ensemble(P, periods=1, scatter=Scatter(**given)), scatter),
        "simulate": (
            vines.simulate,
            {"p": P, "t": 0.0, "phi": 0.0, "periods": 2, "max_impacts_per_period": 100, **STATE},
        ),
        "settle": (vines.settle, {"p": P, "t": 0.0, "phi": 0.0, "apart": 0.0, **options, **STATE}),
        "settle_from": (attractors.settle_from, {"p": P, "start": {**STATE, "phase": 0.0}, **options}),
        "settle_from, start": (_by_name(attractors.settle_from, P, **SHORT), {**STATE, "phase": 0.0}),
        "classify_many": (vines.classify_many, {"params": P, "starts": {"v2": [0.1]}, "threads": 1, **options}),
        "classify_many, params": (_by_name(vines.classify_many, **SHORT), table),
        "classify_many, starts": (_by_name(vines.classify_many, P, **SHORT), {**STATE, "phase": 0.0}),
        "ensemble": (
            vines.ensemble,
            {
                "params": P,
                "starts": None,
                "periods": 2,
                "settle": 1,
                "record": "measures",
                "scatter": None,
                "max_impacts_per_period": 100,
                "threads": 1,
            },
        ),
        "ensemble, starts": (_by_name(vines.ensemble, P, periods=2), {**STATE, "phase": 0.0}),
        "basins": (
            attractors.basins,
            {
                "p": P,
                "x": ("x2", [0.1]),
                "y": ("v2", [0.1]),
                "others": {},
                "refine": 0,
                "settle": 32,
                "patience": 32,
                "watch": 16,
            },
        ),
        "atlas": (
            attractors.atlas,
            {"p": P, "axes": {"A": [0.017], "Omega": [1.0]}, "words": ["LR"], "every": 1, "runs": 0, "seed": 0},
        ),
        "Atlas.entry_of": (known.entry_of, {"orbit": orbit}),
        "orbit_of": (attractors.orbit_of, {"attractor": vines.settle(P, lyapunov=False, errors=False)}),
        "exits": (
            vines.exits,
            {
                "p": P,
                "scatter": Scatter(noise=0.01),
                "start": {"v2": 0.1},
                "words": (),
                "runs": 1,
                "periods": 2,
                "confirm": 2,
                "wait": 0,
                "splitting": 0,
                "random": 0,
                "seed": 0,
                "settle": 2,
                "record": 4,
                "watch": 16,
                "threads": 1,
            },
        ),
        "mean_interval": (attractors.mean_interval, {"exits": 3, "watched": 100.0, "level": 0.95}),
        "share_error": (attractors.share_error, {"share": 0.5, "number": 10}),
        "impact_map": (
            dynamics.impact_map,
            {"p": FLIGHT, "side": 1, "side_next": -1, "state": (0.3, 0.3, -0.7, -0.8, 0.0), "phi": 0.4},
        ),
        **{
            name: (getattr(dynamics, name), {"p": FLIGHT, "state": (0.3, 0.3, -0.7, -0.8, 0.0), "phi": 0.4})
            for name in ("P1", "P2", "P3", "P4")
        },
        "jacobian": (
            dynamics.jacobian,
            {
                "p": FLIGHT,
                "side": 1,
                "side_next": -1,
                "before": (0.3, 0.3, -0.7, -0.8),
                "phase": 0.4,
                "tau": 2.3409392834070411,
            },
        ),
        "decay": (dynamics.decay, {"run": run, "shares": (0.1, 0.01)}),
        "lyapunov_spectrum": (dynamics.lyapunov_spectrum, {"run": run, "skip": 0.0}),
        "tangent_map": (dynamics.tangent_map, {"run": run}),
        "no_ball": (vines.no_ball, {"p": P}),
        "ball_locked": (vines.ball_locked, {"p": P}),
        "Trajectory.sample": (run.sample, {"n": 10}),
        "Trajectory.sample, times": (run.sample, {"times": [1.0, 2.0]}),
        "Trajectory.sample, per_period": (run.sample, {"per_period": 4}),
        "Trajectory.measures": (run.measures, {"last": 2}),
        "all_orbits": (vines.all_orbits, {"word": "LR", "p": P}),
        "find_orbit": (vines.find_orbit, {"word": "LR", "p": P, "guess": None}),
        "continue_orbit": (vines.continue_orbit, {"orbit": orbit, "parameter": "A", "stop": 0.0171, **walk}),
        "follow_cascade": (
            orbits.follow_cascade,
            {"orbit": orbit, "parameter": "A", "stop": 0.0171, "depth": 1, **walk},
        ),
        "follow_families": (
            orbits.follow_families,
            {
                "word": "LR",
                "p": P,
                "parameter": "A",
                "within": (0.01699, 0.01701),
                "seeds": [0.017],
                "depth": 0,
                "at": (),
                "step": 0.02,
            },
        ),
        "follow_curve": (
            orbits.follow_curve,
            {
                "bifurcation": bifurcation,
                "parameters": ("A", "mu"),
                "box": {"A": (0.015, 0.025), "mu": (0.009, 0.011)},
                "step": 0.05,
                "max_points": 3,
            },
        ),
        "switch_branch": (vines.switch_branch, {"bifurcation": bifurcation}),
        "mirror_image": (orbits.mirror_image, {"orbit": orbit}),
        "carry_orbit": (orbits.carry_orbit, {"orbit": orbit, "p": P.replace(A=0.0171)}),
        "optimise": (
            orbits.optimise,
            {
                "word": "LR",
                "objective": "kinetic_ratio",
                "p": P,
                "over": {"A": (0.0169, 0.0171)},
                "largest_multiplier": 1.0,
            },
        ),
        "manifold_amplitude": (orbits.manifold_amplitude, {"V": 0.5, "r": 0.6}),
        "manifold_range": (orbits.manifold_range, {"r": 0.6}),
        "reduced_range": (orbits.reduced_range, {"p": P}),
        "reduced_orbits": (orbits.reduced_orbits, {"p": P}),
        "symmetric_orbits": (orbits.symmetric_orbits, {"p": P, "period": 1}),
        "symmetric_fold": (orbits.symmetric_fold, {"p": P, "period": 1}),
        "symmetric_table": (orbits.symmetric_table, {**table, "period": 1}),
        "words_up_to": (orbits.words_up_to, {"length": 3, "period": 1}),
    }


BESIDE = {
    "curve_rows", "branch_row", "bifurcation_row", "orbit_row", "orbit_outline", "own_word", "warm_up", "apart",
    "of_two_mirror_images", "one_of", "orbit_through", "partners", "coexisting", "shoots", "random_starts",
    "stationary_law",
}  # fmt: skip
"""Public to the rooms above, which call them with what other functions returned."""


def test_every_public_function_of_the_science_is_called_here(calls: Calls) -> None:
    public = {
        name
        for room in (attractors, dynamics, orbits)
        for name in room.__all__
        if inspect.isfunction(getattr(room, name)) and getattr(room, name).__module__.startswith("vines.")
    }
    assert public - {name.partition(",")[0] for name in calls} == BESIDE


@contextmanager
def _no_longer_than(seconds: int) -> Iterator[None]:
    def stop(_number: int, _frame: object) -> None:
        raise TimeoutError(f"not done after {seconds} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def _answer(call: Callable[[], Any]) -> str:
    """Return what is wrong with the answer to a call, nothing if it is a result or a refusal in one line."""
    try:
        with _no_longer_than(SECONDS):
            call()
    except VinesError as error:
        said = str(error)
        return "" if "\n" not in said and said.isprintable() and len(said) < 400 else f"says {said!r}"
    except Exception as error:
        return f"raises {type(error).__name__}: {error}"
    return ""


@pytest.mark.filterwarnings("error")
def test_whatever_is_given_is_taken_or_refused_in_one_line(calls: Calls) -> None:
    wrong: list[str] = []
    for name, (function, arguments) in calls.items():
        assert _answer(lambda: function(**arguments)) == "", name  # noqa: B023
        for argument in arguments:
            for value in (*NONSENSE, *NUMBERS):
                answer = _answer(lambda: function(**{**arguments, argument: value}))  # noqa: B023
                if answer:
                    wrong.append(f"{name}({argument}={value!r:.30}) {answer:.200}")
    assert not wrong, "\n".join(wrong)


def test_numbers_of_other_kinds_than_those_of_python_are_the_same_to_kernels(calls: Calls) -> None:
    wrong: list[str] = []
    for name, (function, arguments) in calls.items():
        _answer(lambda: function(**arguments))  # noqa: B023
        for argument, value in arguments.items():
            if type(value) not in (int, float):
                continue
            with event.install_recorder("numba:compile") as compiled:
                answer = _answer(lambda: function(**{**arguments, argument: np.array(value)}))  # noqa: B023
            if answer or compiled.buffer:
                wrong.append(f"{name}({argument}={np.array(value)!r}) {answer or 'compiles anew'}")
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("value", [np.float32(0.5), np.float16(0.5), np.array(0.5), Fraction(1, 2), np.float64(0.5)])
def test_a_function_gets_an_allowed_number_as_one_of_python(value: Any) -> None:
    @stated(ParameterError, share=Number(), count=Whole())
    def types(share: float, count: int = 1) -> tuple[type, type]:
        return type(share), type(count)

    assert types(value, np.array(3)) == types(share=value, count=np.uint8(3)) == (float, int)
    assert types(1, count=2) == (int, int)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: attractors.atlas(P, AXES, words="LR"), "words is 'LR'; give a list of words"),
        (lambda: attractors.atlas(P, AXES, runs=2**70), "runs is 1180591620717411303424; give an integer >= 0 and <= "),
        (
            lambda: attractors.atlas(P, AXES, words=["LR"]).entry_of(_orbit(A=0.05)),
            "A of the orbit is 0.05, the atlas goes",
        ),
        (
            lambda: attractors.atlas(P, AXES, words=["LR"]).entry_of(_orbit(mu=0.02)),
            "mu of the orbit is 0.02, that of the",
        ),
        (
            lambda: attractors.orbit_of(vines.settle(ImpactPair(B=0.5, r=0.5))),
            "attractor is of ImpactPair, this is there",
        ),
        (lambda: vines.simulate({"mu": 0.01, "A": 0.02}), "p is {'mu': 0.01, 'A': 0.02}; give parameters"),
        (lambda: vines.settle(0.02), "p is 0.02; give parameters, such as vines.Params(mu=0.01, A=0.02)"),
        (lambda: vines.settle(P, tolerance="a"), "tolerance is 'a'; give a finite number > 0 and <= 0.0001"),
        (lambda: vines.settle(P, tolerance=1), "tolerance is 1; give a finite number > 0 and <= 0.0001"),
        (
            lambda: vines.settle(P, max_impacts_per_period=float("nan")),
            "max_impacts_per_period is nan; give an integer",
        ),
        (
            lambda: vines.simulate(P, max_impacts_per_period=float("inf")),
            "max_impacts_per_period is inf; give an integer",
        ),
        (lambda: vines.simulate(P, v1=1e300), "v1 is 1e+300 at the start; give a finite number >= -1e+06 and <= 1e+06"),
        (lambda: Params(mu=0.01, A=0.02, Omega=1e-6), "Omega is 1e-06, allowed is 0.001 <= Omega <= 10000"),
        (
            lambda: vines.simulate(P.replace(Omega=1e-3), periods=20000),
            "periods is 20000, of 1e+03 periods of the oscill",
        ),
        (lambda: vines.all_orbits("LR", Params(mu=1e300, A=0.02)), "mu is 1e+300, allowed is 1e-12 <= mu <= 1e+06"),
        (lambda: vines.all_orbits("LR", Params(mu=1e-300, A=0.02)), "mu is 1e-300, allowed is 1e-12 <= mu <= 1e+06"),
        (lambda: vines.all_orbits("L" * 201, P), "is too long a word; allowed are 200 impacts over 200T"),
    ],
)
def test_what_hung_or_ended_in_a_traceback_is_refused_with_what_is_allowed(call: Callable[[], Any], said: str) -> None:
    with pytest.raises(VinesError) as refused:
        call()
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
