"""The declaration of the vibro-impact nonlinear energy sink, from which every room takes its names and limits."""

from __future__ import annotations

import math

from vines.model._system import Body, Contact, Coordinate, Energies, Parameter, Range, Symmetry, System

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
    "V1",
    "V2",
    "VI_NES",
    "X1",
    "X2",
]

LAM_TABLE_1 = 2.53 / math.sqrt(11680.0 * 3.807)
"""c/(M omega0) from Table 1 of the paper, .0119979670…; the paper prints the truncated .01199."""

_POSITIVE = Range(0, above=True)
_NOT_NEGATIVE = Range(0)
_SHARE = Range(0, 1)
_RESTITUTION = "r is the coefficient of restitution"

VI_NES = System(
    name="vi-nes",
    parameters=(
        Parameter(
            name="mu",
            text="Mass ratio m/M",
            allowed=_POSITIVE,
            why="mu is the mass ratio m/M",
            source="paper, section 2",
            symbol=r"\mu",
            label="mass ratio",
        ),
        Parameter(
            name="A",
            text="Forcing amplitude E/b",
            allowed=_NOT_NEGATIVE,
            why="a negative amplitude is a phase shift of half a period",
            source="paper, section 2",
            symbol="A",
            label="forcing amplitude",
        ),
        Parameter(
            name="Omega",
            text="Frequency ratio omega/omega0",
            allowed=_POSITIVE,
            why="Omega is the frequency ratio omega/omega0",
            default=1.0,
            source="paper, section 2",
            symbol=r"\Omega",
            label="frequency ratio",
        ),
        Parameter(
            name="r",
            text="Coefficient of restitution",
            allowed=_SHARE,
            why=_RESTITUTION,
            default=0.65,
            source="paper, eq. (9)",
            symbol="r",
            label="restitution",
        ),
        Parameter(
            name="lam",
            text="Damping c/(M omega0)",
            allowed=Range(0, 2, below=True),
            why="the oscillator must be underdamped",
            default=LAM_TABLE_1,
            source="paper, eq. (6)",
            symbol=r"\lambda",
            label="damping",
        ),
    ),
    rig=(
        Parameter("M", "Mass of the linear oscillator", _POSITIVE, default=3.807, unit="kg"),
        Parameter("c", "Damping coefficient", _NOT_NEGATIVE, default=2.53, unit="N s/m"),
        Parameter("k", "Linear stiffness", _POSITIVE, default=11680.0, unit="N/m"),
        Parameter("b", "Half the length of the cavity", _POSITIVE, default=0.015, unit="m"),
        Parameter("r", "Coefficient of restitution", _SHARE, _RESTITUTION, default=0.65),
    ),
    run=(
        Parameter("E", "Amplitude of the base displacement", _NOT_NEGATIVE, unit="m"),
        Parameter("omega", "Angular frequency of the base", _POSITIVE, unit="rad/s"),
        Parameter("m", "Mass of the ball", _POSITIVE, unit="kg"),
    ),
    bodies=(
        Body(
            "oscillator",
            Coordinate("x1", "Position of the oscillator", "x_1", source="paper, eq. (8)"),
            Coordinate("v1", "Velocity of the oscillator", "x_1'", source="paper, eq. (8)"),
        ),
        Body(
            "ball",
            Coordinate("x2", "Position of the ball", "x_2", source="paper, eq. (8)"),
            Coordinate("v2", "Velocity of the ball", "x_2'", start=0.1, source="paper, eq. (8)"),
        ),
    ),
    phase=Coordinate(
        name="phase",
        text="Forcing phase (Omega t + phi) mod 2 pi",
        symbol=r"\phi",
        unit="rad",
        source="paper, eq. (8)",
        allowed=Range(0, math.nextafter(2 * math.pi, 7)),
    ),
    contacts=(Contact("L", 1, "left end of the cavity"), Contact("R", -1, "right end of the cavity")),
    mirror=Symmetry(sign=-1, shift=0.5, letters={"L": "R", "R": "L"}),
    energies=Energies(
        stored=("kinetic_1", "kinetic_2", "potential"),
        gained=("base_work",),
        lost=("damper_loss", "impact_loss"),
    ),
)
"""One oscillator under base excitation with one ball in its cavity (paper, section 2)."""

PARAMETER_NAMES = tuple(parameter.name for parameter in VI_NES.parameters)
STATE_NAMES = tuple(coordinate.name for coordinate in VI_NES.state)
START_NAMES = tuple(coordinate.name for coordinate in VI_NES.start)

MASS, AMPLITUDE, FREQUENCY, RESTITUTION, DAMPING = range(len(PARAMETER_NAMES))
"""Places of mu, A, Omega, r, lam in arrays and kernels."""

X1, V1, X2, V2 = range(len(STATE_NAMES))
"""Places of the state in arrays and kernels."""
