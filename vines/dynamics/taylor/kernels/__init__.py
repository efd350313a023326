"""What rooms above compile into kernels of their own: flights by series, places in states and totals."""

from vines.dynamics.taylor._advance import set_mass
from vines.dynamics.taylor._contacts import flown_from
from vines.dynamics.taylor._energies import TAYLOR_TOTALS, VISCOUS_LOSS
from vines.dynamics.taylor._layout import TAYLOR_STATE
from vines.dynamics.taylor._series import W, X, at, bounds, coefficients, derivatives_at, expand, slopes

__all__ = [
    "TAYLOR_STATE",
    "TAYLOR_TOTALS",
    "VISCOUS_LOSS",
    "W",
    "X",
    "at",
    "bounds",
    "coefficients",
    "derivatives_at",
    "expand",
    "flown_from",
    "set_mass",
    "slopes",
]
