"""Agreement of a run with a branch of the model, and what is said about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from vines.model import Params
from vines.rig.quantities import HOLDS, Reconstruction, Slots, matching, mean_cycle
from vines.rig.recording import Uncertain
from vines.rig.uncertainty import error_ratio, mean_over_periods
from vines.rig.verdict._model import Predicted, reshaped

__all__ = ["VERDICTS", "Comparison", "Likeness", "decide", "likeness", "order"]

Floats = npt.NDArray[np.float64]

VERDICTS = ("agree", "pattern_only", "disagree", "undecidable")

_SURE = 0.95
_FAIR = 0.5
_MEASURES = 3

_VAGUE = {"phase": 0.15, "max_abs_x1": 0.1, "kinetic_ratio": 0.2}
"""Standard uncertainty of measured and modelled value together beyond which E_n < 1 says nothing [rad, relative]."""


@dataclass(frozen=True, slots=True, eq=False)
class Likeness:
    """A run beside one branch.

    Attributes
    ----------
    predicted : Predicted
    matches : bool
        Whether the branch shows the measured pattern in any of the ensemble.
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
    if run.slots is not None and predicted.phases:
        own = _measured_phases(run, run.slots)
        errors["phase"], measured["phase"], model["phase"] = _phases(own, predicted.phases, run.pattern.p)
    for name in ("max_abs_x1", "kinetic_ratio"):
        errors[name] = error_ratio(measured[name], model[name])
    cycle = _cycle(run)
    rms = [
        float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2))) if len(b) == len(a) else float("nan")
        for a, b in zip(cycle, predicted.cycle, strict=True)
    ]
    return Likeness(predicted, predicted.holding > 0, errors, measured, model, rms[0], rms[1], cycle)


def decide(run: Reconstruction, branches: tuple[Likeness, ...]) -> tuple[str, str]:
    """Return the verdict and why.

    Notes
    -----
    ``undecidable`` where the data contradict themselves or are too poor, where no pattern holds in 95 % of the periods
    (mixed or chaotic), or where the model's own answer is open within the uncertainties: the pattern shows in some of
    the ensemble only, or the model is chaotic at some of the draws, or a number is known too poorly for agreement to
    mean something. ``disagree`` where a clear pattern is none of the model's; ``pattern_only`` where the pattern is but
    a number is not; else ``agree``.
    """
    if not run.accepted:
        return "undecidable", run.reasons
    shown = run.pattern.name
    if not run.pattern.holds:
        shares = ", ".join(f"{k} {v:.0%}" for k, v in list(run.pattern.fractions.items())[:3])
        return "undecidable", f"no pattern holds in {HOLDS:.0%} of the periods ({shares}): mixed or chaotic"
    with_it = [one for one in branches if one.matches]
    open_ones = [one for one in branches if not _periodic(one.predicted.candidate.regime)]
    if not with_it:
        if open_ones:
            return "undecidable", f"the run shows {shown}, the model is {open_ones[0].predicted.candidate.regime} here"
        near = max((one.predicted.fraction.value for one in branches), default=0.0)
        if near > _FAIR:
            return "undecidable", f"with the measured scatter the model keeps {shown} in {near:.0%} of the periods"
        names = ", ".join(sorted({one.predicted.candidate.name for one in branches})) or "none"
        return "disagree", f"the run shows {shown}, the model has {names} at these parameters"
    best = with_it[0].predicted
    if best.holding < _FAIR:
        return "undecidable", (
            f"with the measured scatter and uncertainties {shown} holds in {best.holding:.0%} of the ensemble: a "
            "bifurcation is too near"
        )
    if not _periodic(best.candidate.regime):
        return "undecidable", f"the model shows {shown} with scatter only; without, it is {best.candidate.regime}"
    if best.periodic < _SURE:
        return "undecidable", f"the model without scatter is not periodic at {1 - best.periodic:.0%} of the draws"
    errors = with_it[0].errors
    listed = f"{best.candidate.name}: " + ", ".join(f"E_n({name}) = {value:.2f}" for name, value in errors.items())
    if not all(np.isfinite(value) for value in errors.values()) or len(errors) < _MEASURES:
        return "undecidable", f"{listed}: a quantity is missing"
    if max(errors.values()) > 1:
        return "pattern_only", listed
    vague = [name for name, most in _VAGUE.items() if _open(with_it[0], name) > most]
    if vague:
        shares = ", ".join(f"{name} to {_open(with_it[0], name):.2g}" for name in vague)
        return "undecidable", f"{listed}, but scatter and what is not known leave open {shares}: too much to agree"
    return "agree", listed


def _open(one: Likeness, name: str) -> float:
    """Return the standard uncertainty of measured and modelled value together; relative, of a phase in radians."""
    both = float(np.hypot(one.measured[name].u, one.model[name].u))
    return both if name == "phase" else both / abs(one.model[name].value)


def order(branches: list[Likeness]) -> tuple[Likeness, ...]:
    """Return branches with the measured pattern first, periodic ones before others, then the nearest."""

    def rank(one: Likeness) -> tuple[bool, bool, bool, float]:
        shown = one.predicted
        return not one.matches, shown.holding < _FAIR, not _periodic(shown.candidate.regime), max(one.errors.values())

    return tuple(sorted(branches, key=rank))


def _periodic(regime: str) -> bool:
    return regime in ("periodic", "no_impact")


def _measured_phases(run: Reconstruction, found: Slots) -> list[Uncertain]:
    """Return the impact phase in each place of the pattern, with its uncertainty [rad]."""
    p = run.pattern.p
    mean = reshaped(run.pattern, found)
    away = np.angle(np.exp(1j * (found.phase - mean) / p)) * p
    spread = [mean_over_periods(column, found.period, len(run.periods.words)).u for column in away.T]
    # The alignment of clocks, common to all places, is what the first place's uncertainty has beyond its spread.
    common = max(run.quantities["impact_phase"].u ** 2 - spread[0] ** 2, 0.0)
    return [Uncertain(float(m), float(np.hypot(u, np.sqrt(common)))) for m, u in zip(mean, spread, strict=True)]


def _phases(own: list[Uncertain], model: tuple[Uncertain, ...], p: int) -> tuple[float, Uncertain, Uncertain]:
    """Return E_n, measured and model value of the worst place of the pattern; a pattern may begin anywhere."""
    best: tuple[float, Uncertain, Uncertain] | None = None
    size = max(len(own) // p, 1)
    for turn in range(p):
        rolled = model[turn * size :] + model[: turn * size]
        apart = [
            error_ratio(Uncertain(0.0, a.u), Uncertain(_turn(a.value - b.value), b.u))
            for a, b in zip(own, rolled, strict=True)
        ]
        k = int(np.argmax(apart))
        if best is None or apart[k] < best[0]:
            # Both on one turn, so that a picture can show them side by side.
            best = (apart[k], own[k], Uncertain(own[k].value - _turn(own[k].value - rolled[k].value), rolled[k].u))
    assert best is not None
    return best


def _turn(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def _cycle(run: Reconstruction) -> tuple[Floats, Floats]:
    begin = run.track.periods_begin(run.periods, matching(run.periods, run.pattern.word))
    w, w_dot = mean_cycle(run.track, begin, 2 * np.pi * run.pattern.p / run.track.motion.omega)
    b = run.quantities["b"].value
    return w / b, w_dot / (b * run.quantities["omega0"].value)
