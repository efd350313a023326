"""Gates and checks of a reconstruction: is it good enough, and do the data contradict themselves?"""

from __future__ import annotations

import numpy as np

from vines.rig.ball import MomentumFit, Rebounds
from vines.rig.impacts import Response
from vines.rig.quantities._forcing import Base, Tuning
from vines.rig.quantities._reconstruction import Finding
from vines.rig.recording import Recording, Uncertain

__all__ = ["MOST_RESIDUAL", "MOST_SILENT", "MOST_SUSPECT", "judge"]

MOST_RESIDUAL = 1e-3
"""Most that the fit may leave beyond noise, relative to the rms of the motion: a missed impact leaves more."""

MOST_SUSPECT = 0.05
"""Largest fraction of impacts that contradict the rest."""

MOST_SILENT = 0.5
"""Largest fraction of impacts that are too soft to tell a restitution: a mean over fewer is no mean of the run."""

_JUMPS = 6e-3
"""How far momentum may be off by soft impacts and a sensor's linearity, relative: no contradiction yet."""

_FAR = 4.5
"""Standard deviations beyond which two measurements of one number contradict each other."""


def judge(
    recording: Recording,
    base: Base,
    response: Response,
    tuning: Tuning,
    ball: Rebounds,
) -> tuple[Finding, ...]:
    """Return what every gate and check finds.

    Parameters
    ----------
    recording, base, response, tuning, ball
        What was reconstructed.
    """
    run, fit = recording.run, response.fit
    motion = float(np.std(response.bins.mean))
    excess = float(np.sqrt(max(fit.residual**2 - fit.noise**2, 0.0))) / motion
    long = ball.long
    suspect = float(np.mean(ball.contradicts[long])) if long.any() else 1.0
    silent = 1 - float(np.mean(ball.measured[long])) if long.any() else 1.0
    findings = [
        Finding(
            "residual", excess <= MOST_RESIDUAL,
            f"the fit leaves {excess:.2g} of the motion beyond noise, allowed is {MOST_RESIDUAL:g}: impacts are "
            "missing or the channel is distorted",
        ),
        Finding(
            "suspect_impacts", suspect <= MOST_SUSPECT,
            f"{suspect:.1%} of the impacts contradict momentum or the common restitution, allowed are "
            f"{MOST_SUSPECT:.0%}: impacts are missing or false",
        ),
        Finding(
            "silent_impacts", silent <= MOST_SILENT,
            f"{silent:.1%} of the impacts give no restitution, allowed are {MOST_SILENT:.0%}: they are too soft for "
            "the noise, or chatter",
        ),
        Finding(
            "forcing", tuning.misfit <= _FAR,
            f"the response asks for {abs(tuning.ratio):.3f} times the measured base motion, turned by "
            f"{np.degrees(np.angle(tuning.ratio)):.1f} degrees, {tuning.misfit:.1f} standard deviations off: a sign, "
            "unit or clock of base or oscillator is wrong, or omega0 is",
            fault=True,
        ),
        _mass(ball.alone, ball.weighed.value),
        _gauge(ball.length(), ball.gauge, ball.u_gain),
        Finding(
            "restitution", 0.0 < ball.law.r < 1.0,
            f"the restitution is {ball.law.r:.3f}, possible is 0 to 1: a sign or unit is wrong, or impacts are "
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


def _mass(alone: MomentumFit, mu: float) -> Finding:
    u = float(np.hypot(alone.mu.u, alone.mu.value * _JUMPS))
    far = abs(alone.mu.value - mu) / u
    return Finding(
        "mass_ratio",
        far <= _FAR,
        f"momentum gives mu = {alone.mu.value:.5g}, weighing {mu:.5g}, {far:.1f} standard deviations apart: a unit is "
        "wrong, or impacts are missing",
        fault=True,
    )


def _gauge(found: Uncertain, gauge: Uncertain, u_gain: float) -> Finding:
    far = abs(found.value - gauge.value) / float(np.hypot(gauge.u, u_gain * gauge.value))
    return Finding(
        "cavity",
        far <= _FAR,
        f"momentum asks for b = {1e3 * found.value:.4g} mm, the gauge says {1e3 * gauge.value:.4g} mm, {far:.1f} "
        "standard deviations apart: a unit is wrong, or the cavity is not the one described",
        fault=True,
    )
