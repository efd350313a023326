"""Time averages that tell attractors apart which never repeat: chaotic ones and tori."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._carried import carried

__all__ = ["WINDOW", "Group", "averages", "match", "observe", "sort_into", "steady"]

Floats = npt.NDArray[np.float64]


WINDOW = 64
"""Forcing periods of one window of averages."""

SIGNS = np.array([1.0, 1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
"""What the mirror image does to the averages: the last two change their sign."""

BATCHES = 10
"""Parts of a run from whose scatter the standard errors of its averages are taken, each of three windows or more."""

SURE = 5.0
"""Standard errors by which two averages must differ for the attractors to be two."""

FLOOR = 1e-6
"""Relative difference of averages that is no difference, however small the errors."""


@dataclass
class Group:
    """Averages of one attractor, from several runs on it.

    Attributes
    ----------
    regimes : list of str
        What each run was called by itself.
    states : list of ndarray
        A state of each run.
    means, errors : list of ndarray, shape (7,)
        Averages of each run, those on the mirror image reflected, and their standard errors.
    windows : list of ndarray, shape (windows, 7)
        The same window by window.
    owner : int
        Number of the attractor, -1 while it has none: a transient that is soon left.
    signs : ndarray, shape (7,)
        What the mirror image does to the averages; 1 where motions have none.
    """

    regimes: list[str] = field(default_factory=list)
    states: list[Floats] = field(default_factory=list)
    means: list[Floats] = field(default_factory=list)
    errors: list[Floats] = field(default_factory=list)
    windows: list[Floats] = field(default_factory=list)
    owner: int = -1
    signs: Floats = field(default_factory=lambda: SIGNS)

    def add(self, regime: str, state: Floats, windows: Floats, error: Floats, sign: int) -> None:
        """Count a run with this attractor, or with its mirror image if `sign` is -1."""
        seen = windows if sign > 0 else windows * self.signs
        self.regimes.append(regime)
        self.states.append(state if sign > 0 else -state)
        self.means.append(np.mean(seen, axis=0))
        self.errors.append(error)
        self.windows.append(seen)

    @property
    def regime(self) -> str:
        """What most of its runs are called."""
        return max(sorted(set(self.regimes)), key=self.regimes.count)

    @property
    def mean(self) -> Floats:
        """Averages over all its runs; the odd ones are 0 if the attractor is its own mirror image."""
        mean = np.mean(self.means, axis=0)
        return np.where(self.signs < 0, 0.0, mean) if self.symmetric else mean

    @property
    def error(self) -> Floats:
        """Standard errors of `mean`."""
        return np.asarray(np.sqrt(np.mean(np.square(self.errors), axis=0) / len(self.errors)))

    @property
    def symmetric(self) -> bool:
        """Whether it is not told from its own mirror image."""
        odd = self.signs < 0
        return bool(np.all(np.abs(np.mean(self.means, axis=0))[odd] <= SURE * self.error[odd] + 1e-12))

    def spread(self, length: int) -> Floats:
        """Return the standard deviation of averages over so many windows."""
        parts = [
            np.mean(w[k : k + length], axis=0) for w in self.windows for k in range(0, len(w) - length + 1, length)
        ]
        if len(parts) < 2:
            return np.full(len(SIGNS), np.inf)
        return np.asarray(np.sqrt(np.mean(np.square(np.array(parts) - self.mean), axis=0)))


def averages(measures: npt.NDArray[np.void]) -> Floats:
    """Return averages over the recorded time of runs, shape (n, 7).

    Kinetic energies of mass and ball, mean square of x1, impacts and impact losses per time; then what changes its
    sign with the mirror image: impacts and losses on L less those on R.
    """
    time = measures["duration"]
    left, right = measures["impacts_left"] / time, measures["impacts_right"] / time
    lost_left, lost_right = measures["impact_loss_left"] / time, measures["impact_loss_right"] / time
    return np.stack(
        [
            measures["kinetic_1"],
            measures["kinetic_2"],
            measures["rms_x1"] ** 2,
            left + right,
            lost_left + lost_right,
            left - right,
            lost_left - lost_right,
        ],
        axis=1,
    )


def observe(p: Any, states: Floats, phase: float, windows: int) -> tuple[Floats, Floats]:
    """Run on from states at one phase of the forcing and take averages window by window.

    Returns
    -------
    values, end : ndarray, shape (n, windows, 7) and (n, d)
        Averages, and the states at the end.
    """
    values = np.empty((len(states), windows, len(SIGNS)))
    now = states
    for k in range(windows):
        now, measures = carried(p, now, phase, WINDOW, measured=True)
        values[:, k] = averages(measures) if measures is not None else np.nan
    return values, now


def mean_and_error(windows: Floats) -> tuple[Floats, Floats]:
    """Return the averages of a run of many windows and their standard errors by batch means."""
    batches = np.array([np.mean(part, axis=0) for part in np.array_split(windows, min(BATCHES, len(windows)))])
    error = np.std(batches, axis=0, ddof=1) / np.sqrt(len(batches)) if len(batches) > 1 else np.inf
    return np.mean(windows, axis=0), np.broadcast_to(error, windows.shape[1:])


def steady(values: Floats) -> npt.NDArray[np.bool_]:
    """Say of which runs, (n, windows, 7), the averages of the first and the second half agree within their errors."""
    half = values.shape[1] // 2
    keep = []
    for windows in values:
        (first, one), (second, other) = mean_and_error(windows[:half]), mean_and_error(windows[half:])
        keep.append(
            bool(np.all(np.abs(first - second) <= SURE * np.hypot(one, other) + FLOOR * np.abs(second) + 1e-12))
        )
    return np.array(keep, dtype=bool)


def _apart(values: Floats, errors: Floats, group: Group, spread: Floats) -> tuple[Floats, npt.NDArray[np.int64]]:
    """Return how many standard errors averages are from those of a group, or of its mirror image, and which of both."""
    allowed = np.hypot(errors, spread) + FLOOR * np.abs(group.mean) + 1e-12
    straight, reflected = (
        np.max(np.abs(values - mean) / allowed, axis=-1) for mean in (group.mean, group.mean * group.signs)
    )
    return np.minimum(straight, reflected), np.where(reflected < straight, -1, 1)


def match(values: Floats, length: int, groups: list[Group]) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return for averages over so many windows, shape (n, 7), the group that they agree with, and its sign.

    -1 where none does within SURE of the spread that such averages have on it, or where several do.
    """
    apart = np.full((len(values), len(groups)), np.inf)
    signs = np.ones((len(values), len(groups)), dtype=np.int64)
    for k, group in enumerate(groups):
        apart[:, k], signs[:, k] = _apart(
            values, np.zeros(len(SIGNS)), group, np.hypot(group.spread(length), group.error)
        )
    fits = apart < SURE
    best = np.argmin(apart, axis=1) if groups else np.zeros(len(values), dtype=np.int64)
    chosen = np.where(fits.sum(axis=1) == 1, best, -1)
    return chosen, signs[np.arange(len(values)), best] if groups else np.ones(len(values), dtype=np.int64)


def sort_into(groups: list[Group], regimes: list[str], states: Floats, values: Floats, *, mirrored: bool) -> None:
    """Put long runs into the groups that they agree with within the standard errors, or into new ones.

    Parameters
    ----------
    groups : list of Group
        Added to.
    regimes, states, values
        Of each run: what it is called, a state, averages window by window.
    mirrored : bool
        Whether the mirror image of a motion is a motion too.
    """
    # An error from few batches is uncertain itself: one that is small by chance is not believed.
    usual = np.median([mean_and_error(windows)[1] for windows in values], axis=0) if len(values) else 0.0
    for regime, state, windows in zip(regimes, states, values, strict=True):
        mean, error = mean_and_error(windows)
        error = np.maximum(error, usual)
        apart = [_apart(mean, error, group, group.error) for group in groups]
        best = min(range(len(groups)), key=lambda k: float(apart[k][0]), default=-1)
        sign = 1
        if best >= 0 and apart[best][0] < SURE:
            sign = int(apart[best][1])
        else:
            groups.append(Group(signs=SIGNS if mirrored else np.ones(len(SIGNS))))
            best = len(groups) - 1
        groups[best].add(regime, state, windows, error, sign)
