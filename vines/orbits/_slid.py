"""Orbits of a ball that slides: flights are broken by turns and stops, so that no equations close them over impacts."""

from __future__ import annotations

from vines.dynamics.friction import FrictionConstants
from vines.kernels import linked_njit, new_matrix, new_vector, njit
from vines.orbits._equations import closing_kernel, closing_unit, prepared

__all__: list[str] = []


@prepared.register(FrictionConstants)
@njit
def _prepared(c):
    return c


@closing_unit.register(FrictionConstants)
@njit
def _closing_unit(c):
    return 1.0, 1.0


@closing_kernel.register(FrictionConstants)
@linked_njit
def _closing(c, duration, side, t):
    N = t.size
    return False, new_vector(N), new_matrix(N, N), new_matrix(N, 4)
