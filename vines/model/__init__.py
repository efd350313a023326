"""The model: its declaration, parameters and words of impacts. Pure Python, no numba."""

from vines.model._conversion import dimensionless
from vines.model._declared import counted, most_balls, read_system, system_names, with_all_balls, with_one_ball
from vines.model._expression import Expression
from vines.model._letters import STOPS
from vines.model._parameters import Parameters
from vines.model._params import Params
from vines.model._physical import PhysicalParams
from vines.model._system import Contact, Coordinate, Parameter, Range, System
from vines.model._vi_nes import (
    AMPLITUDE,
    DAMPING,
    FREQUENCY,
    LAM_TABLE_1,
    MASS,
    PARAMETER_NAMES,
    RESTITUTION,
    START_NAMES,
    STATE_NAMES,
    V1,
    V2,
    VI_NES,
    X1,
    X2,
)
from vines.model._words import Word, not_alone, of_moderate_length, word_for

__all__ = [
    "AMPLITUDE",
    "DAMPING",
    "FREQUENCY",
    "LAM_TABLE_1",
    "MASS",
    "PARAMETER_NAMES",
    "RESTITUTION",
    "START_NAMES",
    "STATE_NAMES",
    "STOPS",
    "V1",
    "V2",
    "VI_NES",
    "X1",
    "X2",
    "Contact",
    "Coordinate",
    "Expression",
    "Parameter",
    "Parameters",
    "Params",
    "PhysicalParams",
    "Range",
    "System",
    "Word",
    "counted",
    "dimensionless",
    "most_balls",
    "not_alone",
    "of_moderate_length",
    "read_system",
    "system_names",
    "with_all_balls",
    "with_one_ball",
    "word_for",
]
