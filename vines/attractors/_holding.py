"""How long regimes hold: means with censored runs, their intervals, and where a chain of regimes is in the long run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.domains import Number, Whole, stated

__all__ = ["LEVEL", "Holding", "mean_interval", "stationary_law"]

Floats = npt.NDArray[np.float64]

LEVEL = 0.95
"""Chance with which an interval holds the true value."""

DRAWS = 4000
"""Draws of the rates from which the interval of the stationary law is taken."""


@dataclass(frozen=True)
class Holding:
    """How long a regime holds.

    Attributes
    ----------
    regime : int
        Which one.
    method : str
        ``runs`` or ``splitting``.
    runs : int
        How many were watched.
    exits : int
        How many of them left it.
    watched : float
        Forcing periods that all of them were in it, censored ones included.
    mean, low, high : float
        Mean time until it is left, in forcing periods, with the ends of its interval of 95 %; infinite where no exit
        was seen, nan where `remark` says why none can be told.
    to : mapping of int to int
        Exits to each regime.
    early : int
        Runs that left it before they were counted.
    relative_error : float
        Of a rate by splitting its relative standard error, else nan.
    remark : str
        Why a splitting tells no mean, else empty.
    """

    regime: int
    method: str
    runs: int
    exits: int
    watched: float
    mean: float
    low: float
    high: float
    to: Mapping[int, int]
    early: int = 0
    relative_error: float = math.nan
    remark: str = ""


@stated(exits=Whole(least=0, most=10**9), watched=Number(above=0, most=1e15), level=Number(least=1e-6, most=1 - 1e-6))
def mean_interval(exits: int, watched: float, level: float = LEVEL) -> tuple[float, float, float]:
    """Return the mean time to an exit and its interval, for exits at a constant rate and runs that may be cut.

    Parameters
    ----------
    exits : int
        Exits seen.
    watched : float
        Time watched in all, that of runs without an exit included.
    level : float
        Chance with which the interval holds the mean, or more.

    Returns
    -------
    mean, low, high : float
        watched/exits; and the ends 2 watched/chi2 with 2 exits + 2 and 2 exits degrees of freedom, as of a Poisson
        count (Garwood 1936). Mean and upper end are infinite without an exit.

    Examples
    --------
    >>> [round(x, 1) for x in mean_interval(10, 1000.0)]
    [100.0, 54.4, 208.5]
    >>> mean_interval(0, 300.0)[1] > 80
    True
    """
    from scipy.stats import chi2

    tail = 0.5 * (1.0 - level)
    low = 2.0 * watched / float(chi2.ppf(1.0 - tail, 2 * exits + 2))
    if not exits:
        return math.inf, low, math.inf
    return watched / exits, low, 2.0 * watched / float(chi2.ppf(tail, 2 * exits))


def stationary_law(holdings: Sequence[Holding], seed: int = 0) -> tuple[Floats, Floats, Floats]:
    """Return which share of the time a run is in each regime in the long run, and the interval of each share.

    The regimes are the states of a Markov chain. The rate from i to j has Jeffreys' law, that of n_ij exits in the time
    watched, with half an exit shared among those that were not seen: so there is a share where no exit was. The shares
    are those at the mean rates, intervals of 95 % from draws of the rates.

    Parameters
    ----------
    holdings : sequence of Holding
        One for each regime, in their order.
    seed : int
        Of the draws.

    Returns
    -------
    share, low, high : ndarray, shape (m,)

    Examples
    --------
    >>> two = [Holding(0, "runs", 9, 9, 900.0, 100, 0, 0, {1: 9}), Holding(1, "runs", 9, 9, 100.0, 11, 0, 0, {0: 9})]
    >>> stationary_law(two)[0].round(3)
    array([0.9, 0.1])
    """
    m = len(holdings)
    if m == 1:
        return np.ones(1), np.ones(1), np.ones(1)
    shape, scale = np.zeros((m, m)), np.zeros(m)
    for i, each in enumerate(holdings):
        known = np.array([each.to.get(j, 0) for j in range(m)], dtype=float)
        known[i] = 0.0
        half = np.full(m, 0.5 / (m - 1))
        half[i] = 0.0
        shape[i], scale[i] = known + half, _time_of(each, float(known.sum()))
    mean = _law(shape / scale[:, None])
    rates = np.random.default_rng(seed).standard_gamma(shape, (DRAWS, m, m)) / scale[:, None]
    drawn = _law(rates)
    low, high = np.quantile(drawn, [0.5 * (1 - LEVEL), 0.5 * (1 + LEVEL)], axis=0)
    return mean, low, high


def _time_of(each: Holding, exits: float) -> float:
    """Return the time in which so many exits stand for the rate that was found."""
    if each.method == "runs" or not (exits and math.isfinite(each.mean)):
        return each.watched
    return exits * each.mean


def _law(rates: Floats) -> Floats:
    """Return the stationary law of chains with these rates, the rates of a chain in the last two axes."""
    m = rates.shape[-1]
    flow = np.swapaxes(rates, -1, -2).copy()
    at = np.arange(m)
    flow[..., at, at] = -rates.sum(axis=-1)
    flow /= np.maximum(rates.max(axis=(-1, -2)), 1e-300)[..., None, None]
    flow[..., -1, :] = 1.0
    right = np.zeros((*flow.shape[:-1], 1))
    right[..., -1, 0] = 1.0
    return np.clip(np.linalg.solve(flow, right)[..., 0], 0.0, 1.0)
