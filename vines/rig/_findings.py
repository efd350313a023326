"""Gates and checks of a reconstruction: is it good enough, and do the data contradict themselves?"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.rig._forcing import Base, Tuning
from vines.rig._momentum import MomentumFit
from vines.rig._oscillator import Response
from vines.rig._reconstruction import Finding
from vines.rig._recording import Recording, Uncertain
from vines.rig._restitution import Restitution

__all__ = ["MOST_RESIDUAL", "MOST_SUSPECT", "U_JUMP", "judge"]

MOST_RESIDUAL = 1e-3
"""Most that the fit may leave beyond noise, relative to the rms of the motion: a missed impact leaves more."""

MOST_SUSPECT = 0.05
"""Largest fraction of impacts whose momentum does not add up."""

U_JUMP = 6e-3
"""Relative standard uncertainty of velocity jumps by the linearity of a displacement sensor: differences of slopes."""

_FAR = 4.5
"""Standard deviations beyond which two measurements of one number contradict each other."""


def judge(
    recording: Recording,
    base: Base,
    response: Response,
    tuning: Tuning,
    alone: MomentumFit,
    joint: MomentumFit,
    mu: float,
    gauge: Uncertain,
    found: Restitution,
    usable: npt.NDArray[np.bool_],
) -> tuple[Finding, ...]:
    """Return what every gate and check finds.

    Parameters
    ----------
    recording, base, response, tuning, alone, joint
        What was reconstructed; `alone` finds mu by momentum only.
    mu : float
        Weighed.
    gauge : Uncertain
        Half length by gauge, contact included [m].
    found : Restitution
    usable : ndarray of bool
        Whether restitution was taken from an impact, of those that could give it: with a flight of some milliseconds
        on either side.
    """
    run, fit = recording.run, response.fit
    motion = float(np.std(response.bins.mean))
    excess = float(np.sqrt(max(fit.residual**2 - fit.noise**2, 0.0))) / motion
    suspect = 1 - float(np.mean(usable)) if len(usable) else 1.0
    findings = [
        Finding(
            "residual", excess <= MOST_RESIDUAL,
            f"the fit leaves {excess:.2g} of the motion beyond noise, allowed is {MOST_RESIDUAL:g}: impacts are "
            "missing or the channel is distorted",
        ),
        Finding(
            "suspect_impacts", suspect <= MOST_SUSPECT,
            f"{suspect:.1%} of the impacts don't keep momentum, allowed are {MOST_SUSPECT:.0%}",
        ),
        Finding(
            "forcing", tuning.misfit <= _FAR,
            f"the response asks for {abs(tuning.ratio):.3f} times the measured base motion, turned by "
            f"{np.degrees(np.angle(tuning.ratio)):.1f} degrees, {tuning.misfit:.1f} standard deviations off: a sign, "
            "unit or clock of base or oscillator is wrong, or omega0 is",
            fault=True,
        ),
        _mass(alone, mu, response.channel.u_gain),
        _gauge(joint, gauge.value, gauge.u),
        Finding(
            "restitution", 0.0 < found.r < 1.0,
            f"the mean restitution is {found.r:.3f}, possible is 0 to 1: a sign or unit is wrong, or impacts are "
            "missing",
            fault=True,
        ),
    ]  # fmt: skip
    if response.gain is not None:
        apart = abs(response.gain - 1)
        allowed = 0.02 + 3 * float(np.hypot(response.channel.u_gain, _u_gain(recording, "lo_acc")))
        findings.append(
            Finding(
                "oscillator_sensors", apart <= allowed,
                f"accelerometer and displacement of the oscillator differ by {apart:.3g} of the motion, allowed is "
                f"{allowed:.2g}: a sign, unit or clock of one of them is wrong",
                fault=True,
            )
        )  # fmt: skip
        slow = response.drift
        findings.append(
            Finding(
                "oscillator_clocks", abs(slow) <= 6.0,
                f"the delay between accelerometer and displacement changes over the record by {abs(slow):.1f} standard "
                "deviations: their clocks drift apart",
                fault=True,
            )
        )  # fmt: skip
    if base.other is not None:
        spread = float(np.hypot(base.E.u, base.other.u))
        apart = abs(base.E.value - base.other.value)
        findings.append(
            Finding(
                "base_sensors", apart <= _FAR * spread,
                f"displacement and acceleration of the base give E = {base.E.value:.4g} and {base.other.value:.4g} m: "
                "a unit or sensitivity is wrong",
                fault=True,
            )
        )  # fmt: skip
    if run.f_cmd is not None:
        apart = abs(base.f.value / run.f_cmd - 1)
        findings.append(
            Finding(
                "frequency", apart <= 1e-3,
                f"the base moves at {base.f.value:.6g} Hz, commanded were {run.f_cmd:.6g} Hz: a sampling rate is wrong",
                fault=True,
            )
        )  # fmt: skip
    return tuple(findings)


def _u_gain(recording: Recording, role: str) -> float:
    channel = recording.role(role)
    return channel.u_gain if channel is not None else 0.0


def _mass(alone: MomentumFit, mu: float, u_gain: float) -> Finding:
    u = float(np.hypot(alone.mu.u, alone.mu.value * np.hypot(u_gain, U_JUMP)))
    far = abs(alone.mu.value - mu) / u
    return Finding(
        "mass_ratio",
        far <= _FAR,
        f"momentum gives mu = {alone.mu.value:.5g}, weighing {mu:.5g}, {far:.1f} standard deviations apart: a unit is "
        "wrong, or impacts are missing",
        fault=True,
    )


def _gauge(joint: MomentumFit, b: float, u: float) -> Finding:
    far = abs(joint.b.value - b) / u
    return Finding(
        "cavity",
        far <= _FAR,
        f"momentum asks for b = {1e3 * joint.b.value:.4g} mm, the gauge says {1e3 * b:.4g} mm, {far:.1f} standard "
        "deviations apart: a unit is wrong, or the cavity is not the one described",
        fault=True,
    )
