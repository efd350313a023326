"""vines: reproducible studies of the vibro-impact nonlinear energy sink.

The names below are loaded when they are first used, so that ``import vines`` costs next to nothing.

Examples
--------
>>> import vines
>>> p = vines.Params(mu=0.01, A=0.015)
>>> vines.settle(p).name
'1:1'
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "Params": "vines.model",
    "PhysicalParams": "vines.model",
    "Word": "vines.model",
    "Trajectory": "vines.dynamics",
    "ball_locked": "vines.dynamics",
    "no_ball": "vines.dynamics",
    "Ensemble": "vines.dynamics",
    "Scatter": "vines.dynamics",
    "ensemble": "vines.dynamics",
    "simulate": "vines.dynamics",
    "Attractor": "vines.attractors",
    "classify_many": "vines.attractors",
    "settle": "vines.attractors",
    "Branch": "vines.orbits",
    "Orbit": "vines.orbits",
    "all_orbits": "vines.orbits",
    "continue_orbit": "vines.orbits",
    "find_orbit": "vines.orbits",
    "OrbitNotFound": "vines.errors",
    "VinesError": "vines.errors",
    "query": "vines.stages",
    "Study": "vines.stages",
    "run": "vines.stages",
    "study": "vines.stages",
    "table": "vines.stages",
}

__all__ = [
    "Attractor",
    "Branch",
    "Ensemble",
    "Orbit",
    "OrbitNotFound",
    "Params",
    "PhysicalParams",
    "Scatter",
    "Study",
    "Trajectory",
    "VinesError",
    "Word",
    "__version__",
    "all_orbits",
    "ball_locked",
    "classify_many",
    "continue_orbit",
    "ensemble",
    "find_orbit",
    "no_ball",
    "query",
    "run",
    "settle",
    "simulate",
    "study",
    "table",
]

if TYPE_CHECKING:
    from vines.attractors import Attractor as Attractor
    from vines.attractors import classify_many as classify_many
    from vines.attractors import settle as settle
    from vines.dynamics import Ensemble as Ensemble
    from vines.dynamics import Scatter as Scatter
    from vines.dynamics import Trajectory as Trajectory
    from vines.dynamics import ball_locked as ball_locked
    from vines.dynamics import ensemble as ensemble
    from vines.dynamics import no_ball as no_ball
    from vines.dynamics import simulate as simulate
    from vines.errors import OrbitNotFound as OrbitNotFound
    from vines.errors import VinesError as VinesError
    from vines.model import Params as Params
    from vines.model import PhysicalParams as PhysicalParams
    from vines.model import Word as Word
    from vines.orbits import Branch as Branch
    from vines.orbits import Orbit as Orbit
    from vines.orbits import all_orbits as all_orbits
    from vines.orbits import continue_orbit as continue_orbit
    from vines.orbits import find_orbit as find_orbit
    from vines.stages import Study as Study
    from vines.stages import query as query
    from vines.stages import run as run
    from vines.stages import study as study
    from vines.stages import table as table


def __getattr__(name: str) -> Any:
    """Load a public name from its room when it is first used (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'vines' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
