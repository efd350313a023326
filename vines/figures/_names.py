"""What the figures call quantities and parameters. Declarations are checked against these names: no heavy import."""

from vines.model import VI_NES, most_balls, read_system, system_names

__all__ = ["ERRORS", "MEASURES", "NAMES", "PANELS", "RIG_PANELS", "RUN_PANELS", "SYMBOLS"]

PANELS = {
    "w_dot": r"relative impact velocity  $\dot w$",
    "dt": r"time to next impact  $\Delta t / T$",
    "x1": r"displacement at impact  $x_1$",
    "phase": r"impact phase  $\psi$  [rad]",
}

MEASURES = {
    "max_abs_x1": r"largest displacement  $\max|x_1|$",
    "kinetic_ratio": r"kinetic energies  $K_2/K_1$",
}
"""Quantities of a whole orbit or run."""

RIG_PANELS = ("max_abs_x1", "kinetic_ratio", "w_dot", "phase")
"""Quantities in which rig points are shown beside branches."""

RUN_PANELS = ("ends", "gap", "phase_plane")
"""Panels that show runs: displacements of the cavity's ends and the ball, gap and relative velocity, their plane."""

_PARAMETERS = [
    *(each for name in system_names() for each in read_system(name, most_balls(name)).parameters),
    *VI_NES.parameters,  # a name that several systems have is called as there
]
SYMBOLS = {each.name: each.symbol for each in _PARAMETERS}
NAMES = {each.name: each.label for each in _PARAMETERS}

ERRORS = {
    "max_abs_x1": r"error of $\max|x_1|$",
    "kinetic_ratio": r"error of $K_2/K_1$",
    "w_dot": r"error of $\dot w$",
    "phase": r"error of $\psi$ [rad]",
}
