"""Periodic orbits of words: solution, stability, admissibility, measures, and families of them with bifurcations."""

from vines.orbits._branch import Bifurcation, Branch
from vines.orbits._continuation import continue_orbit
from vines.orbits._find import find_orbit
from vines.orbits._orbit import Orbit
from vines.orbits._rows import bifurcation_row, branch_row, orbit_row
from vines.orbits._symmetric import symmetric_fold, symmetric_orbits
from vines.orbits._warm_up import warm_up

__all__ = [
    "Bifurcation",
    "Branch",
    "Orbit",
    "bifurcation_row",
    "branch_row",
    "continue_orbit",
    "find_orbit",
    "orbit_row",
    "symmetric_fold",
    "symmetric_orbits",
    "warm_up",
]
