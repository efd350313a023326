"""Natural frequency and damping from a ring-down with the ball removed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vines.errors import RigError
from vines.rig.fit import Bins, bins_of
from vines.rig.quantities._decay import Decay, again, fit_decay
from vines.rig.recording import Recording, Sampled, Uncertain

__all__ = ["STIFFNESS_DRIFT", "U_STIFFNESS_DRIFT", "RingDown", "natural", "ring_down"]

STIFFNESS_DRIFT = -1.5e-4
"""Relative change of omega0 per kelvin: steel's modulus falls by about .03 % a kelvin."""

U_STIFFNESS_DRIFT = 0.5e-4
"""Standard uncertainty of that."""

_U_TEMPERATURE = 0.1
"""[K] A sensor on the frame follows the spring's temperature to a tenth or two of a kelvin."""

_U_DAMPING = 1e-4
"""Relative standard uncertainty of lam at least: no damper is linear beyond that."""

_STILL = 1e-5
"""Motion of the base relative to that of the oscillator that changes nothing."""

_FAR = 4.0
"""Standard deviations at which the base is believed to move."""

_SWINGS = 0.7
"""Most that a decaying sine leaves of the rest of the base's motion, where it is one."""

_FEW = 100


_LINEAR = Uncertain(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class RingDown:
    """omega0 and lam of the oscillator alone at one temperature.

    Attributes
    ----------
    run_id : str
        The run it comes from.
    omega0 : Uncertain
        Undamped natural frequency [rad/s].
    lam : Uncertain
        Damping c/(M omega0) [1].
    temperature : float
        Mean of that before and after [deg C]; nan if it was not read.
    residual : float
        Root mean square of what the decaying sine leaves, relative to its first amplitude.
    stiffening : Uncertain
        Relative change of the frequency by the square of the amplitude [1/m^2]: 3/8 k3/k of a cubic spring.
    base : float
        Motion of the base relative to that of the oscillator, where it was measured; omega0 and lam are those on a base
        that it does not move.
    """

    run_id: str
    omega0: Uncertain
    lam: Uncertain
    temperature: float
    residual: float
    stiffening: Uncertain = _LINEAR
    base: float = 0.0


def ring_down(recording: Recording) -> RingDown:
    """Fit a decaying sine to the free oscillation of a ring-down.

    Parameters
    ----------
    recording : Recording
        Of protocol ``ringdown``, ball out.

    Returns
    -------
    RingDown

    Raises
    ------
    RigError
        If there is no channel on the oscillator, the ball was in, or no decay is seen.

    Notes
    -----
    Least squares of Re[z exp(s t)] and an offset, with z and the offset eliminated; s = -lam omega0/2 + i gamma. A
    displacement may also hold polynomials of degree 2 to 7 of the motion: a sensor that is not quite linear shows a
    large motion with another gain than a small one, hence a wrong decay, but it shows harmonics, too. omega0 found from
    the early half and the late half must agree: their difference is added to the uncertainty.

    A frequency that depends on the amplitude, as a + b |z|^2, is a spring's that is not linear: omega0 and lam are then
    those of small amplitudes, and `RingDown.stiffening` says the rest.

    A table that is free, or held by a shaker, moves with the oscillator. Where that is measured, e = eta x1 of the free
    oscillation gives s^2 + (1 - eta) (lam omega0 s + omega0^2) = 0, from which follow omega0 and lam of an oscillator
    on a base that moves as it is told; what else the base does (a table on its suspension) may be in x1, too.
    """
    run = recording.run
    if run.ball:
        raise RigError(f"run {run.run_id!r} is a ring-down with the ball in; take it out and let the oscillator decay")
    channel = recording.role("lo_disp", "lo_acc", "lo_vel")
    if channel is None:
        raise RigError(f"run {run.run_id!r} has no channel on the oscillator (lo_disp, lo_vel or lo_acc)")
    bins = bins_of(channel)
    t, y = bins.t, bins.mean - np.median(bins.mean)
    f = _line(t, y)
    block = max(1, round(1 / (f * bins.width)))
    n = len(y) // block
    peaks = np.abs(y[: n * block]).reshape(n, block).max(axis=1)
    first = int(np.argmax(peaks))
    floor = float(np.median(np.abs(np.diff(y)))) / 0.95
    last = first + int(np.argmax(np.append(peaks[first:], 0.0) < max(0.02 * peaks[first], 3 * floor)))
    span = slice((first + 1) * block, last * block)
    if last - first < 10:
        raise RigError(f"run {run.run_id!r} shows no free decay of at least ten periods")
    t, y = t[span], y[span]
    span = Bins(t, y, bins.width)
    found = fit_decay(span, 2 * np.pi * f, sensor=channel.role == "lo_disp")
    order = _ORDERS[channel.role]
    carried = _carried(recording, found, order, channel)
    if carried.moves:
        found = fit_decay(span, found.s.imag, sensor=channel.role == "lo_disp", more=carried.swing(t))
        carried = _carried(recording, found, order, channel, carried.other)
    eta, u_eta = (carried.eta if carried.moves else 0.0), carried.u
    half = len(t) // 2
    early, late = (
        again(Bins(t[part], y[part] - found.bent[part], bins.width), found)
        for part in (slice(None, half), slice(half, None))
    )
    omega0, lam = _natural(found.s, eta)
    # d omega0 = (alpha d alpha + gamma d gamma)/omega0, lam = -2 alpha/omega0
    u_omega0 = float(np.hypot(found.u[1], 0.5 * abs(_natural(early)[0] - _natural(late)[0])))
    u_lam = float(np.hypot(2 * found.u[0] / omega0, 0.25 * abs(_natural(early)[1] - _natural(late)[1])))
    # A share of the base's motion moves omega0 by half of it, lam by as much of it as is a quarter of a turn late.
    u_omega0, u_lam = float(np.hypot(u_omega0, 0.5 * u_eta[0] * omega0)), float(np.hypot(u_lam, u_eta[1]))
    temperature = float(np.mean(run.temperature))
    metres = abs(found.s) ** order
    stiffening = Uncertain(found.turn / omega0 * metres**2, found.u_turn / omega0 * metres**2)
    return RingDown(
        run.run_id, Uncertain(omega0, u_omega0), Uncertain(lam, u_lam), temperature, found.residual / found.size,
        stiffening, abs(eta),
    )  # fmt: skip


_ORDERS = {
    "lo_disp": 0, "lo_vel": 1, "lo_acc": 2, "base_disp": 0, "base_vel": 1, "base_acc": 2,
}  # fmt: skip
"""Which derivative of the motion a channel shows."""


@dataclass(frozen=True, slots=True)
class _Carried:
    """How the base goes with the oscillator, and what exponent its own swing has."""

    eta: complex = 0.0
    u: tuple[float, float] = (0.0, 0.0)
    other: complex | None = None

    @property
    def moves(self) -> bool:
        return abs(self.eta) > max(_STILL, _FAR * max(self.u))

    def swing(self, t: np.ndarray) -> np.ndarray | None:
        if self.other is None:
            return None
        wave = np.exp(self.other * (t - t[0]))
        return np.stack([wave.real, wave.imag])


def _carried(recording: Recording, found: Decay, order: int, own: Sampled, other: complex | None = None) -> _Carried:
    """Return the base's part of the free oscillation, and the exponent of what else it swings by."""
    channel = recording.role("base_disp", "base_vel", "base_acc")
    if channel is None:
        return _Carried()
    bins = bins_of(channel)
    inside = (bins.t >= found.t[0]) & (bins.t <= found.t[-1])
    if np.count_nonzero(inside) < _FEW:
        return _Carried()
    part = Bins(bins.t[inside], bins.mean[inside] - bins.mean[inside].mean(), bins.width)
    to_x1 = found.s ** (order - _ORDERS[channel.role]) / found.z
    seen, u, left = found.part_of(part, _Carried(other=other).swing(part.t))
    if other is None and abs(seen * to_x1) > _STILL:
        other = _swing(Bins(part.t, left, part.width))
        seen, u, _ = found.part_of(part, _Carried(other=other).swing(part.t))
    u *= abs(to_x1)
    eta = complex(seen * to_x1)
    high_pass = np.hypot(channel.u_high_pass, own.u_high_pass) * 2 * np.pi / found.s.imag
    turned = float(np.hypot.reduce([found.s.imag * channel.u_time, found.s.imag * own.u_time, high_pass]))
    along, across = float(np.hypot(channel.u_gain, own.u_gain)), turned
    return _Carried(
        eta,
        (
            float(np.hypot.reduce([u, eta.real * along, eta.imag * across])),
            float(np.hypot.reduce([u, eta.imag * along, eta.real * across])),
        ),
        other,
    )


def _swing(rest: Bins) -> complex | None:
    """Return the exponent of a decaying sine in the rest of the base's motion, where there is one."""
    try:
        swing = fit_decay(rest, 2 * np.pi * _line(rest.t, rest.mean), bends=False)
    except (RigError, np.linalg.LinAlgError):
        return None
    return swing.s if swing.residual < _SWINGS * float(np.std(rest.mean)) else None


def natural(ringdowns: tuple[RingDown, ...], temperature: float) -> tuple[Uncertain, Uncertain]:
    """Return omega0 and lam at a temperature, from ring-downs before and after.

    Two or more temperatures apart by over 1 K give the drift of omega0 themselves; else `STIFFNESS_DRIFT` is taken.

    Parameters
    ----------
    ringdowns : tuple of RingDown
    temperature : float
        Of the run [deg C]; nan leaves omega0 uncorrected.

    Raises
    ------
    RigError
        If there is no ring-down.

    Examples
    --------
    >>> cold = RingDown("a", Uncertain(55.4, 1e-4), Uncertain(0.012, 1e-5), 20.0, 0.001)
    >>> omega0, lam = natural((cold,), 21.0)
    >>> round(omega0.value, 5), round(omega0.u, 5)
    (55.39169, 0.00301)
    """
    if not ringdowns:
        raise RigError("no ring-down is at hand; omega0 must be known to .01 %: record one before and after the sweep")
    at = np.array([one.temperature for one in ringdowns])
    values = np.array([one.omega0.value for one in ringdowns])
    u = np.array([max(one.omega0.u, 1e-9) for one in ringdowns])
    lam = np.array([one.lam.value for one in ringdowns])
    u_lam = np.array([max(one.lam.u, 1e-12) for one in ringdowns])
    known = np.isfinite(at) & np.isfinite(temperature)
    away = np.where(known, temperature - np.where(known, at, 0.0), 0.0)
    # Unknown temperatures: 2 K either way.
    lack = np.where(known, 0.0, 2.0 * abs(STIFFNESS_DRIFT))
    drift, u_drift = STIFFNESS_DRIFT, U_STIFFNESS_DRIFT
    if known.all() and np.ptp(at) > 1.0 and len(at) > 1:
        line = np.cov(at, values)
        slope = float(line[0, 1] / line[0, 0] / values.mean())
        each = np.hypot(u, _U_TEMPERATURE * drift * values)
        u_slope = float(np.sqrt(np.sum((each * (at - at.mean())) ** 2)) / np.sum((at - at.mean()) ** 2) / values.mean())
        weight = u_drift**2 / (u_drift**2 + u_slope**2)
        drift, u_drift = drift + weight * (slope - drift), u_drift * u_slope / np.hypot(u_drift, u_slope)
    moved = values * (1 + drift * away)
    own = np.sqrt(u**2 + (values * lack) ** 2 + (_U_TEMPERATURE * drift * values) ** 2)
    weights = 1 / (own**2 + (values * u_drift * away) ** 2)
    mean = float(np.sum(weights * moved) / np.sum(weights))
    shift = float(np.sum(weights * away) / np.sum(weights)) * mean * u_drift
    spread = float(np.sqrt(np.sum(weights * (moved - mean) ** 2) / np.sum(weights)))
    # The run's own temperature is read no better than theirs.
    read = _U_TEMPERATURE * drift * mean
    u_mean = float(np.sqrt(1 / np.sum(1 / own**2) + shift**2 + read**2 + (spread if len(at) > 1 else 0.0) ** 2))
    by = 1 / u_lam**2
    lam_mean = float(np.sum(by * lam) / np.sum(by))
    # What is wrong with the sensor is wrong in every ring-down, so their number makes lam no better.
    u_lam_mean = float(np.hypot.reduce([np.sum(by * u_lam) / np.sum(by), np.ptp(lam) / 2, _U_DAMPING * lam_mean]))
    return Uncertain(mean, u_mean), Uncertain(lam_mean, u_lam_mean)


def _natural(s: complex, eta: complex = 0.0) -> tuple[float, float]:
    """Return omega0 and lam of an oscillator whose free oscillation s the base follows by eta."""
    pull = -s * s / (1 - eta)
    damp = pull.imag / s.imag
    omega0 = float(np.sqrt(pull.real - damp * s.real))
    return omega0, damp / omega0


def _line(t: np.ndarray, y: np.ndarray) -> float:
    spectrum = np.abs(np.fft.rfft(y * np.hanning(len(y))))
    return (int(np.argmax(spectrum[2:])) + 2) * (len(t) - 1) / ((t[-1] - t[0]) * len(t))
