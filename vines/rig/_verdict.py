"""Agreement of a run with a branch of the model, and what is said about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from vines.model import Params
from vines.rig._cycle import matching, mean_cycle
from vines.rig._model import Predicted, reshaped
from vines.rig._reconstruction import Reconstruction
from vines.rig._recording import Uncertain
from vines.rig._uncertainty import error_ratio

__all__ = ["VERDICTS", "Comparison", "Likeness", "decide", "likeness", "order"]

Floats = npt.NDArray[np.float64]

VERDICTS = ("agree", "pattern_only", "disagree", "undecidable")

_SURE = 0.05
_FAIR = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Likeness:
    """A run beside one branch.

    Attributes
    ----------
    predicted : Predicted
    matches : bool
        Whether the branch shows the measured pattern.
    errors : mapping of str to float
        E_n of ``phase`` (the worst place of the pattern), ``max_abs_x1`` and ``kinetic_ratio``.
    measured, model : mapping of str to Uncertain
        Of the same; phase of the worst place [rad].
    rms_w, rms_w_dot : float
        Root mean square of the difference of the mean cycles of w and w', relative to that of the model.
    cycle : tuple of ndarray
        The measured mean cycle of w and w', dimensionless.
    """

    predicted: Predicted
    matches: bool
    errors: Mapping[str, float]
    measured: Mapping[str, Uncertain]
    model: Mapping[str, Uncertain]
    rms_w: float
    rms_w_dot: float
    cycle: tuple[Floats, Floats] = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """A run beside all branches that coexist at its parameters.

    Attributes
    ----------
    run : Reconstruction
    params : Params
        At which they were compared.
    basis : str
        ``measured`` or ``calibrated``.
    branches : tuple of Likeness
        The nearest one first.
    verdict : str
        One of `VERDICTS`.
    reason : str
        Why, in one line.
    """

    run: Reconstruction
    params: Params
    basis: str
    branches: tuple[Likeness, ...]
    verdict: str
    reason: str


def likeness(run: Reconstruction, predicted: Predicted) -> Likeness:
    """Lay a run beside an ensemble about one branch."""
    q = run.quantities
    measured = {name: q[name] for name in ("max_abs_x1", "kinetic_ratio")}
    model = {"max_abs_x1": predicted.max_abs_x1, "kinetic_ratio": predicted.kinetic_ratio}
    errors: dict[str, float] = {}
    matches = predicted.holding > _SURE and bool(predicted.phases)
    if run.slots is not None and predicted.phases:
        mean = reshaped(run.pattern, run.slots)
        u = q["impact_phase"].u
        errors["phase"], k, turned = _phases(mean, u, predicted.phases, run.pattern.p)
        measured["phase"] = Uncertain(float(mean[k]), u)
        model["phase"] = turned[k]
    for name in ("max_abs_x1", "kinetic_ratio"):
        errors[name] = error_ratio(measured[name], model[name])
    cycle = _cycle(run)
    rms = [
        float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2))) if len(b) == len(a) else float("nan")
        for a, b in zip(cycle, predicted.cycle, strict=True)
    ]
    return Likeness(predicted, matches, errors, measured, model, rms[0], rms[1], cycle)


def decide(run: Reconstruction, branches: tuple[Likeness, ...]) -> tuple[str, str]:
    """Return the verdict and why.

    Notes
    -----
    ``undecidable`` where the data contradict themselves or are too poor, where no pattern holds in 95 % of the periods
    (mixed or chaotic), or where the model's own answer is open within the uncertainties; ``disagree`` where a clear
    pattern is none of the model's; ``pattern_only`` where the pattern is but a number is not; else ``agree``.
    """
    if not run.accepted:
        return "undecidable", run.reasons
    if not run.pattern.holds:
        shares = ", ".join(f"{k} {v:.0%}" for k, v in list(run.pattern.fractions.items())[:3])
        return "undecidable", f"no pattern holds in 95 % of the periods ({shares}): mixed or chaotic"
    with_it = [one for one in branches if one.matches]
    names = ", ".join(sorted({one.predicted.candidate.name for one in branches})) or "none"
    if not with_it:
        wandering = [one for one in branches if one.predicted.candidate.regime in ("chaotic", "quasiperiodic")]
        near = max((one.predicted.fraction.value for one in branches), default=0.0)
        if wandering:
            regime = wandering[0].predicted.candidate.regime
            return "undecidable", f"the model is {regime} at the measured parameters, the run shows {run.pattern.name}"
        if near > _FAIR:
            return (
                "undecidable",
                f"with the measured scatter the model keeps {run.pattern.name} in {near:.0%} of the periods",
            )
        return "disagree", f"the run shows {run.pattern.name}, the model has {names} at the measured parameters"
    best = with_it[0]
    if best.predicted.holding < _FAIR:
        return (
            "undecidable",
            f"{run.pattern.name} holds in {best.predicted.holding:.0%} of the draws of the measured parameters: a "
            "bifurcation lies within their uncertainty",
        )
    worst = max(best.errors, key=lambda name: best.errors[name])
    listed = ", ".join(f"E_n({name}) = {value:.2f}" for name, value in best.errors.items())
    if best.errors[worst] <= 1:
        return "agree", f"{best.predicted.candidate.name}: {listed}"
    return "pattern_only", f"{best.predicted.candidate.name}: {listed}"


def order(branches: list[Likeness]) -> tuple[Likeness, ...]:
    """Return branches with the measured pattern first, the nearest before the others."""
    return tuple(sorted(branches, key=lambda one: (not one.matches, max(one.errors.values(), default=np.inf))))


def _phases(mean: Floats, u: float, model: tuple[Uncertain, ...], p: int) -> tuple[float, int, tuple[Uncertain, ...]]:
    """Return E_n of the worst place of the pattern, which it is, and the model there; a pattern may begin anywhere."""
    best: tuple[float, int, tuple[Uncertain, ...]] = (np.inf, 0, model)
    size = max(len(mean) // p, 1)
    for turn in range(p):
        rolled = model[turn * size :] + model[: turn * size]
        apart = [
            error_ratio(Uncertain(0.0, u), Uncertain(_turn(m - one.value), one.u))
            for m, one in zip(mean, rolled, strict=True)
        ]
        k = int(np.argmax(apart))
        if apart[k] < best[0]:
            best = (apart[k], k, rolled)
    return best


def _turn(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def _cycle(run: Reconstruction) -> tuple[Floats, Floats]:
    begin = run.track.periods_begin(run.periods, matching(run.periods, run.pattern.word))
    w, w_dot = mean_cycle(run.track, begin, 2 * np.pi * run.pattern.p / run.track.motion.omega)
    b = run.quantities["b"].value
    return w / b, w_dot / (b * run.quantities["omega0"].value)
