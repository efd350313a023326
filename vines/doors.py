"""Doors for others: what is known by name, of vines itself and of installed packages that bring it by entry points.

Every room may import this module; it imports nothing but the standard library and :mod:`vines.errors`.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
import sys
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from vines.errors import PlugInError, UnknownNameError, VinesError, nearest

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["Named", "Register", "brought"]


class Named(Protocol):
    """Something with a name that declarations write."""

    @property
    def name(self) -> str:
        """Its name."""
        ...


Thing = TypeVar("Thing", bound=Named)


class Register(Generic[Thing]):
    """Things of one form by name: registered ones, those of the modules of a package, those that others bring.

    Nothing is imported before it is asked for. A name of vines cannot be taken by an installed package.

    Parameters
    ----------
    what : str
        What messages call such a thing.
    group : str
        Group of entry points; the name of an entry point is that of the thing, its value the thing itself.
    form : type
        What a thing is an instance of.
    error : type of VinesError
        Raised for a name that is not known.

    Examples
    --------
    >>> from dataclasses import make_dataclass
    >>> Colour = make_dataclass("Colour", [("name", str)])
    >>> colours = Register("colour", "vines.colours", Colour)
    >>> colours.add(Colour("red")) is colours.get("red")
    True
    >>> colours.names()
    ('red',)
    """

    def __init__(self, what: str, group: str, form: type[Thing], error: type[VinesError] = UnknownNameError) -> None:
        self.what, self.group, self.form, self.error = what, group, form, error
        self._things: dict[str, Thing] = {}
        self._modules: dict[str, tuple[str, str]] = {}

    def add(self, thing: Thing) -> Thing:
        """Make a thing known and return it. The last one of a name counts."""
        self._things[thing.name] = thing
        return thing

    def add_modules(self, package: str, attribute: str) -> None:
        """Make known what each module of a package, but those with an underscore, has under the name `attribute`.

        The module is called as the thing.
        """
        for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
            if not module.name.startswith("_"):
                self._modules[module.name] = (f"{package}.{module.name}", attribute)

    def names(self) -> tuple[str, ...]:
        """Return all names: those of vines, registered ones, then those that installed packages bring.

        In an order that does not depend on which was asked for first, since digests are taken of such lists.
        """
        return tuple(dict.fromkeys([*self._modules, *self._things, *brought(self.group)]))

    def get(self, name: str) -> Thing:
        """Return the thing of that name.

        Raises
        ------
        VinesError
            Of the type `error`, if there is none; the message names the nearest.
        PlugInError
            If a package brings it, but not so that it can be used.
        """
        if name not in self._things and name in self._modules:
            module, attribute = self._modules[name]
            self._things[name] = getattr(importlib.import_module(module), attribute)
        if name in self._things:
            return self._things[name]
        entry = brought(self.group).get(name)
        if entry is None:
            raise self.error(f"unknown {self.what} {name!r}: {nearest(name, self.names())}")
        return self._load(entry)

    def all(self) -> dict[str, Thing]:
        """Return everything by name.

        Raises
        ------
        PlugInError
            If what a package brings cannot be used.
        """
        return {name: self.get(name) for name in self.names()}

    def origin(self, name: str) -> str:
        """Return which installed package brings a thing; empty if vines has it, or a program registered it."""
        if name in self._things or name in self._modules:
            return ""
        return _distribution(brought(self.group)[name])

    def _load(self, entry: EntryPoint) -> Thing:
        where = f"{self.what} {entry.name!r} of the package {_distribution(entry)} ({entry.value})"
        try:
            thing: Any = entry.load()
        except Exception as error:  # a package of others may fail in any way
            text = (str(error).splitlines() or [""])[0]
            raise PlugInError(
                f"{where} cannot be loaded: {type(error).__name__}: {text}; mend or uninstall it"
            ) from error
        if not isinstance(thing, self.form) or thing.name != entry.name:
            found = f"a {self.form.__name__} {thing.name!r}" if isinstance(thing, self.form) else repr(thing)
            raise PlugInError(f"{where} is {found}; a {self.form.__name__} of the name {entry.name!r} is needed")
        return thing


def brought(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of a group by name.

    Raises
    ------
    PlugInError
        If two packages bring the same name.

    Examples
    --------
    >>> brought("nobody.has.this")
    {}
    """
    found: dict[str, EntryPoint] = {}
    for entry in _entry_points(tuple(sys.path), group):
        other = found.setdefault(entry.name, entry)
        if other.value != entry.value:
            packages = " and ".join(sorted(map(_distribution, (other, entry))))
            raise PlugInError(f"{group}: {entry.name!r} is brought by the packages {packages}; uninstall one of them")
    return found


@functools.lru_cache(maxsize=16)
def _entry_points(path: tuple[str, ...], group: str) -> tuple[EntryPoint, ...]:
    """Look once for what is installed on a search path."""
    del path
    from importlib.metadata import entry_points

    return tuple(entry_points(group=group))


def _distribution(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist is not None else "unknown"
