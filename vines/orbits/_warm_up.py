"""Work that makes numba compile the kernels of this room, one function for each kind of task."""

from __future__ import annotations

import time
from collections.abc import Callable

from vines.model import Params
from vines.orbits._continuation import continue_orbit
from vines.orbits._find import find_orbit
from vines.orbits._follow_curve import follow_curve
from vines.orbits._general import refine
from vines.orbits._table import symmetric_table

__all__ = ["curves", "orbits", "warm_up"]


def orbits() -> None:
    """Find orbits, by word and near a guess, and follow a family over a bifurcation."""
    orbit = find_orbit("LR", Params(mu=0.01, A=0.017))
    refine(orbit.word, orbit.params, orbit)
    symmetric_table(orbit.params.mu, orbit.params.A)
    continue_orbit(find_orbit("LLR", Params(mu=0.01, A=0.0213)), "A", 0.0212)


def curves() -> None:
    """Follow a bifurcation in two parameters."""
    branch = continue_orbit(find_orbit("LLR", Params(mu=0.01, A=0.0213)), "A", 0.0212)
    follow_curve(branch.bifurcations[0], box={"A": (0.02, 0.022), "mu": (0.0099, 0.0101)})


def warm_up(report: Callable[[str], object] = print) -> None:
    """Compile the kernels of the orbits, or load them from the cache, and report one line.

    Parameters
    ----------
    report : callable
        Takes the line.

    Examples
    --------
    >>> lines = []
    >>> warm_up(lines.append)
    >>> len(lines)
    1
    """
    began = time.perf_counter()
    orbits()
    curves()
    report(f"  periodic orbits, families, curves: {time.perf_counter() - began:.1f} s")
