"""A train of impacts: when they were, by how much the velocity jumped, how well the times are known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["U_PULSE", "Train"]

Floats = npt.NDArray[np.float64]
Which = npt.NDArray[np.bool_] | npt.NDArray[np.intp]

U_PULSE = 6e-6
"""Standard uncertainty of an impact time from a pulse of the acceleration [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Train:
    """Impacts in the order of their times, whatever order they are given in.

    Attributes
    ----------
    t : ndarray, shape (K,)
        Times [s].
    dv : ndarray, shape (K,)
        Velocity jumps, or what is known of their sizes [m/s].
    u : ndarray, shape (K,)
        Standard uncertainties of the times [s].

    Examples
    --------
    >>> pulses = Train.alike(np.array([0.3, 0.1]), np.array([3.0, 1.0]), U_PULSE)
    >>> both = pulses.merged(Train.alike(np.array([0.2]), np.array([2.0]), 1e-4))
    >>> both.t, both.dv, both.heard
    (array([0.1, 0.2, 0.3]), array([1., 2., 3.]), array([ True, False,  True]))
    """

    t: Floats
    dv: Floats
    u: Floats

    def __post_init__(self) -> None:
        if np.any(self.t[1:] < self.t[:-1]):
            ahead = np.argsort(self.t, kind="stable")
            for name in ("t", "dv", "u"):
                object.__setattr__(self, name, getattr(self, name)[ahead])

    def __len__(self) -> int:
        return len(self.t)

    @classmethod
    def alike(cls, t: Floats, dv: Floats, u: float) -> Train:
        """Return impacts whose times are equally well known."""
        return cls(t, dv, np.full(len(t), u))

    @property
    def heard(self) -> npt.NDArray[np.bool_]:
        """Which of them have a pulse of the acceleration of their own."""
        return self.u <= U_PULSE

    def only(self, which: Which) -> Train:
        """Return those chosen by flags or places."""
        return Train(self.t[which], self.dv[which], self.u[which])

    def without(self, which: npt.NDArray[np.bool_]) -> Train:
        """Return the others."""
        return self.only(~which)

    def merged(self, other: Train) -> Train:
        """Return both."""
        return Train(*(np.concatenate(pair) for pair in ((self.t, other.t), (self.dv, other.dv), (self.u, other.u))))

    def between(self, low: float, high: float) -> Train:
        """Return those after `low` and before `high` [s]."""
        return self.only((self.t > low) & (self.t < high))

    def apart(self, least: float) -> Train:
        """Return those that are more than so far from the one before [s]."""
        return self.only(np.diff(self.t, prepend=-np.inf) > least)

    def later(self, by: float) -> Train:
        """Return the train on a clock that is so much ahead [s]."""
        return Train(self.t + by, self.dv, self.u)

    def distance(self, t: Floats) -> Floats:
        """Return how far the nearest impact is from each of some times [s]; infinity without any."""
        return np.min(np.abs(t[:, None] - self.t[None, :]), axis=1, initial=np.inf)
