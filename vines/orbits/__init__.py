"""Periodic orbits of words: solution, stability, admissibility, measures, and families of them with bifurcations."""

from vines.orbits import _balls as _balls
from vines.orbits import _capsule as _capsule
from vines.orbits import _dragged as _dragged
from vines.orbits import _modal as _modal
from vines.orbits._all import Orbits, all_orbits
from vines.orbits._branch import Bifurcation, Branch
from vines.orbits._carry import carry_orbit, of_two_mirror_images, one_of
from vines.orbits._cascade import follow_cascade
from vines.orbits._continuation import continue_orbit
from vines.orbits._curve import Curve, SpecialPoint, curve_rows
from vines.orbits._families import Families, follow_families
from vines.orbits._find import find_orbit
from vines.orbits._follow_curve import follow_curve
from vines.orbits._joined import mirror_image
from vines.orbits._margins import Margin
from vines.orbits._optimum import Optimum, optimise
from vines.orbits._orbit import Orbit
from vines.orbits._own_word import own_word
from vines.orbits._partners import partners
from vines.orbits._reduced import Reduced, manifold_amplitude, manifold_range, reduced_orbits, reduced_range
from vines.orbits._rows import bifurcation_row, branch_row, orbit_outline, orbit_row
from vines.orbits._shooting import shoots
from vines.orbits._switch import switch_branch
from vines.orbits._symmetric import symmetric_fold, symmetric_orbits
from vines.orbits._table import symmetric_table
from vines.orbits._warm_up import warm_up
from vines.orbits._words_up_to import words_up_to

__all__ = [
    "Bifurcation",
    "Branch",
    "Curve",
    "Families",
    "Margin",
    "Optimum",
    "Orbit",
    "Orbits",
    "Reduced",
    "SpecialPoint",
    "all_orbits",
    "bifurcation_row",
    "branch_row",
    "carry_orbit",
    "continue_orbit",
    "curve_rows",
    "find_orbit",
    "follow_cascade",
    "follow_curve",
    "follow_families",
    "manifold_amplitude",
    "manifold_range",
    "mirror_image",
    "of_two_mirror_images",
    "one_of",
    "optimise",
    "orbit_outline",
    "orbit_row",
    "own_word",
    "partners",
    "reduced_orbits",
    "reduced_range",
    "shoots",
    "switch_branch",
    "symmetric_fold",
    "symmetric_orbits",
    "symmetric_table",
    "warm_up",
    "words_up_to",
]
