"""What arguments public functions take: stated once at each function, and checked before anything is done.

A domain says in one line what was given and what is allowed. A function gets what it was given, but for numbers of
other kinds than Python's (NumPy's of any width, arrays of no dimension, fractions): these it gets as int or float,
because a kernel would be compiled anew for each of their types, or not at all.
"""

from __future__ import annotations

import functools
import inspect
import math
import operator
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, ParamSpec, Protocol, TypeVar

from vines.bounds import check_count, check_number, shown
from vines.errors import ParameterError, StateError, VinesError, nearest

__all__ = [
    "ONE_OF_FEW",
    "Choice",
    "Domain",
    "Interval",
    "Name",
    "Named",
    "Names",
    "Number",
    "Numbers",
    "Of",
    "Pair",
    "Parameters",
    "Whole",
    "stated",
]

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")

ONE_OF_FEW = 100_000
"""Most numbers in a list that is given by hand."""


class Domain(Protocol):
    """What an argument may be."""

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error`, in one line, unless the value is allowed."""
        ...


@dataclass(frozen=True)
class Number:
    """A finite real number in a range; None too where it is `optional`.

    Examples
    --------
    >>> Number(above=0, most=1).check("step", 2, ParameterError)
    Traceback (most recent call last):
        ...
    vines.errors.ParameterError: step is 2; give a finite number > 0 and <= 1
    """

    least: float = -math.inf
    above: float = -math.inf
    most: float = math.inf
    below: float = math.inf
    unit: str = ""
    optional: bool = False

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is such a number."""
        if value is None and self.optional:
            return
        check_number(
            name,
            value,
            least=self.least,
            above=self.above,
            most=self.most,
            below=self.below,
            unit=self.unit,
            error=error,
        )

    def plain(self, value: Any) -> Any:
        """Return an allowed value as int or float."""
        return value if value is None or type(value) in (int, float) else float(value)


@dataclass(frozen=True)
class Whole:
    """A whole number in a range; None too where it is `optional`."""

    least: int = 1
    most: int | None = None
    optional: bool = False

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is such a number."""
        if value is not None or not self.optional:
            check_count(name, value, least=self.least, most=self.most, error=error)

    def plain(self, value: Any) -> Any:
        """Return an allowed value as int."""
        return None if value is None else operator.index(value)


@dataclass(frozen=True)
class Choice:
    """One of some names.

    Examples
    --------
    >>> Choice(("final", "measures")).check("record", "measure", StateError)
    Traceback (most recent call last):
        ...
    vines.errors.StateError: record is 'measure': did you mean 'measures'? Allowed: final, measures
    """

    names: Collection[str]

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is one of the names."""
        if not isinstance(value, str) or value not in self.names:
            raise error(f"{name} is {shown(value)}: {nearest(str(value)[:60], self.names)}")


@dataclass(frozen=True)
class Name:
    """A text of one line, whatever it names: the function says which there are."""

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is a text."""
        if not isinstance(value, str) or not value.isprintable() or len(value) > 200:
            raise error(f"{name} is {shown(value)}; give a name")


@dataclass(frozen=True)
class Names:
    """So many names."""

    count: int

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is a list of so many names."""
        given = listed(value)
        if given is None or len(given) != self.count:
            raise error(f"{name} is {shown(value)}; give {self.count} names")
        for each in given:
            Name().check(f"a name of {name}", each, error)


@dataclass(frozen=True)
class Of:
    """An object of one of some classes of vines, by name, so that none of them is imported for it.

    Examples
    --------
    >>> Of("Orbit", how="as find_orbit returns it").check("orbit", "LR", ParameterError)
    Traceback (most recent call last):
        ...
    vines.errors.ParameterError: orbit is 'LR'; give an Orbit, as find_orbit returns it
    """

    classes: str
    how: str = ""
    optional: bool = False

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is of one of the classes."""
        if value is None and self.optional:
            return
        allowed = self.classes.split("|")
        for each in type(value).__mro__:
            if each.__name__ in allowed and each.__module__.startswith("vines."):
                return
        kind = " or ".join(allowed)
        article = "an" if kind[0] in "AEIOU" else "a"
        raise error(f"{name} is {shown(value)}; give {article} {kind}{self.how and f', {self.how}'}")


@dataclass(frozen=True)
class Parameters:
    """The parameters of a system: `vines.Params`, or those of any system beside it.

    Examples
    --------
    >>> Parameters().check("p", 0.02, ParameterError)
    Traceback (most recent call last):
        ...
    vines.errors.ParameterError: p is 0.02; give parameters, such as vines.Params(mu=0.01, A=0.02)
    """

    any_system: bool = True

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value holds parameters of a system that is allowed."""
        classes = [each.__name__ for each in type(value).__mro__ if each.__module__.startswith("vines.")]
        if "Parameters" not in classes:
            raise error(f"{name} is {shown(value)}; give parameters, such as vines.Params(mu=0.01, A=0.02)")
        if not self.any_system and "Params" not in classes:
            raise error(f"{name} is of {classes[0]}; this is there for vines.Params alone")


@dataclass(frozen=True)
class Numbers:
    """A list of finite numbers, each in a range, or an array of one dimension."""

    each: Number | Whole = field(default_factory=Number)
    least: int = 0
    most: int = ONE_OF_FEW
    optional: bool = False

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is a list of such numbers."""
        if value is None and self.optional:
            return
        given = listed(value)
        if given is None or not self.least <= len(given) <= self.most:
            few = f"{self.least}" if self.least == self.most else f"{self.least} to {self.most}"
            raise error(f"{name} is {shown(value)}; give a list of {few} numbers")
        kind = getattr(value, "dtype", None)
        if kind is not None and kind.kind in "fiu" and isinstance(self.each, Number):
            # The extremes stand for the rest; nan is one of them if there is any.
            given = [given.min(), given.max()] if len(given) else []
        for number in given:
            self.each.check(f"a number of {name}", number, error)


@dataclass(frozen=True)
class Pair:
    """Two different finite numbers, in any order; None too where they are `optional`."""

    optional: bool = False

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is such a pair."""
        if value is None and self.optional:
            return
        given = listed(value)
        if given is None or len(given) != 2:
            raise error(f"{name} is {shown(value)}; give two numbers, (from, to)")
        for number in given:
            check_number(f"an end of {name}", number, error=error)


@dataclass(frozen=True)
class Interval:
    """Two finite numbers, the first of which is the smaller one."""

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is such an interval."""
        Pair().check(name, value, error)
        low, high = (float(each) for each in value)
        if not low < high:
            raise error(f"{name} is {shown(value)}; give two numbers (from, to), from < to")


@dataclass(frozen=True)
class Named:
    """A mapping of names to values of one domain."""

    each: Domain
    optional: bool = False

    def check(self, name: str, value: Any, error: type[VinesError]) -> None:
        """Raise `error` unless the value is such a mapping."""
        if value is None and self.optional:
            return
        if not isinstance(value, Mapping):
            raise error(f"{name} is {shown(value)}; give a mapping by name, such as {{'A': ...}}")
        for key, one in value.items():
            self.each.check(f"{name}[{shown(key)}]", one, error)


def listed(value: Any) -> Any:
    """Return the members of a list, tuple or array of one dimension, None for anything else."""
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable):
        return None
    if getattr(value, "ndim", 1) != 1 or not hasattr(value, "__len__"):
        return None
    return value if hasattr(value, "dtype") else list(value)


def stated(
    error: type[VinesError] = StateError, /, **domains: Domain
) -> Callable[[Callable[_Arguments, _Result]], Callable[_Arguments, _Result]]:
    """Return a decorator that checks arguments by name before a function is called.

    Parameters
    ----------
    error : type
        What a wrong argument raises.
    **domains : Domain
        What the arguments may be; an argument that is left out is not checked.

    Examples
    --------
    >>> @stated(ParameterError, count=Whole(most=3))
    ... def of(count: int = 1) -> int:
    ...     return count
    >>> of(2), of()
    (2, 1)
    >>> of("a")
    Traceback (most recent call last):
        ...
    vines.errors.ParameterError: count is 'a'; give an integer >= 1 and <= 3
    """

    def decorate(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
        signature = inspect.signature(function)
        unknown = set(domains) - set(signature.parameters)
        assert not unknown, f"{function.__name__} has no {', '.join(sorted(unknown))}"

        positional = [
            each.name
            for each in signature.parameters.values()
            if each.kind in (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
        ]

        def one(name: str, value: Any) -> Any:
            domain = domains.get(name)
            if domain is None:
                return value
            domain.check(name, value, ParameterError if isinstance(domain, Parameters) else error)
            return domain.plain(value) if isinstance(domain, Number | Whole) else value

        @functools.wraps(function)
        def checked(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> _Result:
            # What Python itself says of arguments that do not fit is said by the call.
            by_place: list[Any] = list(args)
            by_name: dict[str, Any] = dict(kwargs)
            for k, (name, value) in enumerate(zip(positional, args, strict=False)):
                by_place[k] = one(name, value)
            for name, value in kwargs.items():
                by_name[name] = one(name, value)
            call: Callable[..., _Result] = function
            return call(*by_place, **by_name)

        return checked

    return decorate
