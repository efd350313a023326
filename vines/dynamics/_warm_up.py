"""Compile every kernel of this room, visibly."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from vines.dynamics._ensemble import ensemble
from vines.dynamics._saltation import jacobian
from vines.dynamics._scatter import Scatter
from vines.dynamics._simulate import simulate
from vines.dynamics._tangent import lyapunov_spectrum, tangent_map
from vines.kernels import CACHE
from vines.model import Params

__all__ = ["timed", "warm_up"]


def timed(name: str, work: Callable[[], object], report: Callable[[str], object]) -> None:
    """Do the work and report one line with its name and how long it took."""
    began = time.perf_counter()
    work()
    report(f"  {name}: {time.perf_counter() - began:.1f} s")


def warm_up(report: Callable[[str], object] = print) -> None:
    """Compile the kernels of the dynamics, or load them from the cache, with one line for each group.

    Parameters
    ----------
    report : callable
        Takes each line.

    Examples
    --------
    >>> lines = []
    >>> warm_up(lines.append)
    >>> len(lines)
    8
    """
    report(f"kernels of the dynamics, kept in {CACHE}")
    p = Params(mu=0.1, A=0.3, Omega=1.2)
    runs = []
    timed("flight, impact, next impact, sticking", lambda: runs.append(simulate(p, periods=4)), report)
    run = runs[0]
    timed("energies and largest displacement", run.measures, report)
    timed("samples", lambda: run.sample(16), report)
    timed("tangent map, Lyapunov exponents", lambda: (tangent_map(run), lyapunov_spectrum(run)), report)
    before = np.array([0.3, 0.3, -0.7, -0.8])
    timed("Jacobian of an impact map", lambda: jacobian(p, 1, -1, tuple(before), 0.4, 2.3409392834070411), report)
    timed("ensembles in lanes", lambda: ensemble(p, periods=1, threads=1), report)
    timed("ensembles with scatter", lambda: ensemble(p, periods=1, scatter=Scatter(sigma_r=0.1), threads=1), report)
