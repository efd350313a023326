"""Impacts from what they do to the velocity: short pulses of the acceleration, whose area is the velocity jump.

The signal is smoothed by a Gaussian of .6 ms. Structural ringing above 1 kHz falls by sixty decibels, whereas the pulse
of a contact, .07 to .2 ms long, keeps its area and the centroid of its force. So a peak gives sign, size and time of a
jump, where the onset of an envelope gives only a time, and one that the ringing of the impact before may hide.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from vines.rig.fit import U_PULSE, Train
from vines.rig.recording import Sampled
from vines.rig.uncertainty import robust_deviation

__all__ = ["SMOOTH", "SMOOTH_DISPLACEMENT", "Pulses", "filled", "find_pulses", "pulses_of", "refine_pulses"]

Floats = npt.NDArray[np.float64]

SMOOTH = 6e-4
"""Standard deviation of the Gaussian for acceleration [s]."""

SMOOTH_DISPLACEMENT = 2e-3
"""That for the second derivative of a displacement, which amplifies noise [s]."""

_RATE = 12800.0


@dataclass(frozen=True, slots=True, eq=False)
class Pulses:
    """A smoothed acceleration on an even grid.

    Attributes
    ----------
    start, step : float
        Time of the first value and distance of values [s].
    values : ndarray, shape (n,)
        [m/s^2].
    smooth : float
        Standard deviation of the Gaussian [s].
    echo : float
        Distance at which half of each pulse shows with the other sign before and after it [s]; 0 for none.
    ring : float
        What ringing adds to a pulse, as a multiple of its second derivative [s^2]: modes with participations g_i and
        frequencies omega_i add sum g_i/omega_i^2 of it where they are far above the smoothing.
    """

    start: float
    step: float
    values: Floats
    smooth: float
    echo: float = 0.0
    ring: float = 0.0

    @property
    def t(self) -> Floats:
        """Times of the values [s]."""
        return self.start + self.step * np.arange(len(self.values), dtype=np.float64)

    def less(self, other: Floats) -> Pulses:
        """Return the signal without another one on the same grid."""
        return replace(self, values=self.values - other)

    def shape(self, times: Floats, dv: Floats) -> Floats:
        """Return what velocity jumps look like on the grid, shape (n,)."""
        if self.echo:
            times = np.concatenate([times, times - self.echo, times + self.echo])
            dv = np.concatenate([dv, -0.5 * dv, -0.5 * dv])
        total = np.zeros(len(self.values))
        reach = int(np.ceil(5 * self.smooth / self.step))
        middle = np.round((times - self.start) / self.step).astype(int)
        offsets = np.arange(-reach, reach + 1)
        index = middle[:, None] + offsets
        away = self.start + self.step * index - times[:, None]
        height = (dv / (self.smooth * np.sqrt(2 * np.pi)))[:, None]
        inside = (index >= 0) & (index < len(total))
        square = (away / self.smooth) ** 2
        bell = height * np.exp(-0.5 * square) * (1 + self.ring / self.smooth**2 * (square - 1))
        np.add.at(total, index[inside], bell[inside])
        return total

    def sparse(self) -> Pulses:
        """Return the signal less its mean at a distance on both sides: little of slow motion is left, echoes are."""
        reach = max(1, round(4 * self.smooth / self.step))
        values = self.values.copy()
        values[reach:-reach] -= 0.5 * (self.values[2 * reach :] + self.values[: -2 * reach])
        values[:reach] = values[-reach:] = 0.0
        return replace(self, values=values, echo=reach * self.step)

    @property
    def noise(self) -> float:
        """Standard deviation by the median, which sparse pulses do not reach [m/s^2]."""
        return robust_deviation(self.values - np.median(self.values))


def pulses_of(channel: Sampled, order: int = 2) -> Pulses:
    """Return the smoothed acceleration of a channel.

    Parameters
    ----------
    channel : Sampled
        Acceleration, or displacement if `order` is 0, whose smoothed second derivative is taken.
    order : {0, 2}
        What it measures.
    """
    size = max(1, round(channel.rate / _RATE))
    values = channel.values if channel.valid.all() else filled(channel)
    blocks = values[: len(values) // size * size].reshape(-1, size)
    # Triangular weights: a contact of 80 us has so much at the new rate that plain means would move its centroid by
    # up to 40 us, depending on where it lies between them.
    up = np.arange(1.0, size + 1) / size**2
    mean = blocks[:-1] @ up + blocks[1:] @ (up[::-1] - 1 / size**2)
    step = size / channel.rate
    start = channel.start + (size - 1) / channel.rate
    smooth = SMOOTH if order == 2 else SMOOTH_DISPLACEMENT
    smoothed = gaussian_filter1d(mean, smooth / step, order=2 - order, truncate=6.0)
    return Pulses(start, step, smoothed / step ** (2 - order), smooth)


def filled(channel: Sampled) -> Floats:
    """Return the samples with each stretch of invalid ones replaced by a cubic through 3 ms on either side."""
    values = channel.values.copy()
    bad = np.flatnonzero(~channel.valid)
    around = max(4, round(3e-3 * channel.rate))
    for run in np.split(bad, np.flatnonzero(np.diff(bad) > around) + 1):
        low, high = max(0, run[0] - around), min(len(values), run[-1] + around + 1)
        place = np.arange(low, high)
        good = channel.valid[low:high]
        if np.count_nonzero(good) < 8:
            continue
        x = (place - 0.5 * (low + high)) / (high - low)
        cubic = np.polynomial.polynomial.polyfit(x[good], values[low:high][good], 3)
        values[run] = np.polynomial.polynomial.polyval(x[run - low], cubic)
    return values


def find_pulses(pulses: Pulses, threshold: float, known: Train | None = None, *, u: float = U_PULSE) -> Train:
    """Return times [s] and velocity jumps [m/s] of the pulses higher than a threshold, those given first subtracted.

    Parameters
    ----------
    pulses : Pulses
        With the smooth motion removed, so that only jumps are left.
    threshold : float
        Least height of a peak [m/s^2].
    known : Train, optional
        Known jumps; they are in the answer, refined.
    u : float
        Standard uncertainty of the times of new ones [s].

    Returns
    -------
    Train
        Jumps nearer than twice the smoothing are one, at the centroid.

    Examples
    --------
    >>> quiet = Pulses(0.0, 1e-4, np.zeros(2000), 6e-4)
    >>> noisy = quiet.less(-quiet.shape(np.array([0.05, 0.1234]), np.array([0.01, -0.002])))
    >>> found = find_pulses(noisy, 0.3)
    >>> np.round(found.t, 6), np.round(found.dv, 6)
    (array([0.05  , 0.1234]), array([ 0.01 , -0.002]))
    """
    train = Train.alike(np.zeros(0), np.zeros(0), u) if known is None else known
    for _ in range(4):
        left = pulses.values - pulses.shape(train.t, train.dv)
        size = np.abs(left)
        peak = np.zeros(len(left), bool)
        peak[1:-1] = (size[1:-1] >= size[:-2]) & (size[1:-1] > size[2:]) & (size[1:-1] > threshold)
        found = np.flatnonzero(peak)
        if len(train):
            # What a known jump leaves beside itself is its misfit, not another impact.
            t = pulses.start + pulses.step * found
            right = np.searchsorted(train.t, t)
            left_of, right_of = np.maximum(right - 1, 0), np.minimum(right, len(train) - 1)
            a, b = np.abs(t - train.t[left_of]), np.abs(t - train.t[right_of])
            near, height = np.minimum(a, b), np.abs(np.where(a < b, train.dv[left_of], train.dv[right_of]))
            far = (near >= 4 * pulses.smooth) | (
                size[found] > np.maximum(threshold, 0.2 * height / (pulses.smooth * 2.5))
            )
            found = found[far & (near > 1.5 * pulses.smooth)]
        if not len(found):
            break
        # Of peaks nearer than two widths the highest comes first; the others may follow in the next round.
        order = found[np.argsort(-size[found], kind="stable")]
        apart = max(1, round((2 * pulses.smooth + pulses.echo) / pulses.step))
        blocked = np.zeros(len(left), bool)
        chosen = []
        for k in order:
            if not blocked[k]:
                chosen.append(k)
                blocked[max(0, k - apart) : k + apart + 1] = True
        new = np.array(chosen)
        jumps = left[new] * pulses.smooth * np.sqrt(2 * np.pi)
        train = refine_pulses(pulses, train.merged(Train.alike(pulses.start + pulses.step * new, jumps, u)))
    return train


def refine_pulses(pulses: Pulses, train: Train, *, level: bool = False) -> Train:
    """Refine times and sizes of all jumps by Gauss–Newton on the smoothed signal, and join what is too near.

    With `level` each pulse stands on a straight line of its own: harmonics that a sensor adds to a displacement are
    large in the acceleration of the motion that was fitted to it, and their slope shifts small pulses.
    """
    reach = int(np.ceil((3.5 if level else 2.0) * pulses.smooth / pulses.step))
    offsets = np.arange(-reach, reach + 1)
    for _ in range(6):
        if not len(train):
            return train
        train = _joined(train, 2 * pulses.smooth)
        left = pulses.values - pulses.shape(train.t, train.dv)
        middle = np.round((train.t - pulses.start) / pulses.step).astype(int)
        index = np.clip(middle[:, None] + offsets, 0, len(left) - 1)
        away = (pulses.start + pulses.step * index - train.t[:, None]) / pulses.smooth
        bell = np.exp(-0.5 * away**2) / (pulses.smooth * np.sqrt(2 * np.pi))
        here = left[index]
        slope = bell * away / pulses.smooth
        free_bell, free_slope = bell, slope
        if level:
            free_bell = bell - np.mean(bell, axis=1, keepdims=True)
            tilt = np.sum(slope * away, axis=1) / np.sum(away**2, axis=1)
            free_slope = slope - tilt[:, None] * away
        up = np.sum(here * free_bell, axis=1) / np.sum(bell * free_bell, axis=1)
        moment = np.sum(here * free_slope, axis=1) / np.sum(slope * free_slope, axis=1)
        dv = train.dv + up
        shift = np.where(np.abs(dv) > 1e-9, moment / np.where(dv == 0, 1.0, dv), 0.0)
        train = Train(train.t + np.clip(shift, -0.5 * pulses.smooth, 0.5 * pulses.smooth), dv, train.u)
    return train


def _joined(train: Train, apart: float) -> Train:
    """Join jumps that are nearer than `apart` into one of the same sum, at the centroid; the nearest ones first."""
    near = np.diff(train.t) < apart
    if not near.any():
        return train
    t, dv, keep = train.t.copy(), train.dv.copy(), np.ones(len(train), bool)
    # A centroid lies between those joined: what is apart from both is apart from it.
    edges = np.flatnonzero(np.diff(near, prepend=False, append=False)).tolist()
    for first, last in zip(edges[0::2], edges[1::2], strict=True):
        few = list(range(first, last + 1))
        while len(few) > 1:
            gaps = np.diff(t[few])
            k = int(np.argmin(gaps))
            if gaps[k] >= apart:
                break
            one, other = few[k], few.pop(k + 1)
            size, more = abs(dv[one]) + 1e-12, abs(dv[other]) + 1e-12
            t[one] = (t[one] * size + t[other] * more) / (size + more)
            dv[one] += dv[other]
            keep[other] = False
    return Train(t[keep], dv[keep], train.u[keep])
