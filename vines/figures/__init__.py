"""Figures: tables in, pictures out. Imports no other room but the errors.

Lazy (PEP 562): names of panels cost nothing; numpy and matplotlib are loaded when something is drawn.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.figures._basins import BasinMap, basins_figure
    from vines.figures._bifurcation import BranchLine, ImpactDots, Marker, bifurcation_figure
    from vines.figures._chart import CurveLine, Region, SpecialMark, chart_figure
    from vines.figures._multipliers import MultiplierLines, multiplier_figure
    from vines.figures._names import ERRORS, NAMES, PANELS, SYMBOLS
    from vines.figures._reduced import ErrorMap, reduced_figure
    from vines.figures._style import COLOURS, save

__all__ = [
    "COLOURS",
    "ERRORS",
    "NAMES",
    "PANELS",
    "SYMBOLS",
    "BasinMap",
    "BranchLine",
    "CurveLine",
    "ErrorMap",
    "ImpactDots",
    "Marker",
    "MultiplierLines",
    "Region",
    "SpecialMark",
    "basins_figure",
    "bifurcation_figure",
    "chart_figure",
    "multiplier_figure",
    "reduced_figure",
    "save",
]

_HOME = {
    "COLOURS": "_style",
    "ERRORS": "_names",
    "NAMES": "_names",
    "PANELS": "_names",
    "SYMBOLS": "_names",
    "BasinMap": "_basins",
    "BranchLine": "_bifurcation",
    "CurveLine": "_chart",
    "ErrorMap": "_reduced",
    "ImpactDots": "_bifurcation",
    "Marker": "_bifurcation",
    "MultiplierLines": "_multipliers",
    "Region": "_chart",
    "SpecialMark": "_chart",
    "basins_figure": "_basins",
    "bifurcation_figure": "_bifurcation",
    "chart_figure": "_chart",
    "multiplier_figure": "_multipliers",
    "reduced_figure": "_reduced",
    "save": "_style",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.figures' has no attribute {name!r}")
    return getattr(import_module(f"vines.figures.{_HOME[name]}"), name)
