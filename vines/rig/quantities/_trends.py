"""Whether a run was one state: what changes over the record, told before causes are guessed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.special import stdtrit

from vines.errors import RigError
from vines.rig.ball import Rebounds
from vines.rig.fit import JumpModel, Train, bins_of, forced_response
from vines.rig.impacts import Response
from vines.rig.quantities._dwells import Dwell, dwells, envelope
from vines.rig.quantities._forcing import Base, Tuning
from vines.rig.quantities._reconstruction import Finding
from vines.rig.quantities._ring_down import STIFFNESS_DRIFT
from vines.rig.recording import Recording, Uncertain
from vines.rig.uncertainty import block_length, block_variance

__all__ = ["FALSE_ALARM", "MATTERS", "BaseCourse", "base_course", "run_trends", "trend", "trend_findings"]

Floats = npt.NDArray[np.float64]

FALSE_ALARM = 1e-3
"""Chance to find a trend where there is none, of each quantity."""
_NORMAL = float(stdtrit(1e9, 1 - FALSE_ALARM / 2))
"""Standard uncertainties that a normal deviation passes by that chance."""

MATTERS = {"drift_E": 0.006, "drift_f": 1e-4, "drift_r": 0.02, "drift_omega0": 1e-4}
"""Changes over a record that move the model's max|x1| by a per cent from its begin to its end (docs/rig.md)."""

_ALIKE = 5e-4
"""Uncertainty of the change of omega0 at which it is not told from one of r: 2000 ppm shift r by .025."""

_NAMES = {
    "drift_E": ("amplitude of the base", "%", 100.0),
    "drift_f": ("frequency of the base", "ppm", 1e6),
    "drift_r": ("restitution", "", 1.0),
    "drift_omega0": ("natural frequency omega0", "ppm", 1e6),
}
_IMPACTS = 16
"""Impacts of a block in which omega0 is found, at least."""
_BLOCKS = 12
_FEWEST = 5


@dataclass(frozen=True, slots=True)
class BaseCourse:
    """How the base went over the record.

    Attributes
    ----------
    trends : mapping of str to Uncertain
        ``drift_E`` and ``drift_f``: relative change from the begin to the end, with its standard uncertainty.
    levels : tuple of Dwell
        Stretches of one amplitude.
    steady : bool
        Whether one such stretch is all of the record.
    """

    trends: Mapping[str, Uncertain]
    levels: tuple[Dwell, ...]
    steady: bool


def trend(t: Floats, values: Floats) -> Uncertain:
    """Return the change of a series from its begin to its end by a straight line, with its standard uncertainty.

    Parameters
    ----------
    t, values : ndarray, shape (n,)

    Notes
    -----
    The slope is a mean of the residuals times their distance from the middle; its uncertainty is that of the circular
    block bootstrap of these, so that neighbours may be alike.

    Examples
    --------
    >>> noise = np.random.default_rng(1).normal(size=400)
    >>> found = trend(np.arange(400.0), 0.01 * np.arange(400.0) + noise)
    >>> round(found.value, 1), round(found.u, 2)
    (4.0, 0.13)
    """
    away = t - t.mean()
    spread = float(np.sum(away**2))
    slope = float(np.sum(away * values) / spread)
    left = values - values.mean() - slope * away
    span = float(t[-1] - t[0])
    # What neighbours share is read from the residuals, too.
    parts = len(t) * away * left / spread
    length = max(block_length(left), block_length(parts))
    freedom = max(1.5 * len(t) / length - 1.5, 2.0)
    return Uncertain(slope * span, float(np.sqrt(block_variance(parts, length))) * span * _student(freedom))


def _student(freedom: float) -> float:
    """Return Student's factor at the chance that is stated, so that the normal one holds for all trends."""
    return float(stdtrit(freedom, 1 - FALSE_ALARM / 2)) / _NORMAL


def base_course(base: Base) -> BaseCourse:
    """Return how amplitude and frequency of the base go over the record."""
    shape = envelope(bins_of(base.channel), base.f.value)
    size = np.abs(shape.size)
    levels = dwells(shape)
    whole = float(shape.t[-1] - shape.t[0])
    steady = len(levels) == 1 and levels[0].end - levels[0].begin > 0.95 * whole
    if len(size) < 16:
        return BaseCourse({}, levels, True)
    # Its phase goes on by the integral of what the frequency is off.
    phase = np.unwrap(np.angle(shape.size))
    pace = np.diff(phase) / np.diff(shape.t) / (2 * np.pi * base.f.value)
    return BaseCourse(
        {"drift_E": trend(shape.t, size / size.mean()), "drift_f": trend(0.5 * (shape.t[1:] + shape.t[:-1]), pace)},
        levels,
        steady,
    )


def run_trends(
    base: Base, response: Response, tuning: Tuning, ball: Rebounds, model: JumpModel
) -> dict[str, Uncertain]:
    """Return the changes of restitution and natural frequency over the record.

    Parameters
    ----------
    base, response, tuning, ball
        What was reconstructed.
    model : JumpModel
        That fitted the response.
    """
    found: dict[str, Uncertain] = {}
    told = np.flatnonzero(ball.counted & ball.measured)
    if len(told) >= 32:
        found["drift_r"] = trend(ball.jumps.t[1:-1][told], ball.motion.r[told])
    by_omega0 = _natural(base, response, tuning, model)
    if by_omega0 is not None:
        found["drift_omega0"] = by_omega0
    return found


def _natural(base: Base, response: Response, tuning: Tuning, model: JumpModel) -> Uncertain | None:
    """Return the relative change of omega0 over the record, by what parts of it ask of the base.

    Between impacts the oscillator asks for a base motion that depends on omega0 as strongly as its response does; parts
    of the record ask for it one by one, and what the base did in each is measured.
    """
    fit, bins = response.fit, response.bins
    count = min(_BLOCKS, len(fit.jumps.t) // _IMPACTS)
    slope = tuning.by_omega0
    if count < _FEWEST or not abs(slope) > 0:
        return None
    own = envelope(bins_of(base.channel), base.f.value)
    scale = base.e[0] / base.fit.harmonics[0]
    at = np.linspace(float(bins.t[0]), float(bins.t[-1]), count + 1)
    times, asked = [], []
    for low, high in pairwise(at.tolist()):
        use = (bins.t >= low) & (bins.t <= high)
        if np.count_nonzero(use) < 64:
            continue
        part = type(bins)(bins.t[use], bins.mean[use], bins.width, bins.smooth)
        train = Train.alike(fit.motion.starts[1:], fit.jumps.dv, 2e-5).between(low + 3e-3, high - 3e-3)
        here = (own.t + response.late >= low) & (own.t + response.late <= high)
        if len(train) < 4 or np.count_nonzero(here) < 3:
            continue
        try:
            found = type(model)(part, model.s, model.omega, model.order, model.forced).fit(train, draws=0)
        except RigError:
            continue
        e = complex(np.mean(own.size[here])) * scale
        turn = np.exp(1j * model.omega * response.late)
        times.append(0.5 * (low + high))
        asked.append(complex(found.motion.c[0] / forced_response(1.0, model.omega, model.s)) * turn / e)
    if len(times) < _FEWEST:
        return None
    t, ratio = np.array(times), np.array(asked)
    # What is asked for moves by -slope a relative change of omega0; across that direction it says nothing of it.
    change = -np.real((ratio - ratio.mean()) * np.conj(slope)) / abs(slope) ** 2
    away = t - t.mean()
    steep = float(np.sum(away * change) / np.sum(away**2))
    left = change - steep * away
    span = float(bins.t[-1] - bins.t[0])
    freedom = len(t) - 2
    u = float(np.sqrt(np.sum(left**2) / freedom / np.sum(away**2))) * span
    return Uncertain(steep * span, u * _student(freedom))


def trend_findings(recording: Recording, course: BaseCourse, trends: Mapping[str, Uncertain]) -> tuple[Finding, ...]:
    """Return what a run's trends and levels say of it; what matters and is no chance is not passed.

    Parameters
    ----------
    recording : Recording
    course : BaseCourse
        Of the base.
    trends : mapping of str to Uncertain
        Changes over the record.
    """
    findings = []
    if len(course.levels) > 1:
        sizes = ", ".join(f"{level.size / course.levels[0].size:.3f}" for level in course.levels)
        findings.append(
            Finding(
                "levels",
                False,
                f"the base dwells at {len(course.levels)} levels, {sizes} times the first: 'vines rig split' makes a "
                "run of each",
            )
        )
    for name, found in trends.items():
        what, unit, scale = _NAMES[name]
        if name == "drift_E" and len(course.levels) > 1:
            continue
        passed = abs(found.value) <= MATTERS[name] or abs(found.value) <= _NORMAL * found.u
        cause = ""
        if name == "drift_omega0":
            cause = _warmed(recording, found)
        elif name == "drift_r" and _untold(trends):
            cause = "; omega0 that changes would look alike, and the impacts are too regular or too few to tell it"
        text = f"{scale * found.value:+.3g} {unit}".rstrip() + f" (u {scale * found.u:.2g})"
        findings.append(
            Finding(
                name,
                passed,
                f"the {what} changes by {text} over the record: the run is not one state{cause}",
            )
        )
    return tuple(findings)


def _untold(trends: Mapping[str, Uncertain]) -> bool:
    """Say whether a change of omega0 that would look like one of r that matters could go unseen."""
    seen = trends.get("drift_omega0")
    return seen is None or seen.u > _ALIKE


def _warmed(recording: Recording, found: Uncertain) -> str:
    """Say whether the springs' temperature, as stated or measured, explains a change of omega0."""
    before, after = recording.run.temperature
    channel = recording.role("temperature")
    if channel is not None and channel.valid.any():
        part = max(1, len(channel.values) // 10)
        before, after = float(np.mean(channel.values[:part])), float(np.mean(channel.values[-part:]))
    asked = STIFFNESS_DRIFT * (after - before)
    # What is stated may begin and end before and after the record.
    if asked * found.value > 0 and abs(found.value) < 1.5 * abs(asked) + 3 * found.u:
        return f"; the springs went from {before:.1f} to {after:.1f} degC, which asks for {1e6 * asked:+.3g} ppm"
    return f"; their temperature, {before:.1f} to {after:.1f} degC, does not explain it"
