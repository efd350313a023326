"""The model: parameters and words of impacts. Pure Python, no numba."""

from vines.model._params import LAM_TABLE_1, PARAMETER_NAMES, Params
from vines.model._physical import PhysicalParams

__all__ = ["LAM_TABLE_1", "PARAMETER_NAMES", "Params", "PhysicalParams"]
