"""How gravity along the cavities acts on a free ball: bodies for every system whose constants have G."""

from __future__ import annotations

from vines.kernels import fused_njit

__all__ = ["falling_ball", "pull_of_tilt"]


@fused_njit
def falling_ball(c, v2, tau):
    """Return what `free_ball` does, for a ball that falls with x2'' = -G."""
    return tau * (v2 - 0.5 * c.G * tau), v2 - c.G * tau


@fused_njit
def pull_of_tilt(c, a):
    """Return what `pull` does, against a ball that falls with x2'' = -G."""
    return a + c.G
