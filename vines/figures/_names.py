"""What the figures call quantities and parameters. Declarations are checked against these names: no heavy import."""

from vines.model import VI_NES, counted, system_names, with_all_balls

__all__ = ["ERRORS", "MEASURES", "NAMES", "PANELS", "QUANTITIES", "RIG_PANELS", "RUN_PANELS", "SYMBOLS"]

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

QUANTITIES = {
    **MEASURES,
    "reduction": r"reduction of $\max|x_1|$",
    "rms_x1": r"root mean square of $x_1$",
    "impact_power": "power lost in impacts",
    "electric_power": "power of the coil",
    "electric_share": "share that goes to the coil",
    **{f"modal_energy_{k}": f"mean energy of mode {k}" for k in range(1, counted("modes")[1] + 1)},
    **{f"modal_loss_{k}": f"power of the damper of mode {k}" for k in range(1, counted("modes")[1] + 1)},
    "impacts_per_period": "impacts in a forcing period",
    "lyapunov": "largest Lyapunov exponent",
    "impact_share": "share lost in impacts",
    "damper_share": "share lost in the damper",
    "left_share": "share left at the end",
    "t_tenth": r"time until 10 % is left  $\omega_0 t$",
    "t_hundredth": r"time until 1 % is left  $\omega_0 t$",
    "impacts": "impacts",
    "t_first": r"time of the first impact  $\omega_0 t$",
    "t_last": r"time of the last impact  $\omega_0 t$",
}
"""What columns of points and transients are called beside an axis; others by their own names."""

RIG_PANELS = ("max_abs_x1", "kinetic_ratio", "w_dot", "phase")
"""Quantities in which rig points are shown beside branches."""

RUN_PANELS = ("ends", "gap", "phase_plane")
"""Panels that show runs: displacements of the cavity's ends and the ball, gap and relative velocity, their plane."""

_PARAMETERS = [
    *(each for name in system_names() for each in with_all_balls(name).parameters),
    *VI_NES.parameters,  # a name that several systems have is called as there
]
SYMBOLS = {each.name: each.symbol for each in _PARAMETERS} | {"V": "V", "level": r"\ell"}
NAMES = {each.name: each.label for each in _PARAMETERS} | {"V": "velocity at the start", "level": "factor on the noise"}

ERRORS = {
    "max_abs_x1": r"error of $\max|x_1|$",
    "kinetic_ratio": r"error of $K_2/K_1$",
    "w_dot": r"error of $\dot w$",
    "phase": r"error of $\psi$ [rad]",
}
