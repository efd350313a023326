"""The model: parameters and words of impacts. Pure Python, no numba."""

from vines.model._params import LAM_TABLE_1, PARAMETER_NAMES, Params
from vines.model._physical import PhysicalParams
from vines.model._words import Word

__all__ = ["LAM_TABLE_1", "PARAMETER_NAMES", "Params", "PhysicalParams", "Word"]
