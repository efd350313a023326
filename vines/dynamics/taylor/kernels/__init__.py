"""What rooms above compile into kernels of their own: flights by series, places in states and totals."""

from vines.dynamics.taylor._advance import set_mass
from vines.dynamics.taylor._constants import LENGTH, LONGEST, ROOM
from vines.dynamics.taylor._contacts import flown_from
from vines.dynamics.taylor._energies import (
    TAYLOR_TOTALS,
    VISCOUS_LOSS,
    by_series,
    held_energy,
    peak,
    ride_integrals,
    viscosity,
)
from vines.dynamics.taylor._held import release, ride
from vines.dynamics.taylor._layout import TAYLOR_STATE
from vines.dynamics.taylor._release import release_in_step
from vines.dynamics.taylor._samples import sample_flights
from vines.dynamics.taylor._series import (
    DIRECTIONS,
    DISTURBED,
    SQUARE,
    W,
    X,
    at,
    bounds,
    coefficients,
    cube,
    derivatives_at,
    expand,
    expand_disturbances,
    reach,
    slopes,
    times_square,
)
from vines.dynamics.taylor._tangent import carried, ride_basis

__all__ = [
    "DIRECTIONS",
    "DISTURBED",
    "LENGTH",
    "LONGEST",
    "ROOM",
    "SQUARE",
    "TAYLOR_STATE",
    "TAYLOR_TOTALS",
    "VISCOUS_LOSS",
    "W",
    "X",
    "at",
    "bounds",
    "by_series",
    "carried",
    "coefficients",
    "cube",
    "derivatives_at",
    "expand",
    "expand_disturbances",
    "flown_from",
    "held_energy",
    "peak",
    "reach",
    "release",
    "release_in_step",
    "ride",
    "ride_basis",
    "ride_integrals",
    "sample_flights",
    "set_mass",
    "slopes",
    "times_square",
    "viscosity",
]
