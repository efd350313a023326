"""What a declaration gives of parameters: numbers and lists, quantities in SI units, and formulas."""

from __future__ import annotations

import functools
import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from vines.errors import DeclarationError, VinesError
from vines.model import Expression, counted, dimensionless, read_system, system_names
from vines.pipeline._axes import Axis, exact
from vines.pipeline._kinds import Kind
from vines.pipeline._links import linked_values, read_links
from vines.pipeline._options import known
from vines.pipeline._written import written

__all__ = ["COUNTS", "Given", "count_of", "counts_of", "quantities", "read_params", "stems"]

_NUMBERED = re.compile(r".*_([1-9])")

COUNTS = ("balls", "modes")
"""The keys under ``params`` that count what has numbers; they are no parameters, and in no key of results."""


@dataclass(frozen=True, slots=True)
class Given:
    """Parameters and quantities as a file or a stage gives them, lists by the numbers of the balls.

    Attributes
    ----------
    params, physical : dict of str to Fraction
        Dimensionless numbers, and quantities in SI units.
    where : str
        File and stage, for messages.
    count : int
        How many balls, or modes, it says that there are; 0 where it leaves that to lists and numbered names.
    counts : str
        The key that says so.
    lists : dict of str to int
        The parameters that it gives as lists, and how long these are.
    """

    params: dict[str, Fraction]
    physical: dict[str, Fraction]
    where: str
    count: int = 0
    counts: str = ""
    lists: dict[str, int] = field(default_factory=dict)

    @classmethod
    def read(cls, form: Mapping[str, Any], where: str) -> Given:
        """Read ``params`` and ``physical``.

        Raises
        ------
        DeclarationError
            If one is no table, has something that is no number, or a list is not as long as there are balls.
        """
        params, physical = (_flat(form.get(key, {}), f"{where}{key}") for key in ("params", "physical"))
        lists = {name: len(value) for name, value in form.get("params", {}).items() if isinstance(value, list)}
        key = next((each for each in COUNTS if each in params), "")
        if not key:
            return cls(params, physical, where, lists=lists)
        count, most = params.pop(key), max(most for what, most in map(counted, system_names()) if f"{what}s" == key)
        if count not in range(1, most + 1):
            raise DeclarationError(f"{where}params.{key} is {float(count):g}; {key} are counted, 1 to {most}")
        for name, length in lists.items():
            if length != count:
                raise DeclarationError(
                    f"{where}params.{name} has {length} values, and {key} = {count}; give a number for all "
                    f"{key}, or one for each"
                )
        return cls(params, physical, where, int(count), key, lists)

    def check(self, kinds: Iterable[Kind]) -> None:
        """Refuse what no kind takes.

        Raises
        ------
        DeclarationError
            With the first name, and the nearest that is allowed.
        """
        specs = list(kinds)
        physical = sorted({name for each in specs for name in quantities(each)})
        names = sorted({name for each in specs for name in stems(each.parameters)})
        known_params(self.params, names, physical, self.where)
        known(self.physical, physical, f"{self.where}physical")
        self.check_count({counts_of(each) for each in specs})

    def check_count(self, keys: Collection[str]) -> None:
        """Refuse a count of balls, or modes, where the system has one, without a number.

        Raises
        ------
        DeclarationError
        """
        if self.count and self.counts not in keys:
            systems = " or ".join(f'"{name}"' for name in system_names() if f"{counted(name)[0]}s" == self.counts)
            raise DeclarationError(
                f"{self.where}params.{self.counts} is {self.count}; the system has one {self.counts[:-1]}, which is "
                f"not counted: leave it out, or give system = {systems}"
            )


def known_params(given: Mapping[str, Fraction], names: list[str], physical: list[str], where: str) -> None:
    """Refuse fixed parameters that there are not; a list, which numbers balls, may have been meant to vary one."""
    for name in given:
        if name not in names and name in physical:
            raise DeclarationError(
                f"{where}params.{name}: {name} is a quantity in SI units; give it as {where.rpartition(': ')[2]}"
                f"physical.{name}, or one of the dimensionless {', '.join(names)}"
            )
        stem = name[:-2]
        if name not in names and stem in names and _NUMBERED.fullmatch(name):
            values = ", ".join(f"{float(value):g}" for each, value in given.items() if each[:-2] == stem)
            raise DeclarationError(
                f"{where}params.{stem} is a list, a number for each ball or mode, and one alone has no list; "
                f"to vary it, use vary.{stem} = [{values}] in a stage"
            )
    known(given, names, f"{where}params")


def counts_of(spec: Kind) -> str:
    """Return the key that counts what has numbers in the system of a kind; empty where nothing has."""
    return f"{counted(spec.system)[0]}s" if spec.balls else ""


def count_of(system: str, names: Iterable[str], count: int = 0) -> int:
    """Return how many balls, or modes, a declaration counts or numbers; 0 where those of a system have no numbers.

    Raises
    ------
    DeclarationError
        If a name has a higher number than there are.

    Examples
    --------
    >>> count_of("parallel", ["A", "mu_1", "beta_3"]), count_of("modes", ["A"], 2), count_of("impact_pair", ["B"])
    (3, 2, 0)
    """
    what, most = counted(system) if system in system_names() else ("", 0)
    if not most:
        return 0
    numbers = {name: int(found[1]) for name in names if (found := _NUMBERED.fullmatch(name))}
    for name, number in numbers.items():
        if number > count > 0:
            raise DeclarationError(f"{name} is of {what} {number}, and {what}s = {count}; give as many as there are")
    return count or max(numbers.values(), default=1)


def read_params(
    spec: Kind, axes: tuple[Axis, ...], own: Given, common: Given, link: Mapping[str, Any], where: str
) -> tuple[dict[str, float], dict[str, Expression]]:
    """Return the fixed parameters of a stage, defaults filled in, and the formulas of those that vary with others.

    What a stage says counts before what its file says. A number for a parameter that every ball has stands for all.

    Raises
    ------
    DeclarationError
        If a name is unknown, given twice, or missing.
    ParameterError
        If a quantity in SI units is out of its range.
    """
    physical = quantities(spec)
    known_params(own.params, stems(spec.parameters), physical, f"{where}.")
    own.check_count({counts_of(spec)})
    known(own.physical, physical, f"{where}.physical")
    varied = {axis.name for axis in axes}
    mine, theirs = (_spread(given.params, spec) for given in (own, common))
    made = _from_physical(spec, own, common, where)
    taken = dict.fromkeys(varied, "vary") | dict.fromkeys(made, "physical") | dict.fromkeys(mine, "params")
    links = read_links(link, spec.parameters, taken, f"{where}.link")
    for name in mine:
        if name in varied:
            raise DeclarationError(f"{where}: {name} is both fixed under params and varied; keep one of them")
    for name in made:
        if name in varied or name in mine or name in theirs:
            raise DeclarationError(f"{where}: {name} is given, and also follows from physical; keep one of them")
    given = {**theirs, **made, **mine}
    _whole_lists(spec, {**common.lists, **own.lists}, {*given, *varied, *links}, where)
    values: dict[str, Fraction] = {}
    for name, default in spec.parameters.items():
        if name in varied or name in links:
            continue
        if name in given:
            values[name] = given[name]
        elif default is not None:
            values[name] = exact(default, name)
        else:
            raise DeclarationError(f"{where}: parameter {name!r} is missing; give it under [params] or vary.{name}")
    free, bound = _split(links, varied)
    if bound and spec.vary == "range":
        name = next(iter(bound))
        raise DeclarationError(
            f"{where}.link.{name}: it would change along vary, and the kind {spec.name!r} follows in the varied "
            "parameters alone; give a number"
        )
    try:
        values |= linked_values(free, values)
    except VinesError as error:
        raise DeclarationError(f"{where}.link: {error}") from None
    return {name: float(values[name]) for name in spec.parameters if name in values}, bound


def _whole_lists(spec: Kind, lists: Mapping[str, int], given: Collection[str], where: str) -> None:
    """Refuse a list that ends before the balls do: what it leaves out would silently be the default."""
    for name, length in lists.items():
        for number in range(length + 1, spec.balls + 1):
            if f"{name}_{number}" in spec.parameters and f"{name}_{number}" not in given:
                raise DeclarationError(
                    f"{where}: params.{name} is a list of {length}, and there are {spec.balls} {counts_of(spec)}; give "
                    f"a number for all {counts_of(spec)}, or one for each"
                )


def _split(
    links: Mapping[str, Expression], varied: Iterable[str]
) -> tuple[dict[str, Expression], dict[str, Expression]]:
    """Return the formulas of fixed parameters alone, and the others."""
    moving = set(varied)
    free: dict[str, Expression] = {}
    bound: dict[str, Expression] = {}
    for name, formula in links.items():
        if moving.intersection(formula.names):
            moving.add(name)
            bound[name] = formula
        else:
            free[name] = formula
    return free, bound


def _from_physical(spec: Kind, own: Given, common: Given, where: str) -> dict[str, Fraction]:
    allowed = quantities(spec)
    given = {name: value for name, value in {**common.physical, **own.physical}.items() if name in allowed}
    if not given:
        return {}
    numbers = {name: float(value) for name, value in given.items()}
    try:
        made = dimensionless(read_system(spec.system, spec.balls), numbers)
    except VinesError as error:
        raise type(error)(f"{where}.physical: {error}") from None
    return {name: exact(value, name) for name, value in made.items() if name in spec.parameters}


def quantities(spec: Kind) -> list[str]:
    """Return the quantities in SI units that a kind may be given: none if it takes no parameters of its system."""
    return list(_quantities(spec.system, spec.balls, tuple(spec.parameters))) if spec.system else []


@functools.cache
def _quantities(system: str, balls: int, parameters: tuple[str, ...]) -> tuple[str, ...]:
    declared = read_system(system, balls)
    if not set(parameters) <= {each.name for each in declared.parameters}:
        return ()
    formulas = " ".join(each.physical for each in declared.parameters)
    return tuple(each.name for each in (*declared.rig, *declared.run) if re.search(rf"\b{each.name}\b", formulas))


def stems(parameters: Iterable[str]) -> list[str]:
    """Return names of parameters, and those that stand for one of each ball or mode."""
    return list(_stems(tuple(parameters)))


@functools.cache
def _stems(names: tuple[str, ...]) -> list[str]:
    return [*names, *dict.fromkeys(name[:-2] for name in names if _NUMBERED.fullmatch(name) and name[:-2] not in names)]


def _spread(given: Mapping[str, Fraction], spec: Kind) -> dict[str, Fraction]:
    """Return what is given, a number for a parameter of every ball once for each that has none of its own."""
    found = {name: value for name, value in given.items() if name in spec.parameters}
    for name, value in given.items():
        if name not in spec.parameters:
            own = (each for each in spec.parameters if _NUMBERED.fullmatch(each) and each[:-2] == name)
            found |= {each: value for each in own if each not in found}
    return found


def _flat(form: object, where: str) -> dict[str, Fraction]:
    if not isinstance(form, Mapping):
        raise DeclarationError(f"{where} is {written(form)}; a table of keys is needed here")
    found: dict[str, Fraction] = {}
    for name, value in form.items():
        if isinstance(value, list):
            found |= {f"{name}_{k}": exact(each, f"{where}.{name}[{k - 1}]") for k, each in enumerate(value, start=1)}
        elif isinstance(value, Mapping):
            remedy = f"to vary it, write vary.{name} = {written(value)} in a stage"
            raise DeclarationError(f"{where}.{name} is a range; a fixed parameter is a number; {remedy}")
        else:
            found[name] = exact(value, f"{where}.{name}")
    return found
