"""From plain data to the options of a kind; every mistake is one line with file, key, value, and what is allowed."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal, get_args, get_origin

import msgspec

from vines.errors import DeclarationError, nearest
from vines.pipeline._written import written

__all__ = ["known", "option_names", "read_options"]

_LIMIT = re.compile(r"Expected `\w+` (of )?(?P<limit>(length )?[<>].*)")
_WORD = re.compile(r"Invalid enum value '(?P<word>.*)'")
_TYPE = re.compile(r"Expected `(?P<types>[^`]*)`, got `.*`")
_MISSING = re.compile(r"Object missing required field `(?P<key>.*)`")
_TYPES = {
    "array": "a list",
    "bool": "true or false",
    "float": "a number",
    "int": "a whole number",
    "object": "a table",
    "str": "a text",
}
_STEP = re.compile(r"\.(\w+)|\[(\d+)\]")


def known(table: Iterable[str], allowed: Iterable[str], where: str) -> None:
    """Refuse keys that a table cannot have.

    Raises
    ------
    DeclarationError
        With the first of them, and the nearest that is allowed.
    """
    names = list(dict.fromkeys(allowed))
    for key in table:
        if key not in names:
            raise DeclarationError(f"{where}: unknown key {key!r}: {nearest(key, names)}")


def option_names(form: type[msgspec.Struct]) -> tuple[str, ...]:
    """Return the names of options, as a declaration writes them."""
    return tuple(field.encode_name for field in _fields(form))


def read_options(table: Mapping[str, Any], form: type[msgspec.Struct], where: str) -> msgspec.Struct:
    """Return options with their types and ranges checked and their defaults filled in.

    Parameters
    ----------
    table : mapping
        What is declared, as plain data.
    form : type of msgspec.Struct
        The options of a kind.
    where : str
        File and stage, for messages.

    Raises
    ------
    DeclarationError
        If a key, a type, a word or a number is not allowed.

    Examples
    --------
    >>> from typing import Annotated
    >>> Waiting = msgspec.defstruct("Waiting", [("settle", Annotated[int, msgspec.Meta(ge=0)], 400)])
    >>> read_options({}, Waiting, "a.toml: stages.up").settle
    400
    >>> read_options({"settle": -1}, Waiting, "a.toml: stages.up")
    Traceback (most recent call last):
        ...
    vines.errors.DeclarationError: a.toml: stages.up.settle is -1, allowed is settle >= 0
    """
    _known_inside(table, form, where)
    try:
        return msgspec.convert(table, form)
    except msgspec.ValidationError as error:
        raise DeclarationError(_said(error, table, form, where)) from None


@functools.cache
def _fields(form: type[msgspec.Struct]) -> tuple[msgspec.structs.FieldInfo, ...]:
    return msgspec.structs.fields(form)


@functools.cache
def _tables(form: type[msgspec.Struct]) -> tuple[tuple[str, type[msgspec.Struct]], ...]:
    """Return the options that are tables or lists of tables, and the form of these."""
    inner = ((field.encode_name, next(_inside(field.type, msgspec.Struct), None)) for field in _fields(form))
    return tuple((name, each) for name, each in inner if each is not None)


def _known_inside(table: Mapping[str, Any], form: type[msgspec.Struct], where: str) -> None:
    """See that tables inside a stage, such as its start state, or in a list there, have no unknown key either."""
    for name, inner in _tables(form):
        value = table.get(name)
        place = f"{where}.{name}"
        tables = enumerate(value) if isinstance(value, list) else [(None, value)]
        for number, each in tables:
            if isinstance(each, dict):
                at = place if number is None else f"{place}[{number}]"
                known(each, option_names(inner), at)
                _known_inside(each, inner, at)


def _inside(form: Any, wanted: Any) -> Iterator[Any]:
    """Yield what there is of a class in a form, such as the table in a list of tables."""
    if isinstance(form, type) and issubclass(form, wanted):
        yield form
    for part in get_args(form):
        yield from _inside(part, wanted)


def _said(error: msgspec.ValidationError, table: Mapping[str, Any], form: type[msgspec.Struct], where: str) -> str:
    """Turn ``Expected `int` >= 0 - at `$.settle``` into a line with file, key, value, and what is allowed."""
    text, _, place = str(error).partition(" - at `$")
    place = place.rstrip("`")
    limit, word, types, missing = (each.fullmatch(text) for each in (_LIMIT, _WORD, _TYPE, _MISSING))
    if missing is not None:
        return f"{where}{place}: {missing['key']!r} is missing; needed: {', '.join(_required(form, place))}"
    if types is not None:
        value = _at(table, place)
        names = " or ".join(_TYPES.get(each, each) for each in types["types"].split(" | ") if each != "null")
        whole = "int" in types["types"] and isinstance(value, float) and value.is_integer()
        return f"{where}{place} is {written(value)}; allowed is {names}" + (f", such as {value:.0f}" if whole else "")
    if limit is not None:
        allowed = limit["limit"].removesuffix(".0")
        name = "" if allowed.startswith("length") else f"{place.rpartition('.')[2]} "
        return f"{where}{place} is {_value(table, place)}, allowed is {name}{allowed}"
    if word is not None:
        words = list(_literals(_form(form, place)))
        return f"{where}{place} is {word['word']!r}: {nearest(word['word'], words)}"
    return f"{where}{place}: {(text[:1].lower() + text[1:]).replace('`', '')}"


def _value(table: Any, place: str) -> Any:
    found = _at(table, place)
    return f"{found:g}" if isinstance(found, float) else found


def _at(table: Any, place: str) -> Any:
    """Return what stands at a place of the options."""
    for key, number in _STEP.findall(place):
        table = table[key] if key else table[int(number)]
    return table


def _form(form: Any, place: str) -> Any:
    """Return the type of what stands at a place of the options."""
    for key, number in _STEP.findall(place):
        if number:
            continue
        inner = next(_inside(form, msgspec.Struct))
        form = next(field.type for field in _fields(inner) if field.encode_name == key)
    return form


def _required(form: Any, place: str) -> list[str]:
    """Return the keys that a table at a place of the options has to have."""
    return [field.encode_name for field in _fields(next(_inside(_form(form, place), msgspec.Struct))) if field.required]


def _literals(form: Any) -> Iterator[str]:
    if get_origin(form) is Literal:
        yield from map(str, get_args(form))
        return
    for part in get_args(form):
        yield from _literals(part)
