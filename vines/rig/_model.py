"""The model with the measured scatter and uncertainties: an ensemble, looked at as the measured run was."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from vines.model import Params
from vines.rig._cycle import Slots, Track, matching, mean_cycle, slots
from vines.rig._match import Candidate
from vines.rig._motion import Motion
from vines.rig._pattern import Pattern, Periods, cut_into_periods
from vines.rig._reconstruction import Reconstruction
from vines.rig._recording import Uncertain

if TYPE_CHECKING:
    from vines.dynamics import Scatter

__all__ = ["Predicted", "measured_params", "parameter_draws", "predict"]

Floats = npt.NDArray[np.float64]

DRAWS = 48
SETTLE, RECORD = 240, 128
_LEAST = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Predicted:
    """What an ensemble about an attractor of the model shows.

    Attributes
    ----------
    candidate : Candidate
    fraction : Uncertain
        Fraction of periods with the measured pattern (mirrored, where the candidate is the mirror image): mean and
        standard deviation over the draws.
    holding : float
        Share of the draws in which it holds in 95 % of the periods.
    phases : tuple of Uncertain
        Impact phase in each place of the pattern [rad].
    max_abs_x1, kinetic_ratio : Uncertain
        Mean over periods of the largest |x1|; K2/K1.
    cycle : tuple of ndarray
        Mean w and w' over the repetitions, dimensionless.
    gaps : ndarray
        Times between impacts in forcing periods, of all draws.
    """

    candidate: Candidate
    fraction: Uncertain
    holding: float
    phases: tuple[Uncertain, ...]
    max_abs_x1: Uncertain
    kinetic_ratio: Uncertain
    cycle: tuple[Floats, Floats]
    gaps: Floats


def measured_params(run: Reconstruction) -> Params:
    """Return the measured parameters; r is that at the mean speed of impact."""
    q = run.quantities
    return Params(
        mu=q["mu"].value, A=q["A"].value, Omega=q["Omega"].value, r=min(max(q["r"].value, 0.0), 1.0), lam=q["lam"].value
    )


def parameter_draws(run: Reconstruction, p: Params, draws: int = DRAWS, seed: int = 0) -> dict[str, Floats]:
    """Return draws of the parameters about `p` with the measured uncertainties; the first is `p` itself."""
    rng = np.random.default_rng([seed, 5])
    found = {}
    for name in ("mu", "A", "Omega", "r", "lam"):
        values = getattr(p, name) + run.quantities[name].u * rng.normal(size=draws)
        values[0] = getattr(p, name)
        found[name] = np.clip(values, 1e-9, 1.0) if name == "r" else np.maximum(values, 1e-9)
    return found


def predict(run: Reconstruction, p: Params, candidate: Candidate, *, seed: int = 0) -> Predicted:
    """Run the model with scatter from the candidate's state and look at it as at the measured run.

    Parameters
    ----------
    run : Reconstruction
        Gives scatter, uncertainties, the harmonics of the base, the pattern and where its periods are cut.
    p : Params
        Parameters, measured or calibrated.
    candidate : Candidate
    seed : int
        Of the draws.
    """
    from vines.dynamics import ensemble

    table = parameter_draws(run, p, seed=seed)
    scatter, r0 = _scatter(run, p, seed)
    table["r"] = np.clip(table["r"] + r0, 1e-9, 1.0)
    start = {name: np.full(DRAWS, value) for name, value in candidate.start.items()}
    many = ensemble(table, start, settle=SETTLE, periods=RECORD, record="impacts", scatter=scatter, threads=1)
    impacts = many.impacts
    assert impacts is not None
    shown: list[_Shown] = []
    for k, own in enumerate(np.split(impacts, np.searchsorted(impacts["run"], np.arange(1, DRAWS)))):
        if len(own) > 8:
            values = Params(*(float(value) for value in many.parameters[k]))
            shown.append(_show(_track(own, values, scatter), values, run))
    if not shown:
        none = Uncertain(float("nan"), float("nan"))
        return Predicted(candidate, Uncertain(0.0, 0.0), 0.0, (), none, none, _nothing(), np.zeros(0))
    fractions = np.array([one.fraction for one in shown])
    with_it = [one for one in shown if one.phases is not None and one.fraction > 0.5]
    return Predicted(
        candidate,
        Uncertain(float(fractions.mean()), float(fractions.std())),
        float(np.mean(fractions >= 0.95)),
        _angles([one.phases for one in with_it if one.phases is not None]),
        _spread([one.largest for one in shown]),
        _spread([one.ratio for one in shown]),
        _mean_of([one.cycle for one in with_it]),
        np.concatenate([one.gaps for one in shown]),
    )


def _scatter(run: Reconstruction, p: Params, seed: int) -> tuple[Scatter, float]:
    """Return the scatter of an ensemble and what must be added to r where it falls with speed."""
    from vines.dynamics import Scatter

    q = run.quantities
    exponent = q["r_exponent"].value if np.isfinite(q["r_exponent"].u) and q["r_exponent"].u < 0.1 else 0.0
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
    fraction: float
    phases: Floats | None
    largest: float
    ratio: float
    cycle: tuple[Floats, Floats]
    gaps: Floats


def _track(impacts: npt.NDArray[np.void], p: Params, scatter: Scatter) -> Track:
    """Return simulated impacts as the motion between them, in closed form; dimensionless."""
    t = np.asarray(impacts["t"], float)
    keep = np.concatenate([[True], np.diff(t) > 1e-9])
    impacts, t = impacts[keep], t[keep]
    s = complex(-p.lam / 2, np.sqrt(1 - p.lam**2 / 4))
    phase0 = float(impacts["phase"][0]) - p.Omega * t[0]
    n = np.array([1.0, 2.0])
    size = p.A * np.array([1.0, scatter.second * np.exp(1j * scatter.second_phase)])
    damp = 1j * p.lam * n * p.Omega
    c = -1j * size * (1 + damp) / (1 - (n * p.Omega) ** 2 + damp) * np.exp(1j * n * phase0)
    motion = Motion(s, p.Omega, c, t, np.zeros(len(t), complex), float(t[-1]))
    x = impacts["x1"] - motion.forced(t)
    v = impacts["v1_after"] - motion.forced(t, 1)
    motion = replace(motion, z=x - 1j * (v - s.real * x) / s.imag)
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
    counts = [(w.count("L"), w.count("R")) for w in usual.word]
    seen = [(w.count("L"), w.count("R")) for w in periods.words]
    fraction = max(
        (np.mean([c == counts[(k + turn) % length] for k, c in enumerate(seen)]) for turn in range(length)), default=0.0
    ) if seen else 0.0  # fmt: skip
    found = slots(periods, usual, track.phase, track.side)
    phases = reshaped(usual, found) if found is not None else None
    begin = track.periods_begin(periods, matching(periods, usual.word)) if found is not None else np.zeros(0)
    cycle = mean_cycle(track, begin, 2 * np.pi * length / omega)
    return _Shown(
        float(fraction), phases, period_maximum(track.motion, track, periods), _kinetic_ratio(track, p.mu), cycle,
        np.diff(track.t) * omega / (2 * np.pi),
    )  # fmt: skip


def period_maximum(motion: Motion, track: Track, periods: Periods) -> float:
    """Return the mean over complete periods of the largest |x1|."""
    times, values = motion.peaks()
    edges = track.periods_begin(periods, np.arange(len(periods.words) + 1))
    number = np.searchsorted(edges, times, side="right") - 1
    inside = (number >= 0) & (number < len(periods.words))
    top = np.zeros(len(periods.words))
    np.maximum.at(top, number[inside], values[inside])
    return float(top[top > 0].mean()) if (top > 0).any() else float("nan")


def _angles(phases: list[Floats]) -> tuple[Uncertain, ...]:
    if not phases:
        return ()
    turns = np.array(phases)
    middle = np.angle(np.mean(np.exp(1j * turns), axis=0))
    away = np.angle(np.exp(1j * (turns - middle)))
    return tuple(Uncertain(float(m % (2 * np.pi)), float(u)) for m, u in zip(middle, away.std(axis=0), strict=True))


def _spread(values: list[float]) -> Uncertain:
    return Uncertain(float(np.mean(values)), float(np.std(values)))


def _mean_of(cycles: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    whole = [one for one in cycles if np.isfinite(one[0]).all()]
    if not whole:
        return _nothing()
    return np.mean([one[0] for one in whole], axis=0), np.mean([one[1] for one in whole], axis=0)


def _nothing() -> tuple[Floats, Floats]:
    return np.zeros(0), np.zeros(0)


def reshaped(pattern: Pattern, found: Slots) -> Floats:
    """Return the mean phase in each place of a measured pattern [rad]."""
    return np.angle(np.mean(np.exp(1j * found.phase / pattern.p), axis=0)) % (2 * np.pi) * pattern.p
