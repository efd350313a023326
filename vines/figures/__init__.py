"""Figures: tables in, pictures out. Imports no other room but the errors; matplotlib is loaded when one is drawn."""

from vines.figures._bifurcation import BranchLine, ImpactDots, Marker, bifurcation_figure
from vines.figures._style import COLOURS, save

__all__ = ["COLOURS", "BranchLine", "ImpactDots", "Marker", "bifurcation_figure", "save"]
