"""What the cubic spring of the frame holds; no damper is beside the ball."""

from __future__ import annotations

from vines.dynamics.duffing._constants import DuffingField
from vines.dynamics.taylor.kernels import held_energy, viscosity
from vines.kernels import fused_njit, njit

__all__: list[str] = []


@held_energy.register(DuffingField)
@njit
def _held_energy(f, x1, x2):
    return 0.25 * f.alpha * (x1 * x1) * (x1 * x1)


@viscosity.register(DuffingField)
@fused_njit
def _viscosity(f):
    return 0.0
