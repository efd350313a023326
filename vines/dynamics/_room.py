"""What Python needs to know of a system beside its kernels, and where that stands: one package a system.

A package ``vines.dynamics.NAME`` registers the bodies of the kernels of the system of that name and brings a `Room`.
"""

from __future__ import annotations

import functools
import importlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import ParameterTable, constants_kernel
from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.dynamics._start import check_gap, check_numbers
from vines.errors import StateError, nearest
from vines.model import VI_NES, Params

__all__ = ["VI_NES_ROOM", "Room", "constants", "room_of", "start_of", "table_of"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Room:
    """How a system is brought to its kernels and back.

    Attributes
    ----------
    constants : callable
        Of the values of the parameters in the order of the declaration; the constants of the kernels.
    table : type
        The named tuple for a table of such values.
    enter : callable
        Of parameters, start by name and phase: x1, v1, x2, v2 as kernels hold them.
    leave : callable
        Of parameters, x1, v1, x2, v2 and phase: the coordinates of the declaration by name.
    push : callable
        Of parameters, x1, v1 and phase, numbers or arrays: w'' of a free ball.
    law : callable
        Of parameters and numbers of balls; the law of impact of these.
    directions : callable
        Of parameters; how many numbers a disturbance has.
    mass : callable
        Of parameters; the mass of the ball in the unit of energies.
    base : callable
        Of parameters and phase; the displacement that is prescribed.
    stored : callable
        Of parameters and samples: kinetic energies of frame and ball, potential energy.
    """

    constants: Callable[..., Any]
    table: Callable[[Floats], Any]
    enter: Callable[[Any, dict[str, float], float], tuple[float, float, float, float]]
    leave: Callable[[Any, float, float, float, float, float], dict[str, float]]
    push: Callable[[Any, Any, Any, Any], Any]
    law: Callable[[Any, Any], ImpactLaw]
    directions: Callable[[Any], int]
    mass: Callable[[Any], float]
    base: Callable[[Any, Any], Any]
    stored: Callable[[Any, Any], tuple[Any, Any, Any]]


def _enter(p: Params, start: dict[str, float], phase: float) -> tuple[float, float, float, float]:
    check_gap(start["x1"] - start["x2"])
    return start["x1"], start["v1"], start["x2"], start["v2"]


def _leave(p: Params, x1: float, v1: float, x2: float, v2: float, phase: float) -> dict[str, float]:
    return {"x1": x1, "v1": v1, "x2": x2, "v2": v2}


def _push(p: Params, x1: Any, v1: Any, phase: Any) -> Any:
    force = p.A * (np.sin(phase) + p.lam * p.Omega * np.cos(phase))
    return force - p.lam * v1 - x1


def _law(p: Params, balls: Any) -> ImpactLaw:
    return impact_law(p.mu, p.r)


def _mass(p: Params) -> float:
    return p.mu


def _base(p: Params, phase: Any) -> Any:
    return p.A * np.sin(phase)


def _stored(p: Params, at: Any) -> tuple[Any, Any, Any]:
    return 0.5 * at["v1"] ** 2, 0.5 * p.mu * at["v2"] ** 2, 0.5 * (at["x1"] - at["base"]) ** 2


VI_NES_ROOM = Room(constants_kernel, ParameterTable, _enter, _leave, _push, _law, lambda p: 4, _mass, _base, _stored)


def room_of(p: Any) -> Room:
    """Return the room of the system of some parameters; its package is imported when it is first asked for."""
    return VI_NES_ROOM if isinstance(p, Params) else _room_of(p.system.name)


@functools.cache
def _room_of(name: str) -> Room:
    return importlib.import_module(f"vines.dynamics.{name}").ROOM


def constants(p: Any) -> Any:
    """Return the constants of the kernels of the system of some parameters.

    Examples
    --------
    >>> c = constants(Params(mu=0.01, A=0.02))
    >>> print(f"{c.law.keep1 + c.law.pass1:.3f} {c.free.gamma:.6f}")
    1.000 0.999982
    """
    values = p.as_dict().values() if isinstance(p, Params) else p.as_array().tolist()
    return room_of(p).constants(*values)


def table_of(*points: Any) -> Any:
    """Return the table of the parameters of some points of one system, for kernels that run many."""
    values = np.array([list(p.as_dict().values()) if isinstance(p, Params) else p.as_array() for p in points])
    return room_of(points[0]).table(values)


def start_of(p: Any, start: Mapping[str, float], t: float, phi: float) -> tuple[float, float, float, float, float]:
    """Return x1, v1, x2, v2 as kernels hold them, and the phase, of a start at time t by the names of a system.

    Raises
    ------
    StateError
        If a name is not one of the system's coordinates, or the start is not a state of it.
    """
    system = VI_NES if isinstance(p, Params) else p.system
    given = {each.name: each.start for each in system.state}
    for name in start:
        if name not in given:
            raise StateError(f"unknown coordinate {name!r} of a start: {nearest(name, given)}")
    check_numbers(**start, t=t, phi=phi)
    phase = math.fmod(constants(p).Omega * t, 2 * math.pi) + phi
    at = room_of(p).enter(p, {**given, **{name: float(value) for name, value in start.items()}}, phase)
    return *at, phase
