"""Figures: tables in, pictures out. Imports no other room but the errors.

Lazy (PEP 562): names of panels cost nothing; numpy and matplotlib are loaded when something is drawn. Where matplotlib
is missing, a function that draws says so when it is imported.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from vines.packages import need

if TYPE_CHECKING:
    from vines.figures._basins import BasinMap, basins_figure
    from vines.figures._bifurcation import bifurcation_figure
    from vines.figures._chart import CurveLine, Region, SpecialMark, chart_figure
    from vines.figures._diagram import BranchLine, ImpactDots, Marker
    from vines.figures._diagram_panel import DiagramPanel
    from vines.figures._energy import FOUND, EnergyCurve, EnergyPanel
    from vines.figures._multipliers import MultiplierLines, MultiplierPanel, multiplier_figure
    from vines.figures._names import ERRORS, MEASURES, NAMES, PANELS, RIG_PANELS, RUN_PANELS, SYMBOLS
    from vines.figures._reduced import ErrorMap, reduced_figure
    from vines.figures._regimes import REGIME_CLASSES, RegimeMap, regimes_figure
    from vines.figures._response import VelocityPanel, response_figure
    from vines.figures._rig_branches import RigPoints, rig_branches_figure
    from vines.figures._rig_cycles import RigCycle, rig_cycles_figure, rig_waits_figure
    from vines.figures._rig_residual import rig_residual_figure
    from vines.figures._runs import EndsPanel, GapPanel, PhasePlanePanel, RunCurves
    from vines.figures._sheet import Panel, sheet_figure
    from vines.figures._style import COLOURS, PALETTE, save

__all__ = [
    "COLOURS",
    "ERRORS",
    "FOUND",
    "MEASURES",
    "NAMES",
    "PALETTE",
    "PANELS",
    "REGIME_CLASSES",
    "RIG_PANELS",
    "RUN_PANELS",
    "SYMBOLS",
    "BasinMap",
    "BranchLine",
    "CurveLine",
    "DiagramPanel",
    "EndsPanel",
    "EnergyCurve",
    "EnergyPanel",
    "ErrorMap",
    "GapPanel",
    "ImpactDots",
    "Marker",
    "MultiplierLines",
    "MultiplierPanel",
    "Panel",
    "PhasePlanePanel",
    "RegimeMap",
    "Region",
    "RigCycle",
    "RigPoints",
    "RunCurves",
    "SpecialMark",
    "VelocityPanel",
    "basins_figure",
    "bifurcation_figure",
    "chart_figure",
    "multiplier_figure",
    "reduced_figure",
    "regimes_figure",
    "response_figure",
    "rig_branches_figure",
    "rig_cycles_figure",
    "rig_residual_figure",
    "rig_waits_figure",
    "save",
    "sheet_figure",
]

_HOME = {
    "sheet_figure": "_sheet",
    "Panel": "_sheet",
    "RunCurves": "_runs",
    "PhasePlanePanel": "_runs",
    "GapPanel": "_runs",
    "EndsPanel": "_runs",
    "RUN_PANELS": "_names",
    "MultiplierPanel": "_multipliers",
    "Marker": "_diagram",
    "ImpactDots": "_diagram",
    "DiagramPanel": "_diagram_panel",
    "BranchLine": "_diagram",
    "COLOURS": "_style",
    "ERRORS": "_names",
    "EnergyCurve": "_energy",
    "EnergyPanel": "_energy",
    "FOUND": "_energy",
    "MEASURES": "_names",
    "NAMES": "_names",
    "RIG_PANELS": "_names",
    "RigCycle": "_rig_cycles",
    "RigPoints": "_rig_branches",
    "rig_branches_figure": "_rig_branches",
    "rig_cycles_figure": "_rig_cycles",
    "rig_residual_figure": "_rig_residual",
    "rig_waits_figure": "_rig_cycles",
    "PALETTE": "_style",
    "PANELS": "_names",
    "SYMBOLS": "_names",
    "BasinMap": "_basins",
    "CurveLine": "_chart",
    "ErrorMap": "_reduced",
    "MultiplierLines": "_multipliers",
    "REGIME_CLASSES": "_regimes",
    "RegimeMap": "_regimes",
    "regimes_figure": "_regimes",
    "Region": "_chart",
    "SpecialMark": "_chart",
    "basins_figure": "_basins",
    "bifurcation_figure": "_bifurcation",
    "chart_figure": "_chart",
    "multiplier_figure": "_multipliers",
    "reduced_figure": "_reduced",
    "response_figure": "_response",
    "save": "_style",
    "VelocityPanel": "_response",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vines.figures' has no attribute {name!r}")
    if name == "save" or name.endswith("_figure"):
        need("matplotlib")
    return getattr(import_module(f"vines.figures.{_HOME[name]}"), name)
