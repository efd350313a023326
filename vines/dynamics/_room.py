"""What Python needs to know of a system beside its kernels, and where that stands: one package a system.

A package ``vines.dynamics.NAME`` registers the bodies of the kernels of the system of that name and brings its `Room`.
"""

from __future__ import annotations

import functools
import importlib
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._advance import ROW, STATE, set_state
from vines.dynamics._constants import ParameterTable, constants_kernel
from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.dynamics._scatter import BEGUN, Scatter
from vines.dynamics._scatter_constants import ROOM
from vines.dynamics._scatter_table import ScatterTable
from vines.dynamics._start import check_coordinate, check_gap, check_numbers
from vines.dynamics._totals import TOTALS
from vines.errors import StateError, nearest
from vines.model import Params

__all__ = ["IN_TURN", "TIES", "TOGETHER", "Layout", "Room", "Slopes", "constants", "room_of", "start_of", "table_of"]

Floats = npt.NDArray[np.float64]


IN_TURN, TOGETHER = TIES = ("in_turn", "together")
"""How balls are struck that arrive at one instant: one after the other by their numbers, or by one law of all."""


class Layout(NamedTuple):
    """Lengths of arrays: state of a run, row of an event, totals of a window, a disturbance; rows to begin with."""

    state: int = STATE
    width: int = ROW
    totals: int = TOTALS
    directions: int = 4
    rows: int = 256


class Slopes(NamedTuple):
    """How the push of a frame on what rides on a wall of it changes, at a state in which the wall does not press.

    Attributes
    ----------
    by_time : float
        Its derivative by time at fixed coordinates.
    by_state : ndarray, shape (2 + n,)
        Its derivatives by x1, v1 and what moves beside ball and frame.
    rates : ndarray, shape (n,)
        Derivatives by time of what moves beside.
    blown : ndarray, shape (n,)
        What is added to these where the wall presses, over what is added to x1''.
    """

    by_time: float
    by_state: Floats
    rates: Floats
    blown: Floats


class Room:
    """How a system is brought to its kernels and back: as the VI-NES is, where another system does not say otherwise.

    Attributes
    ----------
    trajectory, measures : callable or None
        What makes a run of its rows, and measures of its totals, where one ball is not enough for that.
    unstruck : str or None
        Name of a settled motion without impacts, where such a one repeats of itself.
    beside : tuple of str
        What rows have at their ends, by the names of the system: coordinates of what no wall meets.
    """

    trajectory: Callable[..., Any] | None = None
    measures: Callable[..., Any] | None = None
    unstruck: str | None = None
    beside: tuple[str, ...] = ()

    def constants(self, values: Sequence[float]) -> Any:
        """Return the constants of the kernels from the values of the parameters, in the order of the declaration."""
        return constants_kernel(*values)

    def table(self, points: list[list[float]]) -> Any:
        """Return the table for kernels that run many points."""
        return ParameterTable(np.array(points))

    def scattered(
        self, values: Floats, scatter: Scatter, streams: npt.NDArray[np.int64], begun: Floats | None = None
    ) -> tuple[Any, Floats]:
        """Return the table of runs with scatter, and room that has to be kept as long as it is used.

        Parameters
        ----------
        values : ndarray, shape (n, d)
            Parameters of the runs.
        scatter : Scatter
            What is drawn.
        streams : ndarray of int, shape (n,)
            Number of each run.
        begun : ndarray, shape (n,), optional
            Coloured force at time 0, in units of A; drawn if left out.

        Raises
        ------
        ParameterError
            If the system cannot have such a scatter.
        """
        numbers = scatter.numbers(values)
        if begun is not None:
            numbers[:, BEGUN] = begun
        room = np.empty(ROOM)
        return ScatterTable(values, numbers, streams, room.ctypes.data), room

    def layout(self, p: Any) -> Layout:
        """Return the lengths of arrays."""
        return Layout()

    def enter(self, p: Any, start: Mapping[str, Any], phase: float) -> tuple[Any, Any, Any, Any]:
        """Return x1, v1, x2, v2 as kernels hold them, from a start by name; x2, v2 are arrays if there are several."""
        check_gap(start["x1"] - start["x2"])
        return start["x1"], start["v1"], start["x2"], start["v2"]

    def leave(self, p: Any, at: Sequence[float], phase: float, more: Sequence[float] = ()) -> dict[str, float]:
        """Return the coordinates of the declaration by name, from x1, v1, x2, v2 and what rows have behind them."""
        return dict(zip(("x1", "v1", "x2", "v2"), at, strict=True))

    def begin(self, c: Any, state: Floats, x1: float, v1: float, x2: Any, v2: Any, phase: float, t: float) -> None:
        """Put a run at its start."""
        set_state(state, float(x1), float(v1), float(x2), float(v2), phase, t)

    def strike_in_turn(self, state: Floats) -> None:
        """Let balls that arrive at one instant be struck one after the other in a run that has begun."""

    def gaps(self, p: Any, at: Mapping[str, Any]) -> Any:
        """Return the gap of each ball over half the length of its cavity, shape (n, balls), of n states by name."""
        return np.stack([at["x1"] - at["x2"]], axis=-1)

    def draw(self, p: Any, rng: np.random.Generator) -> dict[str, float]:
        """Return a start at phase 0, drawn at random.

        The oscillator is within twice its amplitude without a ball, .1 at least and 3 at most, and as fast; the ball is
        anywhere in the cavity and as fast.
        """
        size = self.size(p)
        x1, v1, v2 = rng.uniform(-size, size, 3).tolist()
        return {"x1": x1, "v1": v1, "x2": x1 - float(rng.uniform(-1.0, 1.0)), "v2": v2}

    def size(self, p: Any) -> float:
        """Return the largest displacement of the oscillator at a start that is drawn."""
        return float(np.clip(2.0 * self.amplitude(p, 1.0), 0.1, 3.0))

    def amplitude(self, p: Any, mass: float) -> float:
        """Return the steady amplitude of x1 of an oscillator of this mass without a ball."""
        damping = p.lam * p.Omega
        detuning = math.hypot(1.0 - mass * p.Omega**2, damping)
        return p.A * math.hypot(1.0, damping) / detuning if detuning > 0.0 else math.inf

    def swings(self, p: Any) -> list[dict[str, float]]:
        """Return further starts of the oscillator from which orbits are looked for, beside rest."""
        return []

    def push(self, p: Any, x1: Any, v1: Any, phase: Any) -> Any:
        """Return w'' of a free ball."""
        force = p.A * (np.sin(phase) + p.lam * p.Omega * np.cos(phase))
        return force - p.lam * v1 - x1

    def pushed(self, p: Any, x1: Any, v1: Any, phase: Any, beside: Any) -> Any:
        """Return w'' of a free ball, with the coordinates that rows have of what moves beside ball and frame."""
        return self.push(p, x1, v1, phase)

    def slopes(self, p: Any, x1: float, v1: float, phase: float, beside: Floats) -> Slopes:
        """Return how `pushed` changes."""
        by_time = p.A * p.Omega * (math.cos(phase) - p.lam * p.Omega * math.sin(phase))
        return Slopes(by_time, np.array([-1.0, -p.lam]), np.empty(0), np.empty(0))

    def alongside(self, p: Any) -> tuple[float, ...]:
        """Return of each coordinate of what moves beside 1 if its difference to x1 says what pushes, else 0."""
        return ()

    def let_go(self, p: Any, side: int) -> float:
        """Return the `push` at which a ball that rides on a wall leaves it: 0 where the wall alone acts on it."""
        return 0.0

    def law(self, p: Any, balls: Any) -> ImpactLaw:
        """Return the law of impact of balls with these numbers."""
        return impact_law(p.mu, p.r)

    def mass(self, p: Any) -> float:
        """Return the mass of the ball in the unit of energies."""
        return p.mu

    def frame_energy(self, p: Any, at: Mapping[str, float], sag: float) -> float:
        """Return the energy of the frame without forcing, above that at rest, where x1 is -sag."""
        return 0.5 * (at["v1"] ** 2 + (at["x1"] + sag) ** 2)

    def conserves(self, p: Any) -> bool:
        """Say whether nothing is lost, by damping or in impacts: volumes of states are kept, and nothing attracts."""
        restitution = getattr(p, "r", 0.0)
        each = restitution if isinstance(restitution, tuple) else (restitution,)
        return getattr(p, "lam", 0.0) == 0.0 and all(r == 1.0 for r in each)

    def base(self, p: Any, phase: Any) -> Any:
        """Return the displacement that is prescribed."""
        return p.A * np.sin(phase)

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        """Return kinetic energies of frame and ball and the potential energy of samples."""
        return 0.5 * at["v1"] ** 2, 0.5 * p.mu * at["v2"] ** 2, 0.5 * (at["x1"] - at["base"]) ** 2

    def spring(self, p: Any, at: Any) -> Any:
        """Return what of that is in a spring beside the oscillator's."""
        return 0.0


_VI_NES = Room()


def room_of(p: Any) -> Room:
    """Return the room of the system of some parameters; its package is imported when it is first asked for."""
    return _VI_NES if isinstance(p, Params) else _room_of(p.system.name)


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
    return room_of(p).constants(list(p.as_dict().values()))


def table_of(*points: Any) -> Any:
    """Return the table of the parameters of some points of one system, for kernels that run many."""
    return room_of(points[0]).table([list(p.as_dict().values()) for p in points])


def start_of(p: Any, start: Mapping[str, Any], t: float, phi: float) -> tuple[Any, Any, Any, Any, float]:
    """Return x1, v1, x2, v2 as kernels hold them, and the phase, of a start at time t by the names of a system.

    A coordinate that each ball has may also be given for all at once, by its name without a number.

    Raises
    ------
    StateError
        If a name is not one of the system's coordinates, or the start is not a state of it.
    """
    given = {each.name: each.start for each in p.system.state}
    for name, value in _each(start, given):
        if name not in given:
            raise StateError(f"unknown coordinate {name!r} of a start: {nearest(name, given)}")
        check_coordinate(name, value)
        given[name] = float(value)
    check_numbers(t=t, phi=phi)
    phase = math.fmod(constants(p).Omega * t, 2 * math.pi) + phi
    return *room_of(p).enter(p, given, phase), phase


def _each(start: Mapping[str, Any], given: Mapping[str, float]) -> list[tuple[str, Any]]:
    """Return a start coordinate by coordinate."""
    found: list[tuple[str, Any]] = []
    for name, value in start.items():
        numbered = [each for each in given if each.rpartition("_")[0] == name]
        if name in given or not numbered:
            found.append((name, value))
            continue
        values = [value] * len(numbered) if isinstance(value, int | float) else list(value)
        if len(values) != len(numbered):
            raise StateError(f"{name} has {len(values)} values at the start; give one, or {len(numbered)}: one a ball")
        found += zip(numbered, values, strict=True)
    return found
