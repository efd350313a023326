"""What a system is made of: the form in which parameters, states, contacts and symmetries are declared once.

Structs of msgspec, because a dataclass compiles some ten functions when it is made, and each command line makes these.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

from vines.bounds import shown
from vines.errors import ParameterError, StateError, nearest
from vines.model._letters import STOPS

__all__ = ["Body", "Contact", "Coordinate", "Energies", "Parameter", "Range", "Symmetry", "System", "finite"]


class Range(msgspec.Struct, frozen=True):
    """An interval of numbers.

    Parameters
    ----------
    least, most : float
        Its ends, infinite where it goes on.
    above, below : bool
        Whether `least` and `most` themselves are left out.

    Examples
    --------
    >>> Range(0, 2, below=True).of("lam"), Range(0, above=True).of("mu")
    ('0 <= lam < 2', 'mu > 0')
    """

    least: float = -math.inf
    most: float = math.inf
    above: bool = False
    below: bool = False

    def holds(self, value: Any) -> Any:
        """Return whether a number lies in the interval, or for an array which do; never for nan."""
        return (value > self.least if self.above else value >= self.least) & (
            value < self.most if self.below else value <= self.most
        )

    def of(self, name: str) -> str:
        """Return the interval as a condition on a name."""
        lower, upper = "<" if self.above else "<=", "<" if self.below else "<="
        if math.isinf(self.least):
            return f"{name} {upper} {self.most:g}"
        if math.isinf(self.most):
            return f"{name} {lower.replace('<', '>')} {self.least:g}"
        return f"{self.least:g} {lower} {name} {upper} {self.most:g}"


class Parameter(msgspec.Struct, frozen=True):
    """A number that a system is given.

    Attributes
    ----------
    name : str
        As in Python, TOML, on the command line, in tables and SQL.
    text : str
        What it is, with its definition: heads of tables and options.
    allowed : Range
    why : str
        The clause that ends the message about a value out of range.
    default : float or None
        None where it must be given.
    unit : str
        ``"1"`` if dimensionless.
    source : str
        Where in the paper it is defined.
    symbol, label : str
        TeX and words for axes of figures.
    physical : str
        What it is in SI units, as a formula of names of the rig and the run; empty where it has no unit there.
    """

    name: str
    text: str
    allowed: Range
    why: str = ""
    default: float | None = None
    unit: str = "1"
    source: str = ""
    symbol: str = ""
    label: str = ""
    physical: str = ""

    def check(self, value: object) -> float:
        """Return a value as a float.

        Raises
        ------
        ParameterError
            If it is not a finite number in the range.

        Examples
        --------
        >>> Parameter("r", "Restitution", Range(0, 1), "r is the coefficient of restitution").check(2)
        Traceback (most recent call last):
        vines.errors.ParameterError: r is 2, allowed is 0 <= r <= 1: r is the coefficient of restitution
        """
        unit = "" if self.unit == "1" else self.unit
        number = finite(self.name, value, unit)
        if not self.allowed.holds(number):
            raise ParameterError(
                f"{self.name} is {number:g}{unit and f' {unit}'}, allowed is {self.allowed.of(self.name)}"
                + (self.why and f": {self.why}")
            )
        return number


class Coordinate(msgspec.Struct, frozen=True):
    """A number of the state.

    Attributes
    ----------
    name, text, unit, source, symbol
        As of a `Parameter`.
    start : float
        Its value where a start does not say it.
    allowed : Range
    """

    name: str
    text: str
    symbol: str
    start: float = 0.0
    unit: str = "1"
    source: str = ""
    allowed: Range = Range()


class Body(msgspec.Struct, frozen=True):
    """A body that moves along one line: what it is, its position and velocity."""

    name: str
    position: Coordinate
    velocity: Coordinate


class Contact(msgspec.Struct, frozen=True):
    """A wall that a ball meets: its letter in words, the sign of the gap there, its name, the ball's number if any."""

    letter: str
    sign: int
    text: str
    ball: int = 0


class Symmetry(msgspec.Struct, frozen=True):
    """A map of motions onto motions.

    Attributes
    ----------
    sign : int
        Factor of all coordinates of the state.
    shift : float
        By how many forcing periods time is shifted.
    letters : mapping of str to str
        The contact that each contact becomes.
    broken_by : tuple of str
        Parameters that have to be 0, since the system has no such symmetry otherwise.
    """

    sign: int
    shift: float
    letters: Mapping[str, str]
    broken_by: tuple[str, ...] = ()


class Energies(msgspec.Struct, frozen=True):
    """Names of energies: what is stored, what has come in and what has gone since the start of a run."""

    stored: tuple[str, ...]
    gained: tuple[str, ...]
    lost: tuple[str, ...]


class System(msgspec.Struct, frozen=True, dict=True):
    """A system of bodies, walls and one forcing, declared once for every room.

    Attributes
    ----------
    name, title : str
        Its name in declarations, and what it is.
    parameters_of : str
        The class of its parameters, as ``"package:Class"``.
    balls : int
        How many balls have numbers after their parameters; 0 where there is one ball and no number.
    parameters : tuple of Parameter
        Dimensionless ones, in the order of arrays and kernels.
    rig, run : tuple of Parameter
        In SI units: those of a rig, and those of one run on it.
    bodies : tuple of Body
    phase : Coordinate
        The phase of the forcing, which completes a start.
    contacts : tuple of Contact
        In the order in which types n:m count them.
    mirror : Symmetry
    energies : Energies
    met : tuple of Coordinate
        As `state`, of an impact: coordinates of the ball that hits, without a number.
    without : tuple of str
        Columns of the common tables that the tables of this system do not have.
    order : int
        Of the Taylor series by which it moves between events; 0 where closed forms are exact.
    stops : bool
        Whether a ball may stop in mid-cavity.
    starred : bool
        Whether orbits that stick are computed.
    smooth : bool
        Whether motions without impacts are isolated, so that they have orbits.
    modes : int
        How many modes have numbers after their parameters; 0 where there is one without a number.
    """

    name: str
    title: str
    parameters_of: str
    balls: int
    parameters: tuple[Parameter, ...]
    rig: tuple[Parameter, ...]
    run: tuple[Parameter, ...]
    bodies: tuple[Body, ...]
    phase: Coordinate
    contacts: tuple[Contact, ...]
    mirror: Symmetry
    energies: Energies
    met: tuple[Coordinate, ...]
    without: tuple[str, ...] = ()
    order: int = 0
    stops: bool = False
    starred: bool = True
    smooth: bool = False
    modes: int = 0

    @property
    def state(self) -> tuple[Coordinate, ...]:
        """Position and velocity of each body, in the order of arrays and kernels."""
        return tuple(each for body in self.bodies for each in (body.position, body.velocity))

    @property
    def start(self) -> tuple[Coordinate, ...]:
        """The coordinates of a start: the state and the phase of the forcing."""
        return (*self.state, self.phase)

    @property
    def between_walls(self) -> str:
        """Name of the body that flies between the walls, where there is one alone."""
        return next(body.name for body in self.bodies if body.position.name in ("x2", "w"))

    def parameter(self, name: str) -> Parameter:
        """Return the dimensionless parameter of a name.

        Raises
        ------
        ParameterError
            If there is none; the message names the nearest.
        """
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        known = [parameter.name for parameter in self.parameters]
        raise ParameterError(f"unknown parameter {name!r}: {nearest(str(name), known)}")

    def started(self, given: Mapping[str, Any]) -> dict[str, float]:
        """Return a whole start, by name, of one that leaves out what is as declared.

        A coordinate that each ball has may be given by its name without a number, as one number or one a ball.

        Raises
        ------
        StateError
            If a name is unknown, a value out of its range, or there are not as many as balls.
        """
        found = {each.name: each for each in self.start}
        values = {name: each.start for name, each in found.items()}
        for name, value in given.items():
            of_balls = [each for each in found if each.rpartition("_")[0] == name]
            several = list(value) if isinstance(value, list | tuple) else [value] * max(len(of_balls), 1)
            names = [name] if name in found else of_balls
            if not names:
                raise StateError(f"unknown coordinate {name!r} of a start: {nearest(name, found)}")
            if len(several) != len(names):
                raise StateError(f"{name} has {len(several)} values at the start; give one, or {len(names)}")
            values.update(zip(names, several, strict=True))
        for name, each in found.items():
            number = finite(name, values[name])
            if not each.allowed.holds(number):
                raise StateError(f"{name} is {number:g} at the start, allowed is {each.allowed.of(name)}")
            values[name] = number
        return values

    @property
    def alphabet(self) -> str:
        """The letters of all contacts."""
        return "".join(contact.letter for contact in self.contacts)

    def letters(self, signs: Iterable[float], balls: Iterable[int] = itertools.repeat(0)) -> str:
        """Return the letters of contacts: of the sign of the gap, 0 at a stop, and the number of the ball.

        Balls are numbered from 1 on; 0 is the only one, as words of one ball have no numbers.
        """
        letters = {(contact.sign, 0): contact.letter.rstrip("12345678") for contact in self.contacts}
        letters |= {(contact.sign, contact.ball): contact.letter for contact in self.contacts} | {(0, 0): STOPS}
        ways = (0 if sign == 0 else 1 if sign > 0 else -1 for sign in signs)
        return "".join(letters[each] for each in zip(ways, balls, strict=False))

    @functools.cached_property
    def digest(self) -> str:
        """What numbers depend on: names, defaults, contacts and symmetries, without texts; 16 hexadecimal digits."""
        form = [
            [(each.name, each.default, each.physical) for each in (*self.parameters, *self.rig, *self.run)],
            [(each.name, each.start) for each in self.start],
            [(each.letter, each.sign, each.ball) for each in self.contacts],
            [self.mirror.sign, self.mirror.shift, sorted(self.mirror.letters.items()), self.mirror.broken_by],
            [self.energies.stored, self.energies.gained, self.energies.lost],
            *([self.order] if self.order else []),
        ]
        return hashlib.sha256(json.dumps(form, separators=(",", ":")).encode()).hexdigest()[:16]


def finite(name: str, value: object, unit: str = "") -> float:
    """Return a value as a float, or raise `ParameterError` if it is not a finite number."""
    try:
        number = math.nan if isinstance(value, bool | str) else float(value)  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ParameterError(f"{name} is {shown(value)}; give a finite number{unit and f' in {unit}'}")
    return number
