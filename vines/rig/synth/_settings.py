"""What a synthetic run is made of: the rig, its imperfections, its instruments and planted faults."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

import msgspec
import numpy as np

from vines.errors import ParameterError
from vines.rig.synth._ball_camera import BallCamera

__all__ = ["RigSettings", "draw_settings"]


class RigSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A synthetic run; SI units. What is not given is a good rig with the oscillator of Table 1 of the paper.

    Attributes
    ----------
    run_id, protocol, start_utc : str
        As in ``run.json``.
    ringdown : tuple of str
        The ring-downs that ``run.json`` names.
    ball : bool
        Whether the ball is in the cavity.
    E, f : float
        Commanded base amplitude [m] and frequency [Hz].
    duration, settle : float
        Length of the record and of the time before it [s].
    rate : float
        Nominal samples a second.
    start : tuple of float
        x1, v1, x2, v2 before `settle` [m, m/s].
    M, m, c, k, b, r : float
        True masses [kg], damping [N s/m], stiffness at 20 deg C [N/m], half length of the cavity [m], restitution at
        `r_speed`.
    sigma_r, r_exponent, r_speed : float
        Scatter of r; r falls as (speed/r_speed)^-r_exponent; r_speed [m/s].
    contact_time : float
        Duration of a contact at `r_speed` [s].
    friction, tilt : float
        Friction of the ball [g]; tilt of the cavity [deg], positive if it pulls to the right.
    asymmetry : float
        Left half length less right one [m].
    h2, h3, sag : float
        Second and third harmonic of the base relative to the first; part of E that the shaker does not reach.
    E_course, r_course : tuple of (time [s], value)
        What E is multiplied with and what is added to r at times from the first sample, straight between them and level
        beyond: ramps, dwells at several levels, wear. Empty for none.
    temperature : tuple of float
        At the start and the end of the record [deg C].
    softening : float
        Relative change of omega0 a kelvin.
    modes : tuple of (frequency [Hz], damping ratio, participation)
        Structural modes that ring in the oscillator's accelerometer after impacts.
    acc_noise, acc_gain, acc_high_pass, acc_cross_axis : float
        Accelerometers: noise [m/s^2 rms], relative error of the calibration, corner of the high-pass [Hz], cross-axis
        sensitivity.
    laser_noise, laser_linearity, laser_delay : float
        Laser on the oscillator: noise [m rms], linearity in parts of full scale, delay [s].
    enob : float
        Effective bits of the converter.
    ppm, ppm_second, offset_second, skew : float
        Error of the clocks [1e-6]; by how much the second recorder, which has the lasers, starts later [s]; delay from
        the first to the last channel of a recorder in samples, which the files state.
    recorders : int
        1, or 2 with a copy of the base accelerometer on the second.
    u_mass, u_b, u_temperature : float
        Relative standard uncertainty of the weighed masses; standard uncertainty of the gauged b [m] and of the
        temperature of the springs [K]. What ``run.json`` states is off by such a draw.
    missed, false : float
        Part of the impacts that the accelerometer does not see; knocks without an impact, in parts of their number.
    dropouts : float
        Dropouts of the laser a minute, of 2 ms each.
    channels : tuple of str
        Which of base_disp, base_acc, lo_disp, lo_acc are recorded.
    camera : BallCamera, optional
        One that follows the ball, with a file and a clock of its own.
    form : str
        Format of the raw files.
    fault : str
        What is wrong without being stated: ``sign`` or ``unit`` of `fault_channel`, or ``clock``: a gap of 12 ms in the
        first recorder.
    fault_channel : str
        Where.
    """

    run_id: str = "synthetic"
    protocol: Literal["dwell", "sweep_up", "sweep_down", "ringdown"] = "dwell"
    start_utc: str = "2026-01-05T09:00:00Z"
    ringdown: tuple[str, ...] = ()
    ball: bool = True
    E: float = 2.25e-4
    f: float = 8.815555
    duration: float = 60.0
    settle: float = 60.0
    rate: float = 51200.0
    start: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.08)
    M: float = 3.807
    m: float = 0.032
    c: float = 2.53
    k: float = 11680.0
    b: float = 0.015
    r: float = 0.65
    sigma_r: float = 0.01
    r_exponent: float = 0.0
    r_speed: float = 0.5
    contact_time: float = 1.2e-4
    friction: float = 0.0
    tilt: float = 0.0
    asymmetry: float = 0.0
    h2: float = 0.0
    h3: float = 0.0
    sag: float = 0.0
    E_course: tuple[tuple[float, float], ...] = ()
    r_course: tuple[tuple[float, float], ...] = ()
    temperature: tuple[float, float] = (20.0, 20.0)
    softening: float = -1.5e-4
    modes: tuple[tuple[float, float, float], ...] = ((1450.0, 0.01, 0.5), (3400.0, 0.008, 0.7), (6700.0, 0.012, 0.4))
    acc_noise: float = 0.01
    acc_gain: float = 0.0
    acc_high_pass: float = 0.5
    acc_cross_axis: float = 0.0
    laser_noise: float = 2e-6
    laser_linearity: float = 0.0
    laser_delay: float = 1e-4
    enob: float = 17.5
    ppm: float = 0.0
    ppm_second: float = 0.0
    offset_second: float = 0.0
    skew: float = 0.0
    recorders: Literal[1, 2] = 1
    u_mass: float = 5e-4
    u_b: float = 5e-5
    u_temperature: float = 0.0
    missed: float = 0.0
    false: float = 0.0
    dropouts: float = 0.0
    channels: tuple[str, ...] = ("base_disp", "base_acc", "lo_disp", "lo_acc")
    camera: BallCamera | None = None
    form: Literal["tdms", "uff", "mat", "mat73", "csv", "hdf5", "wav"] = "tdms"
    fault: Literal["none", "sign", "unit", "clock"] = "none"
    fault_channel: str = "lo_disp"

    def check(self) -> RigSettings:
        """Return the settings if a rig can be so.

        Raises
        ------
        ParameterError
            One line: what cannot be, and what is allowed.
        """
        for name in ("duration", "rate", "M", "m", "k", "b", "contact_time", "r_speed", "f", "enob"):
            if not getattr(self, name) > 0:
                raise ParameterError(f"synthetic rig: {name} is {getattr(self, name):g}, allowed is {name} > 0")
        for name in ("settle", "c", "E", "sigma_r", "friction", "acc_noise", "laser_noise", "missed", "false"):
            if not getattr(self, name) >= 0:
                raise ParameterError(f"synthetic rig: {name} is {getattr(self, name):g}, allowed is {name} >= 0")
        if not 0.05 <= self.r <= 0.98:
            raise ParameterError(f"synthetic rig: r is {self.r:g}, allowed is 0.05 <= r <= 0.98")
        if not 2e-5 <= self.contact_time <= 1e-3:
            raise ParameterError(f"synthetic rig: contact_time is {self.contact_time:g} s, allowed is 2e-5 to 1e-3")
        for name in ("E_course", "r_course"):
            times = [when for when, _ in getattr(self, name)]
            if any(later <= earlier for earlier, later in pairwise(times)):
                raise ParameterError(f"synthetic rig: times of {name} are {times}, allowed are rising ones")
        known = ("base_disp", "base_acc", "lo_disp", "lo_acc")
        for name in self.channels:
            if name not in known:
                raise ParameterError(f"synthetic rig: channel {name!r}, allowed are {', '.join(known)}")
        filmed = known if self.camera is None else (*known, "ball_cam")
        if self.fault_channel not in filmed:
            raise ParameterError(f"synthetic rig: channel {self.fault_channel!r}, allowed are {', '.join(filmed)}")
        if self.camera is not None:
            self.camera.check()
        if not self.channels:
            raise ParameterError(f"synthetic rig: channels is empty, allowed are {', '.join(known)}")
        if self.recorders == 2 and "base_acc" not in self.channels:
            raise ParameterError("synthetic rig: two recorders share base_acc; add it to channels")
        return self


def draw_settings(seed: int, **given: object) -> RigSettings:
    """Return settings drawn over the ranges of a real rig's imperfections.

    Forcing, mass ratio and restitution are drawn about the 1:1 response of Table 1: A from .012 to .026, Omega from .99
    to 1.01, mu from .006 to .02, r from .55 to .75.

    Parameters
    ----------
    seed : int
        Of the draws.
    **given
        Settings that are not drawn.

    Raises
    ------
    ParameterError
        If they cannot be.

    Examples
    --------
    >>> one = draw_settings(1, duration=10.0)
    >>> one == draw_settings(1, duration=10.0), one == draw_settings(2, duration=10.0)
    (True, False)
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 8]))

    def even(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    def log(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    def either(low: float, high: float) -> float:
        return float(rng.choice([-1.0, 1.0])) * even(low, high)

    omega0 = float(np.sqrt(11680.0 / 3.807))
    warm = even(18.0, 24.0)
    two = bool(rng.random() < 0.3)
    drawn: dict[str, object] = {
        "E": 0.015 * even(0.012, 0.026),
        "f": omega0 / (2 * np.pi) * even(0.99, 1.01),
        "m": 3.807 * log(0.006, 0.02),
        "r": even(0.55, 0.75),
        "sigma_r": log(0.005, 0.05),
        "r_exponent": even(0.05, 0.2),
        "contact_time": even(70e-6, 200e-6),
        "friction": log(0.001, 0.02),
        "tilt": even(-0.1, 0.1),
        "asymmetry": even(-2e-4, 2e-4),
        "h2": log(0.002, 0.03),
        "h3": log(0.001, 0.01),
        "sag": even(0.0, 0.2),
        "temperature": (warm, warm + even(-2.0, 2.0) / 20),
        "u_temperature": 0.1,
        "modes": tuple(
            (even(low, high), even(0.005, 0.02), even(0.2, 0.8))
            for low, high in ((1000.0, 2500.0), (2500.0, 5000.0), (5000.0, 8000.0))
        ),
        "acc_noise": log(0.003, 0.03),
        "acc_gain": either(0.0, 0.02),
        "acc_high_pass": even(0.3, 1.0),
        "acc_cross_axis": even(0.0, 0.05),
        "laser_noise": log(1e-6, 1e-5),
        "laser_linearity": either(2e-4, 1e-3),
        "laser_delay": log(20e-6, 500e-6),
        "enob": even(17.0, 18.0),
        "ppm": either(5.0, 50.0),
        "skew": even(0.0, 1.0),
        "ppm_second": either(5.0, 50.0),
        "offset_second": even(-0.045, 0.045),
        "recorders": 2 if two else 1,
        "missed": even(0.0, 0.03),
        "false": even(0.0, 0.2),
        "dropouts": float(rng.integers(0, 6)),
    }
    settings = msgspec.structs.replace(RigSettings(), **{**drawn, "run_id": f"synthetic_{seed:05d}", **given})
    return settings.check()
