"""A run of a rig in memory: what was measured, in SI units, and what the run folder says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["ROLES", "Recording", "RunInfo", "Sampled", "Uncertain"]

ROLES = {
    "base_disp": ("displacement", "m"),
    "base_acc": ("acceleration", "m/s^2"),
    "lo_disp": ("displacement", "m"),
    "lo_acc": ("acceleration", "m/s^2"),
    "base_vel": ("velocity", "m/s"),
    "lo_vel": ("velocity", "m/s"),
    "ball_cam": ("displacement", "m"),
    "stinger_force": ("force", "N"),
    "temperature": ("temperature", "degC"),
    "sound": ("pressure", "Pa"),
}
"""What a channel may measure, with its quantity and SI unit. Positive is to the right, the direction of x1.

Temperature is that of the springs, the stinger's force that of the shaker on the base, sound that of a microphone.
"""


@dataclass(frozen=True, slots=True)
class Uncertain:
    """A measured number with its standard uncertainty (GUM), in one unit.

    Attributes
    ----------
    value, u : float
        The number and its standard uncertainty (coverage factor 1).
    """

    value: float
    u: float


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """One channel: evenly spaced samples on its own clock, aligned to that of the run.

    Attributes
    ----------
    name, role : str
        Name in ``channels.tsv``; one of `ROLES`.
    rate : float
        Samples a second on the clock of the run [Hz].
    start : float
        Time of the first sample on the clock of the run [s], corrected for offset and group delay.
    values : ndarray of float64, shape (n,)
        In the SI unit of the role, positive to the right.
    valid : ndarray of bool, shape (n,)
        False where a sample was clipped or dropped out.
    u_gain : float
        Relative standard uncertainty of the calibration (GUM Type B).
    u_time : float
        Standard uncertainty of the alignment [s].
    about : mapping of str to str
        Sensor, serial number, sensitivity, file, field and the like, for the log.
    u_high_pass : float
        Standard uncertainty of the corner of the high-pass that was undone [Hz].
    """

    name: str
    role: str
    rate: float
    start: float
    values: npt.NDArray[np.float64]
    valid: npt.NDArray[np.bool_]
    u_gain: float = 0.0
    u_time: float = 0.0
    about: Mapping[str, str] = field(default_factory=dict)
    u_high_pass: float = 0.0

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """Times of the samples on the clock of the run [s]."""
        return self.start + np.arange(len(self.values)) / self.rate

    @property
    def where(self) -> str:
        """How messages call it: its name, with file and field where they are known."""
        file = self.about.get("file")
        return f"{self.name} (raw/{file}, {self.about['field']})" if file else self.name


@dataclass(frozen=True, slots=True)
class RunInfo:
    """What ``run.json`` says of a run; SI units.

    Attributes
    ----------
    run_id : str
        Name of the run.
    start_utc : str
        ISO 8601.
    protocol : str
        ``dwell``, ``sweep_up``, ``sweep_down`` or ``ringdown``.
    f_cmd, E_cmd : float or None
        Commanded frequency [Hz] and base amplitude [m]; never used in place of what was measured.
    settle : float
        Seconds that were let pass before the recording.
    M, m, b : Uncertain
        Mass of the oscillator and of the ball [kg], half length of the cavity less the ball's radius [m].
    ball : bool
        Whether the ball was in the cavity.
    temperature : tuple of float
        Before and after the run [deg C].
    ringdown : tuple of str
        Runs that give omega0 and lam.
    more : mapping
        Everything else, unchanged.
    """

    run_id: str
    start_utc: str
    protocol: str
    f_cmd: float | None
    E_cmd: float | None
    settle: float
    M: Uncertain
    m: Uncertain
    b: Uncertain
    ball: bool
    temperature: tuple[float, float]
    ringdown: tuple[str, ...] = ()
    more: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """A run of a rig: its description and its channels by name.

    Attributes
    ----------
    run : RunInfo
        What the run folder says.
    channels : mapping of str to Sampled
        By name, in the order of ``channels.tsv``.
    sha256 : str
        Of all raw files together, so that what follows from them can say where it comes from.
    """

    run: RunInfo
    channels: Mapping[str, Sampled]
    sha256: str

    def role(self, *roles: str) -> Sampled | None:
        """Return the first channel that has one of the roles, in their order; ``None`` if there is none."""
        for role in roles:
            for channel in self.channels.values():
                if channel.role == role:
                    return channel
        return None
