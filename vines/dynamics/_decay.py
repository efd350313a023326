"""How a disturbance decays: where its energy goes, and when little of it is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.dynamics._trajectory import Trajectory
from vines.errors import StateError

__all__ = ["Decay", "decay"]

_PLACES = 65
"""Samples with which a flight is narrowed down; each round leaves a 64th of it."""
_ROUNDS = 9
"""So many rounds leave less than rounding of any flight."""


@dataclass(frozen=True, slots=True)
class Decay:
    """Where the energy of an undriven run went.

    Attributes
    ----------
    energy : float
        Energy at the start, in units of M b² omega0².
    impact_share, damper_share, frame_share, ball_share : float
        Shares of it that were lost in impacts and in the damper, and that oscillator and ball have at the end; their
        sum is 1 to rounding.
    times : tuple of float
        When no more than each of the shares asked for is left for the first time, nan where that is not in the run.
    impacts : int
        Impacts in the run.
    first_impact, last_impact : float
        Times of the first and the last, nan if there is none.
    """

    energy: float
    impact_share: float
    damper_share: float
    frame_share: float
    ball_share: float
    times: tuple[float, ...]
    impacts: int
    first_impact: float
    last_impact: float


def decay(run: Trajectory, shares: Sequence[float] = (0.1, 0.01)) -> Decay:
    """Return where the energy of a run without forcing went.

    Parameters
    ----------
    run : Trajectory
        With A = 0.
    shares : sequence of float
        Shares of the energy at the start that the times are wanted of.

    Raises
    ------
    StateError
        If the run is driven, or has no energy at its start.

    Examples
    --------
    >>> from vines.dynamics import simulate
    >>> from vines.model import Params
    >>> found = decay(simulate(Params(mu=0.02, A=0.0), v1=2.0, v2=0.0, periods=20))
    >>> found.impacts, round(2 * found.impact_share, 6), round(found.times[0], 4)
    (54, 0.718833, 114.579)
    """
    if run.params.A != 0:
        raise StateError(f"A is {run.params.A:g}; energy decays where nothing drives: give A = 0")
    samples = run.sample(n=2, at_events=True)
    energies = _energy(samples)
    start, end = float(energies[0]), samples[-1]
    if not start > 0:
        raise StateError("nothing moves at the start; give a velocity that is not 0")
    hits = run.impacts["t"]
    return Decay(
        energy=start,
        impact_share=float(end["impact_loss"]) / start,
        damper_share=float(end["damper_loss"]) / start,
        frame_share=float(end["kinetic_1"] + end["potential"]) / start,
        ball_share=float(end["kinetic_2"]) / start,
        times=tuple(_reaches(run, samples["t"], energies, share * start) for share in shares),
        impacts=len(hits),
        first_impact=float(hits[0]) if len(hits) else np.nan,
        last_impact=float(hits[-1]) if len(hits) else np.nan,
    )


def _energy(samples: npt.NDArray[np.void]) -> npt.NDArray[np.float64]:
    return samples["kinetic_1"] + samples["kinetic_2"] + samples["potential"]


def _reaches(run: Trajectory, t: npt.NDArray[np.float64], energies: npt.NDArray[np.float64], level: float) -> float:
    """Return when the energy, which never grows, has fallen to a level: at an impact or inside a flight."""
    below = np.flatnonzero(energies <= level)
    if not len(below):
        return np.nan
    k = int(below[0])
    low, high = float(t[max(k - 1, 0)]), float(t[k])
    for _ in range(_ROUNDS):
        if not low < high:
            break
        places = np.linspace(low, high, _PLACES)
        # the last place is the end, which an impact there may have lowered
        under = np.append(_energy(run.sample(times=places[1:-1])) <= level, True)
        first = int(np.argmax(under))
        low, high = float(places[first]), float(places[first + 1])
    return high
