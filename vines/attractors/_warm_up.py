"""Work that makes numba compile the kernels of this room, one function for each kind of task."""

from __future__ import annotations

from collections.abc import Callable

from vines.attractors._classify import classify_many
from vines.attractors._exit_times import exits
from vines.attractors._settle import settle
from vines.dynamics import Scatter
from vines.dynamics import warm_up as warm_up_dynamics
from vines.dynamics.runs import timed
from vines.model import Params

__all__ = ["many_runs", "noise", "one_run", "warm_up"]

P = Params(mu=0.01, A=0.015)


def one_run() -> None:
    """Settle one run."""
    settle(P, settle=200)


def many_runs() -> None:
    """Classify many runs."""
    classify_many(P, settle=200)


def noise() -> None:
    """Watch runs with noise."""
    exits(P, Scatter(noise=0.01), runs=1, periods=1, random=0, settle=200, threads=1)


def warm_up(report: Callable[[str], object] = print) -> None:
    """Compile the kernels of dynamics and attractors, or load them from the cache, with one line for each group.

    Parameters
    ----------
    report : callable
        Takes each line.
    """
    warm_up_dynamics(report)
    timed("attractors, one run", one_run, report)
    timed("attractors, many runs", many_runs, report)
    timed("regimes under noise", noise, report)
