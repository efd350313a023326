"""Work that makes numba compile the kernels of this room, one function for each kind of task."""

from __future__ import annotations

import time
from collections.abc import Callable

from vines.dynamics._ensemble import ensemble
from vines.dynamics._saltation import jacobian
from vines.dynamics._scatter import Scatter
from vines.dynamics._simulate import simulate
from vines.dynamics._tangent import lyapunov_spectrum, tangent_map
from vines.kernels import CACHE
from vines.model import Params

__all__ = ["lanes", "runs", "scatter", "timed", "warm_up"]

P = Params(mu=0.1, A=0.3, Omega=1.2)


def runs() -> None:
    """Run one trajectory, and take its measures, samples, tangent map and exponents."""
    run = simulate(P, periods=4)
    run.measures()
    run.sample(16)
    tangent_map(run)
    lyapunov_spectrum(run)
    jacobian(P, 1, -1, (0.3, 0.3, -0.7, -0.8), 0.4, 2.3409392834070411)


def lanes() -> None:
    """Run many trajectories."""
    ensemble(P, periods=1, threads=1)


def scatter() -> None:
    """Run many trajectories with scatter."""
    ensemble(P, periods=1, scatter=Scatter(sigma_r=0.1), threads=1)


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
    4
    """
    report(f"kernels of the dynamics, kept in {CACHE}")
    timed("one run: flight, impact, sticking, energies, samples, tangent map", runs, report)
    timed("ensembles in lanes", lanes, report)
    timed("ensembles with scatter", scatter, report)
