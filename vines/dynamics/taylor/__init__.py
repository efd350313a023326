"""Motion that no closed form gives: series of order 20 in time, and contacts certified on their polynomials.

docs/dynamics.md, "Taylor series".
"""

from vines.dynamics.taylor import _advance as _advance
from vines.dynamics.taylor import _energies as _energies
from vines.dynamics.taylor import _tangent as _tangent
from vines.dynamics.taylor._constants import ORDER, Field, TaylorConstants, TaylorTable, taylor_constants
from vines.dynamics.taylor._run import SeriesRun, TaylorMeasures, TaylorRun, spring_energy, taylor_measures

__all__ = [
    "ORDER",
    "Field",
    "SeriesRun",
    "TaylorConstants",
    "TaylorMeasures",
    "TaylorRun",
    "TaylorTable",
    "spring_energy",
    "taylor_constants",
    "taylor_measures",
]
