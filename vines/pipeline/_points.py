"""Reading what a stage says of its points beside the axes: carried states, axes that run together, refinement."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from vines import schema
from vines.errors import DeclarationError, nearest
from vines.pipeline._axes import Axis, exact
from vines.pipeline._declaration import JUMP, MOST, Carry, Refine
from vines.pipeline._kinds import Kind
from vines.pipeline._written import written

__all__ = ["CARRY", "REFINE", "read_carry", "read_refine", "read_zipped"]

CARRY = ("axis", "direction", "start")
REFINE = ("along", "jump", "most", "on", "tolerance")
_WATCHED = ("bool", "float64", "int8", "int64", "string")


def read_carry(form: object, axes: tuple[Axis, ...], vary: Mapping[str, Any], where: str) -> Carry:
    """Read ``carry``: an axis, or a table with ``axis``, ``direction`` and ``start``.

    Where no direction is given the chain runs as the values were declared: down if they fall.

    Parameters
    ----------
    form : object
        What was declared.
    axes : tuple of Axis
        The varied parameters.
    vary : mapping
        As they were declared.
    where : str
        File and key, for messages.

    Raises
    ------
    DeclarationError
        If the axis is not varied or neither rises nor falls throughout, or a key or value is not allowed.
    """
    table = {"axis": form} if isinstance(form, str) else _table(form, CARRY, where)
    names = [axis.name for axis in axes]
    axis = table.get("axis")
    if axis not in names:
        raise DeclarationError(f"{where}: axis {axis!r} is not varied: {nearest(str(axis), names)}")
    values = _declared(vary[str(axis)], f"{where}: vary.{axis}")
    falls = values[0] > values[-1]
    if isinstance(vary[str(axis)], list) and values != sorted(set(values), reverse=falls):
        raise DeclarationError(
            f"{where}: the values of {axis} neither rise nor fall throughout, and a chain runs up or down; "
            "list them in one order, or make a stage of each stretch that starts from the end of the one before it"
        )
    direction = table.get("direction", "down" if falls else "up")
    if direction not in ("up", "down"):
        raise DeclarationError(f"{where}.direction is {written(direction)}; allowed: up, down")
    if "start" not in table:
        return Carry(axis, direction)
    start = _table(table["start"], ("at", "from"), f"{where}.start")
    stage = start.get("from")
    if not isinstance(stage, str):
        raise DeclarationError(f"{where}.start.from is {written(stage)}; a text is needed here")
    at = start.get("at", {})
    if not isinstance(at, Mapping):
        raise DeclarationError(f"{where}.start.at is {written(at)}; a table of keys is needed here")
    point = {name: float(exact(value, f"{where}.start.at.{name}")) for name, value in at.items()}
    return Carry(axis, direction, stage, tuple(sorted(point.items())))


def _declared(form: object, where: str) -> list[Fraction]:
    """Return the values of a list, or the ends of a range, in the order in which they were declared."""
    values = form if isinstance(form, list) else [form["from"], form["to"]] if isinstance(form, Mapping) else []
    return [exact(value, where) for value in values]


def read_zipped(form: object, vary: object, where: str) -> tuple[tuple[str, ...], ...]:
    """Read ``zip``: axes that run together, one list of names or several.

    Raises
    ------
    DeclarationError
        If a name is not varied or stands in two lists.
    """
    several = isinstance(form, list) and bool(form) and all(isinstance(each, list) for each in form)
    lists: list[Any] = list(form) if several and isinstance(form, list) else [form]
    names = list(vary) if isinstance(vary, Mapping) else []
    seen: list[str] = []
    for each in lists:
        if not isinstance(each, list) or len(each) < 2 or not all(isinstance(name, str) for name in each):
            raise DeclarationError(f'{where} is {written(each)}; list two or more axes, such as ["A", "mu"]')
        for name in each:
            if name not in names:
                raise DeclarationError(f"{where}: axis {name!r} is not varied: {nearest(name, names)}")
        seen += each
    if len(set(seen)) < len(seen):
        raise DeclarationError(f"{where} names an axis twice; it runs together with one set of others")
    return tuple(tuple(each) for each in lists)


def read_refine(
    form: object, spec: Kind, axes: tuple[Axis, ...], zipped: Iterable[tuple[str, ...]], carry: Carry | None, where: str
) -> Refine:
    """Read ``refine``: which columns are watched, along which axis, and down to which distance.

    Raises
    ------
    DeclarationError
        If a column cannot be watched, the axis cannot be refined, or a number is not allowed.
    """
    table = _table(form, REFINE, where)
    columns = {c.name: c.dtype for c in schema.table(spec.tables[0]).columns if c.dtype in _WATCHED}
    on = table.get("on")
    if not isinstance(on, list) or not on or not all(isinstance(name, str) for name in on):
        raise DeclarationError(f'{where}.on is {written(on)}; list columns, such as ["name", "kinetic_ratio"]')
    for name in on:
        if name not in columns:
            raise DeclarationError(f"{where}.on: no column {name!r} to watch: {nearest(name, columns)}")
    if "tolerance" not in table:
        raise DeclarationError(f"{where}: 'tolerance' is missing; say how near two points may come")
    tolerance = _positive(table["tolerance"], f"{where}.tolerance")
    most = table.get("most", MOST)
    if isinstance(most, bool) or not isinstance(most, int) or most < 1:
        raise DeclarationError(f"{where}.most is {written(most)}; allowed is a whole number >= 1")
    along = _along(table.get("along"), axes, zipped, carry, f"{where}.along")
    return Refine(tuple(on), along, tolerance, _jump(table.get("jump"), on, f"{where}.jump"), most)


def _along(
    name: object, axes: tuple[Axis, ...], zipped: Iterable[tuple[str, ...]], carry: Carry | None, where: str
) -> str:
    bound = {each for names in zipped for each in names}
    free = [axis.name for axis in axes if axis.count > 1 and axis.name not in bound]
    if carry is not None:
        free = [each for each in free if each == carry.axis]
    if name is None and len(free) == 1:
        return free[0]
    if name not in free:
        rule = "the carried axis" if carry is not None else "an axis of two or more values that is not zipped"
        raise DeclarationError(f"{where} is {name!r}; points are added along {rule}: {nearest(str(name), free)}")
    return str(name)


def _jump(form: object, on: list[str], where: str) -> tuple[tuple[str, float], ...]:
    if form is None:
        return JUMP
    if not isinstance(form, Mapping):
        return (("", _positive(form, where)),)
    for name in form:
        if name not in on:
            raise DeclarationError(f"{where}: {name!r} is not watched: {nearest(str(name), on)}")
    own = {str(name): _positive(value, f"{where}.{name}") for name, value in form.items()}
    return (*JUMP, *sorted(own.items()))


def _positive(value: object, where: str) -> float:
    number = float(exact(value, where))
    if number <= 0:
        raise DeclarationError(f"{where} is {number:g}; allowed is a number > 0")
    return number


def _table(form: object, allowed: Iterable[str], where: str) -> Mapping[str, Any]:
    if not isinstance(form, Mapping):
        raise DeclarationError(f"{where} is {written(form)}; a table of keys is needed here")
    for key in form:
        if key not in allowed:
            raise DeclarationError(f"{where}: unknown key {key!r}: {nearest(str(key), allowed)}")
    return form
