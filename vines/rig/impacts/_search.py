"""The search for impacts: steps from a first look at the signals to a train that stays; sensors decide which steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from vines.rig.fit import LEAST, Bins, Fitter, Train
from vines.rig.impacts._pulses import Pulses
from vines.rig.impacts._split import split_flights

__all__ = ["LOOSE", "SIGMAS", "Policy", "Search", "inside", "search", "threshold", "with_silent"]

SIGMAS = 8.0
"""What stands out of noise."""

LOOSE = 1e-4
"""Standard uncertainty of a pulse's time before the delay between two sensors is known, and of times from a
displacement [s]."""

_EDGE = 3e-3
"""Nothing is sought so near to the ends of the record [s]."""

_TWICE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """State of a search.

    Attributes
    ----------
    fitter : Fitter
        Of the fitted channel, with what the search found out about that.
    train : Train
        Impacts found so far, on the clock of the sensor that hears them best.
    candidates : int
        Pulses looked at.
    complete : bool
        Whether the last look at the flights found none that holds another impact.
    delay, u_delay : float
        By how much the fitted channel is later than that sensor, and its standard uncertainty [s].
    drift : float
        Change of that over the record, in standard uncertainties.
    gain : complex or None
        Accelerometer relative to the second derivative of the displacement at the forcing frequency.
    """

    fitter: Fitter
    train: Train
    candidates: int = 0
    complete: bool = False
    delay: float = 0.0
    u_delay: float = 0.0
    drift: float = 0.0
    gain: complex | None = None


State = TypeVar("State", bound=Search)


@dataclass(frozen=True, slots=True)
class Policy(Generic[State]):
    """How impacts are found with a set of sensors.

    Attributes
    ----------
    first, turn, last : tuple of callable
        Steps before the turns, of each turn, and after them; each takes a state and returns another one.
    turns : tuple of int
        Least and largest number of turns.
    at_rest : callable
        Says of the states before and after a turn whether another one is not needed.
    """

    first: tuple[Callable[[State], State], ...]
    turn: tuple[Callable[[State], State], ...]
    last: tuple[Callable[[State], State], ...]
    turns: tuple[int, int]
    at_rest: Callable[[State, State], bool]


def search(policy: Policy[State], found: State) -> State:
    """Return the state that a policy comes to from a first look."""
    for step in policy.first:
        found = step(found)
    least, most = policy.turns
    for turn in range(1, most + 1):
        before = found
        for step in policy.turn:
            found = step(found)
        if turn >= least and policy.at_rest(before, found):
            break
    for step in policy.last:
        found = step(found)
    return found


def inside(bins: Bins, train: Train, edge: float = _EDGE, twice: float = _TWICE) -> Train:
    """Return a train without what is twice or beside the ends of the record."""
    return train.apart(twice).between(bins.t[0] + edge, bins.t[-1] - edge)


def threshold(pulses: Pulses) -> float:
    """Return the least height of the pulse of an impact [m/s^2]."""
    return max(SIGMAS * pulses.noise, LEAST / (pulses.smooth * 2.5))


def with_silent(fitter: Fitter, train: Train, delay: float = 0.0) -> Train:
    """Add impacts that only the motion shows."""
    fit, pushed = fitter.fit_rubbed(train.later(delay), 0)
    return train.merged(split_flights(fitter.bins, fit, fitter.model.order, pushed).later(-delay))
