"""The vibro-impact nonlinear energy sink, from whose declaration every room takes its names and limits."""

from __future__ import annotations

from vines.model._declared import read_system

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

VI_NES = read_system("vi_nes", digest="d5aff166fcfd20a0")
"""One oscillator under base excitation with one ball in its cavity (paper, section 2)."""

PARAMETER_NAMES = tuple(parameter.name for parameter in VI_NES.parameters)
STATE_NAMES = tuple(coordinate.name for coordinate in VI_NES.state)
START_NAMES = tuple(coordinate.name for coordinate in VI_NES.start)

MASS, AMPLITUDE, FREQUENCY, RESTITUTION, DAMPING = range(len(PARAMETER_NAMES))
"""Places of mu, A, Omega, r, lam in arrays and kernels."""

X1, V1, X2, V2 = range(len(STATE_NAMES))
"""Places of the state in arrays and kernels."""

LAM_TABLE_1: float = VI_NES.parameter("lam").check(VI_NES.parameter("lam").default)
"""c/(M omega0) from Table 1 of the paper, .0119979670…; the paper prints the truncated .01199."""
