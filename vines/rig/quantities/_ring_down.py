"""Natural frequency and damping from a ring-down with the ball removed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vines.errors import RigError
from vines.rig.fit import bins_of, clumping, sinhc
from vines.rig.recording import Recording, Uncertain

__all__ = ["STIFFNESS_DRIFT", "U_STIFFNESS_DRIFT", "RingDown", "natural", "ring_down"]

STIFFNESS_DRIFT = -1.5e-4
"""Relative change of omega0 per kelvin: steel's modulus falls by about .03 % a kelvin."""

U_STIFFNESS_DRIFT = 0.5e-4
"""Standard uncertainty of that."""

_U_TEMPERATURE = 0.1
"""[K] A sensor on the frame follows the spring's temperature to a tenth or two of a kelvin."""

_U_DAMPING = 1e-4
"""Relative standard uncertainty of lam at least: no damper is linear beyond that."""

_ROUNDS = 60
_DEGREE = 7


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
    """

    run_id: str
    omega0: Uncertain
    lam: Uncertain
    temperature: float
    residual: float


def ring_down(recording: Recording) -> RingDown:
    """Fit a decaying sine to the free oscillation of a ring-down.

    Parameters
    ----------
    recording : Recording
        Of protocol ``ringdown``, ball out, base at rest.

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
    the early half and the late half must agree: their difference (a stiffness that depends on the amplitude) is added
    to the uncertainty.
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
    s, covariance, residual, size, bent = _decay(t, y, bins.width, complex(-0.3, 2 * np.pi * f))
    if channel.role == "lo_disp":
        s, covariance, residual, size, bent = _decay(t, y, bins.width, s, size)
    half = len(t) // 2
    early = _decay(t[:half], y[:half] - bent[:half], bins.width, s)[0]
    late = _decay(t[half:], y[half:] - bent[half:], bins.width, s)[0]
    omega0, lam = _natural(s)
    # d omega0 = (alpha d alpha + gamma d gamma)/omega0, lam = -2 alpha/omega0
    u_omega0 = float(np.hypot(np.sqrt(covariance[1, 1]), 0.5 * abs(_natural(early)[0] - _natural(late)[0])))
    u_lam = float(np.hypot(2 * np.sqrt(covariance[0, 0]) / omega0, 0.25 * abs(_natural(early)[1] - _natural(late)[1])))
    temperature = float(np.mean(run.temperature))
    return RingDown(run.run_id, Uncertain(omega0, u_omega0), Uncertain(lam, u_lam), temperature, residual / size)


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


def _natural(s: complex) -> tuple[float, float]:
    omega0 = abs(s)
    return omega0, -2 * s.real / omega0


def _line(t: np.ndarray, y: np.ndarray) -> float:
    spectrum = np.abs(np.fft.rfft(y * np.hanning(len(y))))
    return (int(np.argmax(spectrum[2:])) + 2) * (len(t) - 1) / ((t[-1] - t[0]) * len(t))


def _decay(
    t: np.ndarray, y: np.ndarray, width: float, s: complex, reach: float = 0.0
) -> tuple[complex, np.ndarray, float, float, np.ndarray]:
    """Return s, the covariance of (Re s, Im s), the residual, the amplitude at the start, and what the sensor added.

    With a `reach` [m] the signal may hold polynomials of the motion over it.
    """
    tau = t - t[0]
    bent = np.zeros_like(y)
    terms = np.zeros((0, len(y)))
    for _ in range(_ROUNDS):
        e = sinhc(0.5 * s * width) * np.exp(s * tau)
        columns = np.vstack([e.real, -e.imag, np.ones_like(tau), terms])
        linear = np.linalg.solve(columns @ columns.T, columns @ y)
        z = complex(linear[0], linear[1])
        slope = tau * z * e
        known = len(columns)
        bent = linear[3:] @ terms
        if reach:
            terms = reach * np.polynomial.legendre.legvander((z * e).real / reach, _DEGREE).T[2:]
        columns = np.vstack([columns, slope.real, -slope.imag])
        normal = columns @ columns.T
        left = y - linear @ columns[:known]
        step = np.linalg.solve(normal, columns @ left)
        # The first steps are held back: over a thousand radians the phase may turn once.
        change = complex(step[-2], step[-1])
        limit = 1.0 / tau[-1]
        s += change if abs(change) < limit else change * limit / abs(change)
        if abs(change) < 1e-11 * abs(s) and (known > 3 or not reach):
            break
    else:
        raise RigError("the ring-down is no decaying sine: its fit does not come to rest")
    if not s.real < 0:
        raise RigError(f"the ring-down grows, by exp({s.real:.3g} t); record the free decay with the base at rest")
    residual = float(np.sqrt(np.mean(left**2)))
    covariance = np.linalg.inv(normal)[-2:, -2:] * residual**2 * clumping(left)
    return s, covariance, residual, abs(z), bent
