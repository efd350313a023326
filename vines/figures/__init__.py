"""Figures: tables in, pictures out. Imports no other room but the errors; matplotlib is loaded when one is drawn."""

from vines.figures._bifurcation import PANELS, SYMBOLS, BranchLine, ImpactDots, Marker, bifurcation_figure
from vines.figures._reduced import ERRORS, ErrorMap, reduced_figure
from vines.figures._style import COLOURS, save

__all__ = [
    "COLOURS",
    "ERRORS",
    "PANELS",
    "SYMBOLS",
    "BranchLine",
    "ErrorMap",
    "ImpactDots",
    "Marker",
    "bifurcation_figure",
    "reduced_figure",
    "save",
]
