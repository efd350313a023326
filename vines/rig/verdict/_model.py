"""The model with the measured scatter and uncertainties: an ensemble, looked at as the measured run was."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from vines.model import PARAMETER_NAMES, Params
from vines.rig.fit import Motion, forced_response, free_part, root
from vines.rig.quantities import (
    Pattern,
    Periods,
    Reconstruction,
    Slots,
    Track,
    cut_into_periods,
    find_pattern,
    matching,
    mean_cycle,
    slots,
)
from vines.rig.recording import Uncertain
from vines.rig.uncertainty import combined
from vines.rig.verdict._left_open import left_open
from vines.rig.verdict._match import Candidate
from vines.rig.verdict._sensitivity import Numbers

if TYPE_CHECKING:
    from vines.dynamics import Scatter

__all__ = ["Predicted", "measured_params", "parameter_spread", "predict", "reshaped"]

Floats = npt.NDArray[np.float64]

DRAWS = 32
"""Draws of the parameters; each runs twice, with other restitutions, which tells scatter from uncertainty."""

SETTLE, RECORD = 200, 256
"""Forcing periods."""

_STEEPER = 16
"""Runs of the ensemble that are done again, with the same draws, where r falls faster with speed."""

_FALL = Uncertain(-0.1, 0.1)
"""Exponent of r ~ |w'|^e where a run's speeds are too much alike to tell: metals show -.05 to -.2."""

_CYCLES = 64
_SHOWS = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Predicted:
    """What an ensemble about an attractor of the model shows.

    Attributes
    ----------
    candidate : Candidate
    fraction : Uncertain
        Fraction of periods with the measured counts of impacts: mean and standard deviation over the ensemble.
    holding : float
        Share of the ensemble that shows the measured pattern, by the rule by which the run does.
    periodic : float
        Share of the draws of the parameters at which the model without scatter is periodic from there; nan where the
        pattern does not show.
    phases : tuple of Uncertain
        Impact phase in each place of the pattern [rad].
    max_abs_x1, kinetic_ratio : Uncertain
        Mean over periods of the largest |x1|; K2/K1.
    cycle : tuple of ndarray
        Mean w and w' over the repetitions, dimensionless.
    gaps : ndarray
        Times between impacts in forcing periods, of the whole ensemble.
    """

    candidate: Candidate
    fraction: Uncertain
    holding: float
    periodic: float
    phases: tuple[Uncertain, ...]
    max_abs_x1: Uncertain
    kinetic_ratio: Uncertain
    cycle: tuple[Floats, Floats] = field(repr=False)
    gaps: Floats = field(repr=False)


def measured_params(run: Reconstruction) -> Params:
    """Return the measured parameters; r is that between the mean velocities of flights, at the mean speed of impact."""
    q = run.quantities
    r = min(max(q["r_effective"].value, 0.0), 1.0)
    return Params(mu=q["mu"].value, A=q["A"].value, Omega=q["Omega"].value, r=r, lam=q["lam"].value)


def parameter_spread(run: Reconstruction) -> dict[str, float]:
    """Return the standard uncertainties of the parameters."""
    return {name: run.quantities["r_effective" if name == "r" else name].u for name in PARAMETER_NAMES}


def parameter_draws(p: Params, spread: dict[str, float], draws: int = DRAWS, seed: int = 0) -> dict[str, Floats]:
    """Return draws of the parameters about `p`; the first is `p` itself."""
    rng = np.random.default_rng([seed, 5])
    found = {}
    for name, u in spread.items():
        values = getattr(p, name) + u * rng.normal(size=draws)
        values[0] = getattr(p, name)
        found[name] = np.clip(values, 1e-9, 1.0) if name == "r" else np.maximum(values, 1e-9)
    return found


def predict(
    run: Reconstruction, p: Params, candidate: Candidate, spread: dict[str, float] | None = None, *, seed: int = 0
) -> Predicted:
    """Run the model with scatter from the candidate's state and look at it as at the measured run.

    Parameters
    ----------
    run : Reconstruction
        Gives scatter, the harmonics of the base, the pattern and where its periods are cut.
    p : Params
        Parameters, measured or calibrated.
    candidate : Candidate
    spread : dict, optional
        Standard uncertainties of the parameters; the measured ones if left out.
    seed : int
        Of the draws.
    """
    from vines.attractors import classify_many

    spread = parameter_spread(run) if spread is None else spread
    fall = _exponent(run)
    table = parameter_draws(p, spread, seed=seed)
    shown = _ensemble(run, p, candidate, {name: np.tile(values, 2) for name, values in table.items()}, fall.value, seed)
    again = {name: values[:_STEEPER] for name, values in table.items()}
    steeper = _ensemble(run, p, candidate, again, fall.value - fall.u, seed)
    fractions = np.array([one.fraction for one in shown])
    holding = float(np.mean([one.name == run.pattern.name for one in shown]))
    periodic = float("nan")
    if holding > 0:
        start = {name: np.full(1, value) for name, value in candidate.start.items()}
        periodic = float(np.mean(classify_many(table, start, errors=False, threads=1).regime == "periodic"))
    with_it = [one for one in shown if one.phases is not None and one.fraction > _SHOWS]
    phases = _phases(shown) if with_it else ()
    largest, ratio = (_spread(np.array([getattr(one, name) for one in shown])) for name in ("largest", "ratio"))
    middle = Numbers(np.array([one.value for one in phases]), largest.value, ratio.value)
    still = left_open(run, candidate, spread, middle)
    turned = _turned(shown[:_STEEPER], steeper, len(phases))
    known = still.by_parameters or Numbers(np.zeros(len(phases)), 0.0, 0.0)
    return Predicted(
        candidate,
        Uncertain(float(fractions.mean()), float(fractions.std())),
        holding,
        periodic,
        tuple(
            combined(one.value, max(one.u, own), force, fell)
            for one, own, force, fell in zip(phases, known.phase, still.by_forces.phase, turned.phase, strict=True)
        ),
        combined(largest.value, max(largest.u, known.max_abs_x1), still.by_forces.max_abs_x1, turned.max_abs_x1),
        combined(ratio.value, max(ratio.u, known.kinetic_ratio), still.by_forces.kinetic_ratio, turned.kinetic_ratio),
        _mean_of([one.cycle for one in with_it]),
        np.concatenate([one.gaps for one in shown]),
    )


def _ensemble(
    run: Reconstruction, p: Params, candidate: Candidate, table: dict[str, Floats], exponent: float, seed: int
) -> list[_Shown]:
    """Return what runs of the model with scatter show; run k draws the same restitutions whatever the rest is."""
    from vines.dynamics import ensemble

    scatter, r0 = _scatter(run, p, exponent, seed)
    table = table | {"r": np.clip(table["r"] + r0, 1e-9, 1.0)}
    start = {name: np.full(1, value) for name, value in candidate.start.items()}
    many = ensemble(table, start, settle=SETTLE, periods=RECORD, record="impacts", scatter=scatter, threads=1)
    impacts = many.impacts
    assert impacts is not None
    shown: list[_Shown] = []
    for k, own in enumerate(np.split(impacts, np.searchsorted(impacts["run"], np.arange(1, len(table["r"]))))):
        values = Params(*(float(value) for value in many.parameters[k]))
        shown.append(_show(_track(own, values, scatter), values, run) if len(own) > 8 else _NOTHING)
    return shown


def _exponent(run: Reconstruction) -> Uncertain:
    """Return the exponent of the restitution's fall with speed: as measured, and as metals are."""
    own = run.quantities["r_exponent"]
    if not np.isfinite(own.u):
        return _FALL
    share = _FALL.u**2 / (_FALL.u**2 + own.u**2)
    return Uncertain(_FALL.value + share * (own.value - _FALL.value), float(np.sqrt(share)) * own.u)


def _turned(shown: list[_Shown], steeper: list[_Shown], places: int) -> Numbers:
    """Return what a faster fall of r changes: the mean over pairs of runs with the same draws."""

    def mean(values: list[float]) -> float:
        fair = [value for value in values if np.isfinite(value)]
        return float(np.mean(fair)) if fair else 0.0

    pairs = list(zip(shown, steeper, strict=True))
    both = [
        np.angle(np.exp(1j * (b.phases - a.phases)))
        for a, b in pairs
        if a.phases is not None and b.phases is not None and min(a.fraction, b.fraction) > _SHOWS
    ]
    phase = np.mean(both, axis=0) if both else np.zeros(places)
    return Numbers(phase, mean([b.largest - a.largest for a, b in pairs]), mean([b.ratio - a.ratio for a, b in pairs]))


def _scatter(run: Reconstruction, p: Params, exponent: float, seed: int) -> tuple[Scatter, float]:
    """Return the scatter of an ensemble and what must be added to r where it falls with speed."""
    from vines.dynamics import Scatter

    q = run.quantities
    # r (|w'|/w)^e is near w the line r (1 - e) + r e |w'|/w; the ensemble's speeds are dimensionless.
    speed = q["w_before"].value / (q["b"].value * q["omega0"].value)
    slope = -p.r * exponent / speed
    e = run.base_harmonics
    second = float(abs(e[1] / e[0])) if len(e) > 1 else 0.0
    turn = float(np.angle(e[1]) - 2 * np.angle(e[0]) - np.pi / 2) if len(e) > 1 else 0.0
    scatter = Scatter(sigma_r=q["sigma_r"].value, r_speed=max(slope, 0.0), second=second, second_phase=turn, seed=seed)
    return scatter, max(slope, 0.0) * speed


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """One run of the ensemble, looked at as the measured one."""

    name: str
    fraction: float
    phases: Floats | None
    largest: float
    ratio: float
    cycle: tuple[Floats, Floats]
    gaps: Floats


_NOTHING = _Shown("none", 0.0, None, np.nan, np.nan, (np.zeros(0), np.zeros(0)), np.zeros(0))


def _track(impacts: npt.NDArray[np.void], p: Params, scatter: Scatter) -> Track:
    """Return simulated impacts as the motion between them, in closed form; dimensionless."""
    t = np.asarray(impacts["t"], float)
    keep = np.concatenate([[True], np.diff(t) > 1e-9])
    impacts, t = impacts[keep], t[keep]
    s = root(1.0, p.lam)
    phase0 = float(impacts["phase"][0]) - p.Omega * t[0]
    n = np.array([1.0, 2.0])
    size = p.A * np.array([1.0, scatter.second * np.exp(1j * scatter.second_phase)])
    c = forced_response(-1j * size, n * p.Omega, s) * np.exp(1j * n * phase0)
    motion = Motion(s, p.Omega, c, t, np.zeros(len(t), complex), float(t[-1]))
    x = impacts["x1"] - motion.forced(t)
    v = impacts["v1_after"] - motion.forced(t, 1)
    motion = replace(motion, z=free_part(x, v, s))
    side = np.asarray(impacts["side"], float)
    return Track(motion, t, side, np.asarray(impacts["x2"], float), p.Omega * t + phase0)


def _kinetic_ratio(track: Track, mu: float) -> float:
    """Return K2/K1 between the first impact and the last; the ball flies straight from one to the next."""
    time = np.diff(track.t)
    v2 = float(np.sum(np.diff(track.x2) ** 2 / time)) / float(track.t[-1] - track.t[0])
    return mu * v2 / float(track.motion.mean_square_velocity(track.t[[0, -1]])[0])


def _show(track: Track, p: Params, run: Reconstruction) -> _Shown:
    omega = track.motion.omega
    span = (float(track.phase[0]), float(track.phase[-1]))
    periods = cut_into_periods(track.phase, track.side, span, cut=run.periods.cut)
    usual = run.pattern
    length = usual.p
    found = slots(periods, usual, track.phase, track.side)
    begin = track.periods_begin(periods, matching(periods, usual.word)[:_CYCLES]) if found is not None else np.zeros(0)
    return _Shown(
        find_pattern(periods, track.phase).name,
        _share(periods, usual),
        reshaped(usual, found) if found is not None else None,
        period_maximum(track, periods),
        _kinetic_ratio(track, p.mu),
        mean_cycle(track, begin, 2 * np.pi * length / omega),
        np.diff(track.t) * omega / (2 * np.pi),
    )


def _share(periods: Periods, usual: Pattern) -> float:
    """Return the fraction of periods with the counts of a pattern, wherever it begins."""
    wanted = [(w.count("L"), w.count("R")) for w in usual.word]
    seen, p = periods.counts, usual.p
    if not seen:
        return 0.0
    return max(sum(seen[k::p].count(wanted[(k + turn) % p]) for k in range(p)) for turn in range(p)) / len(seen)


def period_maximum(track: Track, periods: Periods) -> float:
    """Return the mean over complete periods of the largest |x1|."""
    times, values = track.motion.peaks()
    edges = track.periods_begin(periods, np.arange(len(periods.words) + 1))
    number = np.searchsorted(edges, times, side="right") - 1
    inside = (number >= 0) & (number < len(periods.words))
    top = np.zeros(len(periods.words))
    np.maximum.at(top, number[inside], values[inside])
    return float(top[top > 0].mean()) if (top > 0).any() else float("nan")


def _phases(shown: list[_Shown]) -> tuple[Uncertain, ...]:
    """Return mean and uncertainty in each place of the pattern; runs without it count for nothing."""
    turns = np.array([
        one.phases if one.phases is not None and one.fraction > _SHOWS else np.full(size, np.nan)
        for size in [max(len(one.phases) for one in shown if one.phases is not None)]
        for one in shown
    ])  # fmt: skip
    middle = np.angle(np.nanmean(np.exp(1j * turns), axis=0))
    away = np.angle(np.exp(1j * (turns - middle)))
    parts = [_spread(column) for column in away.T]
    return tuple(Uncertain(float((m + one.value) % (2 * np.pi)), one.u) for m, one in zip(middle, parts, strict=True))


def _spread(values: Floats) -> Uncertain:
    """Return mean and standard uncertainty by the parameters: both runs of a draw share them, not their scatter."""
    pairs = values.reshape(2, -1)
    fair = np.isfinite(pairs).all(axis=0)
    if np.count_nonzero(fair) < 3:
        whole = values[np.isfinite(values)]
        return Uncertain(float(whole.mean()), float(whole.std())) if len(whole) else Uncertain(np.nan, np.nan)
    one, other = pairs[:, fair]
    scatter = float(np.mean((one - other) ** 2)) / 2
    middle = 0.5 * (one + other)
    between = max(float(np.var(middle, ddof=1)) - scatter / 2, 0.0)
    return Uncertain(float(middle.mean()), float(np.sqrt(between + scatter / (2 * len(middle)))))


def _mean_of(cycles: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    whole = [one for one in cycles if np.isfinite(one[0]).all()]
    if not whole:
        return np.zeros(0), np.zeros(0)
    return np.mean([one[0] for one in whole], axis=0), np.mean([one[1] for one in whole], axis=0)


def reshaped(pattern: Pattern, found: Slots) -> Floats:
    """Return the mean phase in each place of a pattern [rad]."""
    return np.angle(np.mean(np.exp(1j * found.phase / pattern.p), axis=0)) % (2 * np.pi) * pattern.p
