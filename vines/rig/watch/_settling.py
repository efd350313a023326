"""Whether a motion has settled, and how long it still takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Settling", "settling", "slope"]

_LEAST = 8
"""Steps from which on something is said."""
_SHOWN = 15
"""Steps that are looked at."""
_TOLERANCE = 0.01
"""Relative distance from the end at which a motion counts as settled."""
_SIGMAS = 3.0
_SURE = 5.0
"""Standard uncertainties of a trend that are none by chance: it is looked for again and again."""
_MEMORIES = 3.0
"""Memories of the oscillator that have to pass at least after the forcing has changed: e^-3 of a transient is left."""
_ROUGH = 0.04
"""Scatter from step to step, relative, above which the motion does not repeat."""
_SLOWEST = 120.0
"""Longest memory that is looked for [s]."""


@dataclass(frozen=True, slots=True)
class Settling:
    """What is left of a transient.

    Attributes
    ----------
    settled : bool
        Whether it is below the tolerance or the noise, and shows no trend.
    wait : float or None
        Seconds until it is below; None where that cannot be told.
    why : str
        In words.
    """

    settled: bool
    wait: float | None
    why: str


def settling(
    t: npt.NDArray[np.float64],
    z: npt.NDArray[np.complex128],
    memory: float | None = None,
    tolerance: float = _TOLERANCE,
) -> Settling:
    """Say whether a response has settled.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times of steps since the forcing changed [s], of equal length.
    z : ndarray of complex, shape (n,)
        Amplitude of the response in each, relative to the base.
    memory : float, optional
        2/lam in time units of the rig [s]: in so long a free motion decays to 1/e. Without it that which fits best.
    tolerance : float
        Relative distance from the end at which a motion counts as settled.

    Notes
    -----
    z = z_end + C exp(-t/memory) is fitted to the last steps. What is left at the end is compared with the tolerance and
    with its uncertainty by the scatter, which second differences give: a slow transient is none of it. Where no decay
    is left, a trend of modulus or phase beside it still counts as one, if it is faster than the tolerance in three
    memories: what is slower is a drift.

    Examples
    --------
    >>> t = np.arange(40.0)
    >>> early = settling(t[:10], 1.0 - 0.8 * np.exp(-t[:10] / 3.0) + 0j, memory=3.0)
    >>> early.settled, round(early.wait, 1)
    (False, 4.1)
    >>> settling(t, 1.0 - 0.8 * np.exp(-t / 3.0) + 0j, memory=3.0).settled
    True
    """
    n = len(t)
    least = 0.0 if memory is None else _MEMORIES * memory - (float(t[-1] - t[0]) if n else 0.0)
    if n < _LEAST:
        step = float(t[1] - t[0]) if n > 1 else 1.0
        return Settling(False, max(least, step * (_LEAST - n)), "too short to tell")
    t, z = t[-_SHOWN:], z[-_SHOWN:]
    size = float(np.abs(z[-_LEAST:]).mean())
    if not size > 0:
        return Settling(False, None, "the oscillator does not move")
    sigma = float(np.median(np.abs(z[:-2] - 2 * z[1:-1] + z[2:]))) / np.sqrt(6 * np.log(2))
    longest = max(float(t[-1] - t[0]), 2.0)
    tried = [memory] if memory is not None else np.geomspace(0.5, min(longest, _SLOWEST), 16).tolist()
    fits = [_decay(t, z, each) for each in tried]
    best = min(range(len(fits)), key=lambda place: fits[place][2])
    found, u, tau = fits[best][0], fits[best][1], tried[best]
    u *= max(sigma, 1e-12)
    size = abs(complex(fits[best][3].mean()))
    allowed = max(tolerance * size, _SIGMAS * u)
    rough = sigma > _ROUGH * size
    if found > allowed and not rough:
        wait = max(tau * float(np.log(found / (tolerance * size))), least, 0.0)
        return Settling(False, wait, f"{found / size:.1%} of the response still decays")
    if least > 0:
        return Settling(False, least, "the forcing changed a short while ago")
    # Slower than that it is a drift, which has no end to be waited for.
    within = _MEMORIES * (memory if memory is not None else tau)
    if not rough and (trend := _trend(t, fits[best][3], tolerance * size / within, sigma)):
        return Settling(False, None, trend)
    return Settling(True, 0.0, "no period is like the next, but nothing goes one way" if rough else "")


def _decay(
    t: npt.NDArray[np.float64], z: npt.NDArray[np.complex128], tau: float
) -> tuple[float, float, float, npt.NDArray[np.complex128]]:
    """Return of a decay what is left at the end, its uncertainty for unit scatter, the rms beside it, z without it."""
    falling = np.exp(-(t - t[-1]) / tau)
    columns = np.stack([np.ones(len(t)), falling], axis=1)
    weights, *_ = np.linalg.lstsq(columns, z, rcond=None)
    rest = z - columns @ weights
    u = float(np.sqrt(np.linalg.pinv(columns.T @ columns)[1, 1]))
    return float(abs(weights[1])), u, float(np.sqrt(np.mean(np.abs(rest) ** 2))), rest + weights[0]


def _trend(t: npt.NDArray[np.float64], z: npt.NDArray[np.complex128], least: float, sigma: float) -> str:
    """Return what goes one way in the last steps, faster than `least` a second, in words; empty if nothing does."""
    tau, mean = t[-_LEAST:] - t[-_LEAST:].mean(), z[-_LEAST:].mean()
    u = sigma / float(np.sqrt(tau @ tau))
    along = complex(tau @ z[-_LEAST:] / (tau @ tau) * np.conj(mean) / abs(mean))
    for name, rate in (("amplitude", along.real), ("phase", along.imag)):
        if abs(rate) > max(least, _SURE * u):
            return f"its {name} {'rises' if rate > 0 else 'falls'} still"
    return ""


def slope(t: npt.NDArray[np.float64], values: npt.NDArray[np.float64]) -> tuple[float, float]:
    """Return the slope of values over time and its standard uncertainty, widened where neighbours are alike.

    Examples
    --------
    >>> rate, u = slope(np.arange(50.0), 0.5 * np.arange(50.0))
    >>> round(rate, 6), u < 1e-12
    (0.5, True)
    """
    tau = t - t.mean()
    spread = float(tau @ tau)
    rate = float(tau @ values) / spread
    left = values - values.mean() - rate * tau
    like = float(left[1:] @ left[:-1]) / float(left @ left) if left @ left > 0 else 0.0
    like = min(max(like, 0.0), 0.9)
    u = float(np.sqrt(left @ left / max(len(t) - 2, 1) / spread * (1 + like) / (1 - like)))
    return rate, u
