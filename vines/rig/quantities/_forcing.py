"""What the base did, and whether the oscillator's response in flight belongs to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.fit import SineFit, bins_of, sine_fit
from vines.rig.recording import Recording, Sampled, Uncertain

__all__ = ["Base", "Rubbed", "Tuning", "measure_base", "tune"]


_Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Base:
    """Measured motion of the base, e(t) = Re[e_1 exp(i omega t)] + harmonics.

    Attributes
    ----------
    channel : Sampled
        Where it was measured.
    fit : SineFit
        Of the channel.
    e : ndarray of complex, shape (N,)
        Displacement e_1 … e_N [m].
    E : Uncertain
        Amplitude [m], calibration included.
    f : Uncertain
        Frequency [Hz].
    phase : Uncertain
        phi of e = E sin(omega t + phi) [rad] on the run's clock, alignment included.
    other : Uncertain or None
        E from a second channel on the base, for a check.
    """

    channel: Sampled
    fit: SineFit
    e: npt.NDArray[np.complex128]
    E: Uncertain
    f: Uncertain
    phase: Uncertain
    other: Uncertain | None


@dataclass(frozen=True, slots=True)
class Tuning:
    """omega0, lam, E and the alignment after the response in flight has been laid beside the base.

    Attributes
    ----------
    omega0, lam, E : Uncertain
        [rad/s], [1], [m].
    phase : float
        Correction of the base's phase [rad].
    ratio : complex
        Base motion that the response asks for, relative to the measured one, before the correction.
    misfit : float
        Distance of `ratio` from 1 in standard deviations (root of chi^2 of two degrees of freedom).
    by_omega0 : complex
        Change of `ratio` by a relative change of the omega0 that it is computed with.
    friction : Uncertain
        Of the ball [m/s^2], by what was known of it and the response.
    rubbing : Uncertain
        The same by the response alone.
    unexplained : float
        `misfit` where friction may be whatever it likes.
    parts : mapping of str to mapping of str to float
        What each source adds to the relative uncertainty of ``omega0`` and ``E``.
    """

    omega0: Uncertain
    lam: Uncertain
    E: Uncertain
    phase: float
    ratio: complex
    misfit: float
    by_omega0: complex
    friction: Uncertain
    rubbing: Uncertain
    unexplained: float
    parts: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


def measure_base(recording: Recording, *, harmonics: int = 3) -> Base:
    """Fit the base motion; the command is never used.

    Raises
    ------
    RigError
        If no channel measures the base.
    """
    channel = recording.role("base_disp", "base_vel", "base_acc")
    if channel is None:
        raise RigError(
            f"run {recording.run.run_id!r} has no channel on the base (base_disp, base_vel or base_acc); the command "
            "is not used in its place"
        )
    fit = sine_fit(bins_of(channel), harmonics=harmonics)
    e = _displacement(channel, fit)
    E = abs(e[0])
    relative = fit.u_amplitude / abs(fit.harmonics[0])
    # The fit's phase is best in the middle of the record; the clock's alignment adds to it.
    # That of a first-order high-pass changes by its corner over the frequency.
    u_phase = float(np.hypot.reduce([fit.u_phase, fit.omega * channel.u_time, channel.u_high_pass / fit.f]))
    later = {"base_disp": ("base_acc", "base_vel"), "base_vel": ("base_acc",)}
    second = recording.role(*later.get(channel.role, ()))
    other = None
    if second is not None:
        again = sine_fit(bins_of(second), harmonics=harmonics, near=fit.f)
        size = float(abs(_displacement(second, again)[0]))
        other = Uncertain(size, size * float(np.hypot(second.u_gain, again.u_amplitude / abs(again.harmonics[0]))))
    return Base(
        channel,
        fit,
        e,
        Uncertain(float(E), float(E * np.hypot(relative, channel.u_gain))),
        Uncertain(fit.f, float(np.hypot(fit.u_f, fit.f * channel.u_time / (len(channel.values) / channel.rate)))),
        Uncertain(float(np.angle(e[0]) + np.pi / 2), u_phase),
        other,
    )


def _displacement(channel: Sampled, fit: SineFit) -> npt.NDArray[np.complex128]:
    n = np.arange(1, len(fit.harmonics) + 1)
    scale = {"base_disp": 1.0, "base_vel": 1j * n * fit.omega}.get(channel.role, -((n * fit.omega) ** 2))
    return fit.harmonics / scale


@dataclass(frozen=True, slots=True)
class Rubbed:
    """What is known of the ball's friction, and what it does to the base motion that the response asks for.

    Attributes
    ----------
    known : Uncertain
        Before [m/s^2].
    assumed : float
        With which the response was fitted [m/s^2].
    slope : complex
        Derivative of the base motion by the friction [m/(m/s^2)].
    """

    known: Uncertain
    assumed: float
    slope: complex


_ANY = 3.0
"""Friction where nothing is known of it [m/s^2]."""


def tune(
    base: Base,
    omega0: Uncertain,
    lam: Uncertain,
    response: npt.NDArray[np.complex128],
    slopes: tuple[complex, complex],
    rubbed: Rubbed,
    *,
    u_gain: float,
    u_time: float,
    u_noise: float,
) -> Tuning:
    """Correct omega0, lam, E, the alignment and the ball's friction by the base motion that the response asks for.

    Parameters
    ----------
    base : Base
    omega0, lam : Uncertain
        From the ring-downs.
    response : ndarray of complex
        Base motion e_1 that the forced response in flight asks for [m]: its value first, then draws of it.
    slopes : tuple of complex
        Its derivatives by omega0/omega0 and lam/lam [m].
    rubbed : Rubbed
        The ball's friction drives the oscillator with mu times its deceleration, nearly a square wave.
    u_gain, u_time, u_noise : float
        Of the oscillator's channel: relative calibration, alignment [s]; and whatever else acts on the oscillator, as a
        fraction of E.

    Notes
    -----
    In flight omega0^2 (x1 - e) = -x1'' - …, so a wrong omega0 asks for a wrong base motion, and near resonance, where
    |x1| is forty times E, very much so. Two equations (real and imaginary part) for five numbers, each known before
    with an uncertainty: a Kalman step.
    """
    measured = base.e[0]
    ratio = complex(response[0] / measured)
    noise = response[1:] / measured
    covariance = np.cov(np.stack([noise.real, noise.imag])) if len(noise) > 2 else np.zeros((2, 2))
    covariance = covariance + np.eye(2) * u_noise**2
    by = [slopes[0] / measured, slopes[1] / measured, rubbed.slope / measured]
    # ratio + by_omega0 d_omega0 + by_lam d_lam + by_friction d_friction = (1 + d_gain)(1 + i d_phase)
    rows = np.array([[-each.real for each in by] + [1.0, 0.0], [-each.imag for each in by] + [0.0, 1.0]])
    relative_gain = float(np.hypot(base.E.u / base.E.value, u_gain))
    u_phase = float(np.hypot(base.phase.u, base.fit.omega * u_time))

    def solved(friction: Uncertain) -> tuple[_Floats, _Floats, float, _Floats, _Floats]:
        """Return step, its uncertainty, the misfit; and the gain and what was not known before."""
        mean = np.array([0.0, 0.0, friction.value - rubbed.assumed, 0.0, 0.0])
        before = np.array([omega0.u / omega0.value, lam.u / lam.value, friction.u, relative_gain, u_phase])
        prior = np.diag(np.square(before))
        seen = np.array([ratio.real - 1, ratio.imag]) - rows @ mean
        spread = rows @ prior @ rows.T + covariance
        gain = np.asarray(prior @ rows.T @ np.linalg.inv(spread), np.float64)
        u = np.sqrt(np.maximum(np.diag((np.eye(5) - gain @ rows) @ prior), 0.0))
        moved = np.asarray(mean + gain @ seen, np.float64)
        misfit = float(np.sqrt(seen @ np.linalg.solve(spread, seen)))
        return moved, np.asarray(u, np.float64), misfit, gain, before

    step, u, misfit, gain, before = solved(rubbed.known)
    free, u_free, unexplained, _, _ = solved(Uncertain(0.0, _ANY))
    # Of the correction of the gain, the base's share; the oscillator's own calibration keeps the rest.
    gains = (base.E.u / base.E.value, u_gain)
    share = (base.E.u / base.E.value) ** 2 / relative_gain**2 if relative_gain > 0 else 1.0
    E = base.E.value * (1 + share * float(step[3]))
    u_E = base.E.value * float(np.sqrt(share**2 * u[3] ** 2 + share * (1 - share) * relative_gain**2))
    return Tuning(
        Uncertain(omega0.value * (1 + float(step[0])), omega0.value * float(u[0])),
        Uncertain(lam.value * (1 + float(step[1])), lam.value * float(u[1])),
        Uncertain(E, u_E),
        float(step[4]),
        ratio,
        misfit,
        by[0],
        Uncertain(rubbed.assumed + float(step[2]), float(u[2])),
        Uncertain(rubbed.assumed + float(free[2]), float(u_free[2])),
        unexplained,
        _parts(before, np.asarray(gain @ rows), np.asarray(gain @ covariance @ gain.T), gains, share),
    )


def _parts(
    prior: npt.NDArray[np.floating],
    taken: npt.NDArray[np.floating],
    noise: npt.NDArray[np.floating],
    gains: tuple[float, float],
    share: float,
) -> dict[str, dict[str, float]]:
    """Return what each source adds to the relative uncertainties of omega0 and E.

    Parameters
    ----------
    prior : ndarray, shape (5,)
        Standard uncertainties of omega0, lam, friction, gain and phase before.
    taken : ndarray, shape (5, 5)
        Gain of the Kalman step times its rows: what it takes off an error of each.
    noise : ndarray, shape (5, 5)
        Covariance that the noise of the response brings.
    gains : tuple of float
        Relative uncertainties of the sensors of base and oscillator, which make the fourth.
    share : float
        Part of the correction of the gain that is the base's.
    """
    left = np.abs(np.eye(5) - taken)
    one = {
        "ring_down": left[0, 0] * prior[0],
        "damping": left[0, 1] * prior[1],
        "friction": left[0, 2] * prior[2],
        "base_sensor": left[0, 3] * gains[0],
        "lo_sensor": left[0, 3] * gains[1],
        "delay": left[0, 4] * prior[4],
        "noise": np.sqrt(noise[0, 0]),
    }
    moved = share * np.abs(taken[3])
    other = {
        "ring_down": moved[0] * prior[0],
        "damping": moved[1] * prior[1],
        "friction": moved[2] * prior[2],
        "base_sensor": abs(1 - share * taken[3, 3]) * gains[0],
        "lo_sensor": moved[3] * gains[1],
        "delay": moved[4] * prior[4],
        "noise": share * np.sqrt(noise[3, 3]),
    }
    return {name: {key: float(u) for key, u in parts.items()} for name, parts in (("omega0", one), ("E", other))}
