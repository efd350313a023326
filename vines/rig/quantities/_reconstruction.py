"""What is known of a run after it has been reconstructed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from vines.rig.quantities._cycle import Slots, Track
from vines.rig.quantities._pattern import Pattern, Periods
from vines.rig.recording import RunInfo, Uncertain

__all__ = ["IMPACT", "NOTED", "QUANTITIES", "Finding", "Reconstruction"]

QUANTITIES = {
    "f": ("Hz", "Frequency of the base"),
    "E": ("m", "Amplitude of the base"),
    "phase": ("rad", "phi of e = E sin(omega t + phi) on the run's clock"),
    "omega0": ("rad/s", "Natural frequency at the run's temperature"),
    "lam": ("1", "Damping c/(M omega0)"),
    "Omega": ("1", "Frequency ratio omega/omega0"),
    "A": ("1", "Forcing amplitude E/b"),
    "mu": ("1", "Mass ratio, weighed"),
    "mu_momentum": ("1", "Mass ratio by momentum alone, with b by gauge"),
    "b": ("m", "Half length for instantaneous impacts (contact included), gauged and by momentum together"),
    "friction": ("m/s^2", "Deceleration of the ball against the cavity"),
    "tilt": ("m/s^2", "Acceleration of the ball along the cavity"),
    "r": ("1", "Coefficient of restitution: mean |w'| after impact over mean |w'| before"),
    "r_mean": ("1", "Mean of the restitution of all impacts, soft ones by the law r ~ |w'|^e"),
    "r_effective": (
        "1",
        "Restitution at the mean |w'|, between mean velocities of flights: for a model without friction",
    ),
    "r_exponent": ("1", "Exponent e of r ~ |w'|^e"),
    "sigma_r": ("1", "Standard deviation of the restitution from impact to impact"),
    "impacts_per_period": ("1/T", "Impacts in a forcing period"),
    "max_abs_x1": ("1", "Mean over periods of the largest |x1|, in units of b"),
    "kinetic_ratio": ("1", "K2/K1 = mu <v2^2>/<v1^2>"),
    "impact_phase": ("rad", "Phase of the forcing at the first impact of the pattern"),
    "w_before": ("m/s", "Mean |w'| before impact"),
    "w_after": ("m/s", "Mean |w'| after impact"),
    "drift_E": ("1", "Relative change of the base amplitude over the record"),
    "drift_f": ("1", "Relative change of the forcing frequency over the record"),
    "drift_r": ("1", "Change of the restitution over the record"),
    "drift_omega0": ("1", "Relative change of the natural frequency over the record"),
    "r_camera": ("1", "Restitution by the velocities of the ball that its own sensor (ball_cam) shows"),
    "b_camera": ("m", "Half length of the cavity by the ball's own sensor"),
    "camera_scale": ("1", "A length by the ball's own sensor over what it is by the gauge of the cavity"),
    "camera_lag": ("s", "What is added to times of the ball's own sensor at the start of the run's clock"),
}
"""Reconstructed quantities with unit and meaning."""

IMPACT = np.dtype(
    [(n, "f8") for n in ("t", "side", "x1", "v1", "v1_after", "x2", "v2", "v2_after", "w_dot", "w_dot_after")]
    + [
        ("r", "f8"),
        ("u_r", "f8"),
        ("u_t", "f8"),
        ("phase", "f8"),
        ("period", "i8"),
        ("suspect", "?"),
        ("bridged", "?"),
        ("by_camera", "?"),
    ]
)
"""A reconstructed impact, SI; nan where a flight on one side of it is not in the record."""

NOTED = ("hum", "frame_modes", "lost_signal")
"""Findings that a run may pass and that have to be known."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A check or gate that the run passed or not.

    Attributes
    ----------
    name : str
    passed : bool
    text : str
        What was found, in one line.
    fault : bool
        Whether failing it means that the data contradict themselves (sign, unit, clock), not only that they are poor.
    """

    name: str
    passed: bool
    text: str
    fault: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Reconstruction:
    """A run brought to the quantities of the model.

    Attributes
    ----------
    run : RunInfo
    sha256 : str
        Of the raw files.
    quantities : mapping of str to Uncertain
        See `QUANTITIES`; one that cannot be known is not there.
    pattern : Pattern
    periods : Periods
    slots : Slots or None
        Phases in each place of the pattern.
    impacts : structured ndarray, dtype IMPACT
    track : Track
        Motion in SI units.
    residual, noise : float
        Root mean square of what the fit leaves, and of the channel's noise, as block means [m]; those of an
        acceleration are divided by omega0^2.
    pruned : int
        Pulses that were no impacts.
    findings : tuple of Finding
        Gates and checks.
    base_harmonics : ndarray of complex, shape (N,)
        e_1 … e_N [m].
    budget : mapping of str to mapping of str to float
        What each source (`SOURCES`) adds to the standard uncertainty of a quantity, in its unit.
    sources : mapping of str to float
        Standard uncertainty of each source itself, in its unit.
    """

    run: RunInfo
    sha256: str
    quantities: Mapping[str, Uncertain]
    pattern: Pattern
    periods: Periods
    slots: Slots | None
    impacts: npt.NDArray[np.void] = field(repr=False)
    track: Track = field(repr=False)
    residual: float
    noise: float
    pruned: int
    findings: tuple[Finding, ...]
    base_harmonics: npt.NDArray[np.complex128] = field(repr=False)
    budget: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    sources: Mapping[str, float] = field(default_factory=dict)

    @property
    def accepted(self) -> bool:
        """Whether every gate and check was passed."""
        return all(finding.passed for finding in self.findings)

    @property
    def reasons(self) -> str:
        """Why it was not accepted, in one line; empty if it was."""
        return "; ".join(finding.text for finding in self.findings if not finding.passed)
