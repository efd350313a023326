"""Plots, a file each, and what they share; a file without underscore is the plot of that name.

A plot is one registered thing: its options, what it needs, and how rows become a picture. docs/pipelines.md.
"""

from vines.stages.plots._look import LookOptions, check_look, worn_by
from vines.stages.plots._plot import PLOTS, Plot, PlotOptions, plot_of, register
from vines.stages.plots._width import inches

__all__ = ["PLOTS", "LookOptions", "Plot", "PlotOptions", "check_look", "inches", "plot_of", "register", "worn_by"]
