"""Compile every kernel of this room, visibly."""

from __future__ import annotations

from collections.abc import Callable

from vines.attractors._classify import classify_many
from vines.attractors._settle import settle
from vines.dynamics._warm_up import timed
from vines.dynamics._warm_up import warm_up as warm_up_dynamics
from vines.model import Params

__all__ = ["warm_up"]


def warm_up(report: Callable[[str], object] = print) -> None:
    """Compile the kernels of dynamics and attractors, or load them from the cache, with one line for each group.

    Parameters
    ----------
    report : callable
        Takes each line.
    """
    warm_up_dynamics(report)
    p = Params(mu=0.01, A=0.015)
    timed("attractors, one run", lambda: settle(p, settle=200), report)
    timed("attractors, many runs", lambda: classify_many(p, settle=200), report)
