"""Uncertainty budgets: what each source adds to the standard uncertainty of a quantity (GUM, first order)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vines.rig.ball import Rebounds
from vines.rig.quantities._forcing import Base, Tuning
from vines.rig.recording import RunInfo, Uncertain

__all__ = ["SOURCES", "length_parts", "quotient", "source_values", "tuned"]

SOURCES = {
    "scatter": ("1", "The motion itself: its periods differ (Type A); the number is that of r"),
    "mass_oscillator": ("kg", "Mass of the oscillator"),
    "mass_ball": ("kg", "Mass of the ball"),
    "gauge": ("m", "Half length of the cavity by gauge"),
    "base_sensor": ("1", "Calibration of the base's sensor, relative"),
    "lo_sensor": ("1", "Calibration of the oscillator's sensor, relative"),
    "linearity": ("1", "Linearity of the oscillator's sensor, relative"),
    "delay": ("s", "Alignment of clocks and delays"),
    "ring_down": ("rad/s", "omega0 by ring-downs, brought to the run's temperature"),
    "damping": ("1", "Damping by ring-downs"),
    "friction": ("m/s^2", "Friction of the ball"),
    "cavity": ("1", "What momentum leaves open of cavity, tilt and contact; the number is that of r"),
    "noise": (
        "1",
        "Noise of the forced response and what else acts on the oscillator; the number is that of omega0",
    ),
    "correction": ("1", "Other parts that were found from the run itself; the number is that of b, relative"),
}
"""Sources of uncertainty with the unit of their own number and what they are."""


def source_values(
    run: RunInfo, base: Base, ball: Rebounds, natural: tuple[Uncertain, Uncertain], u_delay: float, linearity: float
) -> dict[str, float]:
    """Return the standard uncertainty of each source that is stated or measured by itself."""
    return {
        "mass_oscillator": run.M.u,
        "mass_ball": run.m.u,
        "gauge": run.b.u,
        "base_sensor": base.channel.u_gain,
        "lo_sensor": ball.u_gain,
        "linearity": linearity,
        "delay": u_delay,
        "ring_down": natural[0].u,
        "damping": natural[1].u,
        "friction": ball.joint.friction.u,
    }


def length_parts(ball: Rebounds) -> dict[str, float]:
    """Return what makes the uncertainty of b, gauged and by momentum together [m].

    As in :meth:`Rebounds.calibrated`: of what the sensor sees beside the gauge each takes its share.
    """
    seen, gauge = ball.length(), ball.gauge
    u_b = gauge.u / gauge.value
    share = float(u_b / np.hypot(u_b, ball.u_gain)) ** 2
    b = ball.calibrated()[0].value
    return {
        "gauge": b * (1 - share) * u_b,
        "lo_sensor": b * share * ball.u_gain,
        "correction": b * share * seen.u / seen.value,
    }


def quotient(
    value: float, above: tuple[float, Mapping[str, float]], below: tuple[float, Mapping[str, float]]
) -> dict[str, float]:
    """Return the budget of a quotient from value and budget of what is above and below.

    Examples
    --------
    >>> quotient(0.5, (1.0, {"a": 0.03}), (2.0, {"a": 0.08, "b": 0.2}))
    {'a': 0.025, 'b': 0.05}
    """
    parts: dict[str, float] = {}
    for size, budget in (above, below):
        for source, u in budget.items():
            parts[source] = round(float(np.hypot(parts.get(source, 0.0), abs(value / size) * u)), 18)
    return parts


def tuned(tuning: Tuning, name: str) -> dict[str, float]:
    """Return the budget of omega0 or E after the forced response."""
    value = getattr(tuning, name).value
    return {source: float(value * part) for source, part in tuning.parts[name].items()}
