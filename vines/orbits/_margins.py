"""How far an orbit may move in each parameter before something happens to it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vines.errors import OrbitNotFound
from vines.model import PARAMETER_NAMES
from vines.orbits._continuation import continue_orbit
from vines.orbits._orbit import Orbit

__all__ = ["Margin", "margins_of"]

_STRIDES = (1 / 16, 1 / 4, 1.0)
"""Parts of the reach that are walked in turn, so that a near bifurcation is found without walking to the end."""

NOTHING = ("range", "lost")
"""What ends a search that met no bifurcation: its reach, or a branch that could not be followed further."""


@dataclass(frozen=True)
class Margin:
    """The first bifurcation below and above a value of one parameter, the others held.

    Attributes
    ----------
    parameter : str
    here : float
        Value at the orbit.
    below, above : float
        Values at the first bifurcation, or where the search ended.
    below_type, above_type : str
        Type of the bifurcation; ``range`` if none was met up to there, ``lost`` if the branch could not be followed.
    """

    parameter: str
    here: float
    below: float
    below_type: str
    above: float
    above_type: str

    @property
    def nearest(self) -> tuple[float, str]:
        """Distance to the nearer bifurcation, relative to the value, and its type; inf and "" if none was met."""
        met = [
            (abs(value - self.here) / abs(self.here) if self.here else math.inf, kind)
            for value, kind in ((self.below, self.below_type), (self.above, self.above_type))
            if kind not in NOTHING
        ]
        return min(met, default=(math.inf, ""))


def margins_of(orbit: Orbit) -> dict[str, Margin]:
    """Return the margins of a stable admissible orbit in every parameter.

    The search goes from a quarter of mu, A and lam to four times them, half of Omega to one and a half, and 0.3 either
    way in r.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import find_orbit
    >>> margin = margins_of(find_orbit("LR", Params(mu=0.01, A=0.016)))["A"]
    >>> print(f"{margin.below_type} {margin.below:.6f}, {margin.above_type} {margin.above:.6f}")
    neimark_sacker 0.009480, symmetry_breaking 0.018008
    """
    return {name: _margin(orbit, name) for name in PARAMETER_NAMES}


def _margin(orbit: Orbit, name: str) -> Margin:
    here = getattr(orbit.params, name)
    low, high = _reach(name, here)
    return Margin(name, here, *_first(orbit, name, low), *_first(orbit, name, high))


def _reach(name: str, here: float) -> tuple[float, float]:
    if name == "r":
        return max(0.0, here - 0.3), min(1.0, here + 0.3)
    if name == "Omega":
        return 0.5 * here, 1.5 * here
    if name == "lam":
        return here / 4, min(max(4 * here, 0.04), 1.9)
    return here / 4, 4 * here


def _first(orbit: Orbit, name: str, end: float) -> tuple[float, str]:
    """Return value and type of the first bifurcation on the way to `end`."""
    here = getattr(orbit.params, name)
    if end == here:
        return end, "range"
    for stride in _STRIDES:
        stop = end if stride == 1 else here + stride * (end - here)
        try:
            branch = continue_orbit(orbit, name, stop)
        except OrbitNotFound:
            return getattr(orbit.params, name), "lost"
        if branch.bifurcations:
            return branch.bifurcations[0].value, branch.bifurcations[0].type
        orbit = branch.orbits[-1]
        value = getattr(orbit.params, name)
        if branch.ends[1] == "range" and value != stop:
            # The branch turned back at once: the fold is where it began, to rounding.
            return value, "fold"
        if branch.ends[1] != "range":
            return value, "lost"
    return end, "range"
