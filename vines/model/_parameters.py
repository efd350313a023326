"""What the parameters of every system are: validated, immutable, hashable, printed with their names."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

from vines.errors import ParameterError, nearest
from vines.model._conversion import dimensionless
from vines.model._system import System

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

__all__ = ["Parameters"]


class Parameters:
    """Base of the parameters of a system: a frozen dataclass whose fields are the declared parameters.

    A field that belongs to each ball, or each mode, is a tuple of numbers; its flat names are ``mu_1``, ``mu_2``, ….
    """

    __slots__ = ()
    DECLARATION: ClassVar[System]
    """The declaration of a system of which nothing is counted; one of balls or modes has its own `declared`."""

    def __post_init__(self) -> None:
        for parameter in self.system.parameters:
            object.__setattr__(self, parameter.name, parameter.check(getattr(self, parameter.name)))

    @property
    def system(self) -> System:
        """The declaration of the system that these are parameters of."""
        return self.DECLARATION

    @property
    def period(self) -> float:
        """Forcing period T = 2 pi/Omega (dimensionless time)."""
        return 2 * math.pi / getattr(self, "Omega", 1.0)

    @property
    def mirrored(self) -> bool:
        """Whether the mirror image of a motion is a motion too, half a period later."""
        return all(value == 0 for name, value in self.as_dict().items() if name in self.system.mirror.broken_by)

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed, by the names of the fields or by flat ones.

        Raises
        ------
        ParameterError
            If a name is not a parameter or a value is out of range.

        Examples
        --------
        >>> from vines.model import Params
        >>> Params(mu=0.01, A=0.02).replace(A=0.03).A
        0.03
        """
        fields = {each.name for each in dataclasses.fields(self)}  # pyright: ignore[reportArgumentType]
        own = {name: value for name, value in changes.items() if name in fields}
        new = dataclasses.replace(self, **own) if own else self  # pyright: ignore[reportArgumentType, reportCallIssue]
        flat = {name: value for name, value in changes.items() if name not in fields}
        for name in flat:
            new.system.parameter(name)
        return type(self).of(new.as_dict() | flat) if flat else new

    def as_dict(self) -> dict[str, float]:
        """Return the parameters by their flat names, in the order of the declaration."""
        return dict(zip((each.name for each in self.system.parameters), self._values(), strict=True))

    def as_array(self) -> npt.NDArray[np.float64]:
        """Return the parameters in the order of the declaration."""
        import numpy as np

        return np.array(self._values(), dtype=np.float64)

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """Return parameters from their flat names.

        Raises
        ------
        ParameterError
            If a name is unknown or missing, or a value out of range.
        """
        fields = {each.name: each for each in dataclasses.fields(cls)}  # pyright: ignore[reportArgumentType]
        found: dict[str, Any] = {}
        several: dict[str, dict[int, Any]] = {}
        for name, value in values.items():
            stem, _, number = name.rpartition("_")
            if name in fields:
                found[name] = value
            elif stem in fields and number.isdecimal():
                several.setdefault(stem, {})[int(number)] = value
            else:
                raise ParameterError(f"unknown parameter {name!r}: {nearest(name, fields)}")
        for stem, own in several.items():
            if sorted(own) != list(range(1, len(own) + 1)):
                what = "modes" if cls.declared(1).modes else "balls"
                raise ParameterError(f"{stem} is given for the {what} {sorted(own)}; give it for 1, 2, … without a gap")
            found[stem] = tuple(own[number] for number in sorted(own))
        for name, each in fields.items():
            if name not in found and each.default is dataclasses.MISSING:
                raise ParameterError(f"{name} is missing; give it")
        return cls(**found)

    @classmethod
    def from_physical(cls, **given: Any) -> Self:
        """Return parameters from SI units: names of the rig and of the run, and dimensionless ones that have no unit.

        Raises
        ------
        ParameterError
            If a name is unknown, a quantity is missing, or a value out of range.
        """
        balls = max((len(value) for value in given.values() if isinstance(value, tuple | list)), default=0)
        system = cls.declared(balls)
        flat = dict(_flat(given))
        own = {each.name for each in system.parameters}
        si = {name: value for name, value in flat.items() if name not in own}
        made = dimensionless(system, si)
        for name in made.keys() & flat.keys():
            raise ParameterError(f"{name} is given, and follows from {', '.join(si)}; give one of them")
        return cls.of(made | {name: value for name, value in flat.items() if name in own})

    @classmethod
    def declared(cls, balls: int = 0) -> System:
        """Return the declaration of the system, with so many balls, or modes, where that is open."""
        del balls
        return cls.DECLARATION

    def _values(self) -> list[float]:
        found: list[float] = []
        for each in dataclasses.fields(self):  # pyright: ignore[reportArgumentType]
            value = getattr(self, each.name)
            found += value if isinstance(value, tuple) else (value,)
        return found

    def __str__(self) -> str:
        return ", ".join(f"{name} = {value:.6g}" for name, value in self.as_dict().items()) + " (dimensionless)"


def _flat(values: Mapping[str, Any]) -> Iterable[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, tuple | list):
            yield from ((f"{name}_{number}", each) for number, each in enumerate(value, start=1))
        else:
            yield name, value
