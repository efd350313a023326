"""Colours of the viewer's pictures: red is the LEFT end of the cavity, blue the RIGHT one, everywhere."""

from __future__ import annotations

__all__ = [
    "BALL",
    "BALLS",
    "BASE",
    "BESIDE",
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
    "STOPPED",
    "STORED",
    "TRAIL",
]

LEFT = (240, 82, 79)
RIGHT = (77, 148, 255)
BALL = (255, 200, 60)
BALLS = (
    *(BALL, (255, 128, 200), (160, 230, 90), (172, 146, 255)),
    *((72, 226, 206), (255, 150, 80), (226, 230, 236), (196, 156, 112)),
)
"""Of several balls, unlike the ends of their cavities; the side of an impact is then its shape."""
BESIDE = BALLS[1]
"""A mass on a spring beside the ball."""
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
STOPPED = (158, 162, 170)
"""Of a ball that friction holds in mid-cavity."""

CAVITY = "Cavity and ball, to scale"
PARAMETERS = "Parameters"
PLANE = "Phase plane"
OURS = (CAVITY, PARAMETERS, PLANE)
"""How names of views begin of which each layout has one; a viewer that shows one has our layout."""
