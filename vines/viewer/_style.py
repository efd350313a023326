"""Colours of the viewer's pictures: red is the LEFT end of the cavity, blue the RIGHT one, everywhere."""

from __future__ import annotations

__all__ = [
    "BALL",
    "BASE",
    "CAVITY",
    "DAMPER",
    "GRID",
    "IMPACTS",
    "LEFT",
    "LINE",
    "MASS",
    "OURS",
    "OVERLAID",
    "PARAMETERS",
    "PLANE",
    "RIGHT",
    "SPRING",
    "STORED",
    "TRAIL",
]

LEFT = (240, 82, 79)
RIGHT = (77, 148, 255)
BALL = (255, 200, 60)
MASS = (214, 220, 228)
SPRING = (150, 160, 172)
BASE = (110, 200, 140)
DAMPER = (190, 130, 255)
IMPACTS = (255, 140, 66)
STORED = (214, 220, 228)
LINE = (120, 190, 200)
TRAIL = (255, 200, 60)
OVERLAID = ((255, 160, 60), (235, 240, 248), (120, 190, 200), (190, 130, 255))
"""Of runs that are laid over each other, the first one wide."""
GRID = (72, 78, 88)

CAVITY = "Cavity and ball, to scale"
PARAMETERS = "Parameters"
PLANE = "Phase plane"
OURS = (CAVITY, PARAMETERS, PLANE)
"""How names of views begin of which each layout has one; a viewer that shows one has our layout."""
