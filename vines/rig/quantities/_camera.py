"""The ball's own sensor in a reconstruction: quantities of its own, and checks of what was inferred."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vines.rig.camera import Sight, Witness, witness
from vines.rig.quantities._reconstruction import Finding, Reconstruction
from vines.rig.recording import Uncertain
from vines.rig.uncertainty import error_ratio

__all__ = ["with_camera"]

MOST_ALONE = 0.05
"""Largest part of the impacts that one of the two may show alone."""

_FAR = 4.5
"""Standard deviations beyond which two measurements of one number contradict each other."""

_PACE = 3e-4
"""Relative error of a sample clock that quartz does not have."""


def with_camera(found: Reconstruction, sight: Sight, gauge: Uncertain) -> Reconstruction:
    """Return a reconstruction with what the ball's own sensor measures, and checks of it.

    Parameters
    ----------
    found : Reconstruction
    sight : Sight
        Of the same run.
    gauge : Uncertain
        Half length of the cavity by gauge, contact included [m].
    """
    name, seen = sight.channel.name, sight.flights
    alignment = sight.alignment
    if alignment is None:
        text = f"{name} shows {len(seen)} impacts, too few to check anything: was the ball in sight?"
        return replace(found, findings=(*found.findings, Finding("camera", True, text)))
    like = Finding(
        "camera", alignment.fits,
        f"the turns of the ball in {name} and the pushes on the oscillator have a correlation of {alignment.like:.2f}: "
        "it follows something else, or its clock does not run evenly",
        fault=True,
    )  # fmt: skip
    beside = witness(sight, found.impacts, gauge) if alignment.fits else None
    if beside is None:
        return replace(found, findings=(*found.findings, like))
    quantities = {
        **found.quantities,
        "b_camera": beside.b,
        "camera_scale": beside.scale,
        "camera_lag": Uncertain(alignment.lag, alignment.u),
    }
    if beside.r is not None:
        quantities["r_camera"] = beside.r
    return replace(
        found, quantities=quantities, findings=(*found.findings, like, *_checks(found, sight, beside, gauge))
    )


def _checks(found: Reconstruction, sight: Sight, beside: Witness, gauge: Uncertain) -> Iterator[Finding]:
    name, alignment = sight.channel.name, sight.alignment
    assert alignment is not None
    unsure = "" if alignment.told else "; impacts are too much alike to tell this from half a period later"
    yield Finding(
        "camera_sign", alignment.sign > 0,
        f"the ball turns {'away from' if alignment.sign > 0 else 'towards'} the wall that it pushes{unsure}: the sign "
        f"of {name} is wrong, or the signs of base and oscillator both are, and left and right walls are swapped",
        fault=True,
    )  # fmt: skip
    pace = alignment.pace - 1
    yield Finding(
        "camera_clock", abs(pace) <= _PACE,
        f"the clock of {name} runs {1e6 * pace:+.0f} ppm off and begins {1e3 * alignment.lag:.3f} ms late, impacts "
        f"differ by {1e6 * beside.away:.0f} us rms: allowed are {1e6 * _PACE:.0f} ppm, its rate fs is wrong",
    )  # fmt: skip
    u = float(np.hypot(sight.channel.u_gain, beside.scale.u))
    far = abs(beside.scale.value - 1) / u
    yield Finding(
        "camera_scale", far <= _FAR,
        f"{name} sees walls for which b is {1e3 * beside.b.value:.4g} mm, the gauge says {1e3 * gauge.value:.4g} mm, "
        f"{far:.1f} standard deviations apart: its scale is off by a factor of {beside.scale.value:.4g} (unit or "
        "sensitivity), or the cavity is not the one described",
        fault=True,
    )  # fmt: skip
    total = beside.shared + beside.camera_only + beside.oscillator_only
    lent = int(np.count_nonzero(found.impacts["by_camera"]))
    yield Finding(
        "camera_impacts", beside.oscillator_only <= MOST_ALONE * total,
        f"{beside.shared} impacts are shown by both, {beside.camera_only} by {name} alone ({lent} taken over), "
        f"{beside.oscillator_only} by the oscillator alone: allowed of the last are {MOST_ALONE:.0%}, impacts were "
        "found that are none, or the ball was not followed",
    )  # fmt: skip
    # With a wrong scale the velocities are wrong, which has been said.
    if beside.r is not None and beside.beside is not None and far <= _FAR:
        own = Uncertain(beside.beside.value, float(np.hypot(beside.beside.u, found.quantities["r"].u)))
        apart = error_ratio(own, Uncertain(beside.r.value, 0.0))
        yield Finding(
            "camera_restitution", apart <= 1,
            f"velocities of {name} give r = {beside.r.value:.4f}, the oscillator {own.value:.4f} of the same impacts, "
            f"E_n = {apart:.2f}: one of them is wrong",
        )  # fmt: skip
