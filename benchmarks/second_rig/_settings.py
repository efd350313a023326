"""What the second rig is made of, and what its runs are drawn from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

G = 9.80665


@dataclass(frozen=True)
class SecondRig:
    """A run of the second rig; SI units. As it stands it is a rig that the model describes.

    Attributes
    ----------
    seed : int
        Of everything that is drawn while it runs.
    E, f : float
        Amplitude of the base that the shaker would reach without load [m], frequency [Hz].
    duration, settle, rate : float
        Length of the record and of the time before it [s]; samples a second.
    M, m, c, k, b, r, sigma_r : float
        As of the first rig; r does not depend on speed here.
    friction : float
        Deceleration of the ball that slides [m/s^2].
    friction_stated : bool
        Whether ``run.json`` has it.
    tilt : float
        Acceleration of the ball to the right [m/s^2].
    contact_time : float
        How long a contact lasts, at any speed [s].
    h2, h3 : float
        Harmonics of the base.
    rolling : float
        Coefficient of friction of a ball that spins: where it rolls friction turns with the slip v2 - v1 - R w, and
        takes the place of `friction`; 0 for one that slides only.
    cubic : float
        Stiffness added at `CUBIC_AT`, relative to k; it grows with the square of the displacement.
    compliance : float
        k over the stiffness of the shaker's suspension: the table gives way by so much of the spring's force over k.
        0 is a shaker whose table moves as it should.
    table : str
        In a ring-down: ``fixed``, or ``free``, on a soft suspension.
    table_mass : float
        Of a free table [kg].
    modes : float
        Displacement of the frame modes that impacts ring, relative to what their velocity jump would ring freely.
    hum : float
        Amplitude of 50 Hz in every channel [V].
    drift_E, drift_r, drift_omega0 : float
        Change from start to end of the record: of E and omega0 relative, of r absolute.
    laser_noise, laser_bend, laser_delay : float
        Noise [m], third-order bend in parts of the range, delay [s].
    acc_noise : float
        [m/s^2]
    channels : tuple of str
        What is recorded.
    ringdown : bool
        Whether this is one.
    """

    seed: int = 0
    E: float = 2.25e-4
    f: float = 8.8156
    duration: float = 40.0
    settle: float = 60.0
    rate: float = 25600.0
    M: float = 3.807
    m: float = 0.032
    c: float = 2.53
    k: float = 11680.0
    b: float = 0.015
    r: float = 0.65
    sigma_r: float = 0.01
    friction: float = 0.02
    friction_stated: bool = True
    tilt: float = 0.0
    contact_time: float = 1.2e-4
    h2: float = 0.003
    h3: float = 0.002
    rolling: float = 0.0
    cubic: float = 0.0
    compliance: float = 0.0
    table: str = "fixed"
    table_mass: float = 60.0
    modes: float = 0.0
    hum: float = 0.0
    drift_E: float = 0.0
    drift_r: float = 0.0
    drift_omega0: float = 0.0
    laser_noise: float = 2e-6
    laser_bend: float = 3e-4
    laser_delay: float = 1e-4
    acc_noise: float = 0.01
    channels: tuple[str, ...] = ("base_disp", "base_acc", "lo_disp", "lo_acc")
    ringdown: bool = False


CUBIC_AT = 0.009
"""[m] Where `SecondRig.cubic` is the share that is added to the stiffness: the usual amplitude of 1:1."""

PHYSICS = {
    "none": (),
    "rolling": ("rolls",),
    "soft": ("contact is soft",),
    "cubic": ("spring is not linear",),
    "shaker": ("base gives way",),
    "table": ("base moved in the ring-down",),
    "modes": ("modes of the frame ring",),
    "hum": ("hum of the mains",),
    "drift_E": ("the amplitude of the base changes", "the base dwells at"),
    "drift_r": ("the restitution changes",),
    "drift_omega0": ("the natural frequency omega0 changes",),
}
"""What may be switched on, and words one of which names it."""

HARMLESS = ("none", "table", "hum", "modes")
"""With these the run itself is the model's, if what they add is recognised: agree is right."""


def draw_rig(seed: int, physics: str, *, strength: float = 1.0, duration: float = 40.0) -> SecondRig:
    """Return a rig about the 1:1 response of Table 1 with one effect, at a strength that real rigs show."""
    rng = np.random.default_rng([seed, 2026])

    def even(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    def log(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    rig = SecondRig(
        seed=seed, duration=duration, E=0.015 * even(0.0125, 0.017), f=8.8156 * even(0.997, 1.003),
        m=3.807 * even(0.007, 0.012), r=even(0.58, 0.72), sigma_r=log(0.004, 0.015), friction=G * log(3e-4, 0.015),
        friction_stated=bool(rng.random() < 0.5), tilt=0.01 * float(rng.normal()), contact_time=even(8e-5, 1.9e-4),
        h2=log(0.001, 0.01), h3=log(0.001, 0.005), laser_noise=log(1e-6, 5e-6), laser_bend=even(-5e-4, 5e-4),
        laser_delay=log(3e-5, 4e-4), acc_noise=log(0.003, 0.03),
    )  # fmt: skip
    sign = float(rng.choice([-1.0, 1.0]))
    match physics:
        case "rolling":
            return replace(rig, rolling=strength * even(0.08, 0.25), friction_stated=False)
        case "soft":
            return replace(rig, contact_time=strength * even(1.3e-3, 2.0e-3))
        case "cubic":
            return replace(rig, cubic=strength * even(0.05, 0.09) * sign)
        case "shaker":
            return replace(rig, compliance=strength * even(0.004, 0.015))
        case "table":
            return replace(rig, table="free", table_mass=even(30.0, 120.0) / strength)
        case "modes":
            return replace(rig, modes=strength * even(0.3, 1.0))
        case "hum":
            return replace(rig, hum=strength * even(2e-3, 4e-3))
        case "drift_E":
            return replace(rig, drift_E=strength * sign * even(0.04, 0.1))
        case "drift_r":
            return replace(rig, drift_r=-strength * even(0.04, 0.08))
        case "drift_omega0":
            return replace(rig, drift_omega0=-strength * even(1e-3, 3e-3))
        case _:
            return rig


def rest_of(rig: SecondRig, number: int = 0) -> SecondRig:
    """Return a ring-down of the same rig, of 15 s from 12 mm."""
    return replace(
        rig, seed=rig.seed + 7_000_000 + number, ringdown=True, duration=15.0, settle=0.0, modes=0.0, drift_omega0=0.0,
        drift_E=0.0, drift_r=0.0,
    )  # fmt: skip
