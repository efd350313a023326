"""What a declaration may say: kinds, plots, and the options of each, as the JSON Schema has them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import msgspec

from vines.doors import Register
from vines.pipeline import KINDS, json_schema
from vines.stages.kinds._register import register_kinds
from vines.stages.plots import PLOTS

__all__ = ["declaration_schema", "default_shown", "describe_kind", "describe_plot", "list_kinds", "list_plots"]

_LEAST = {"minimum": "<=", "exclusiveMinimum": "<"}
_MOST = {"maximum": "<=", "exclusiveMaximum": "<"}


def declaration_schema() -> str:
    """Return the JSON Schema of pipeline files with all kinds and plots, as schemas/pipeline.schema.json has it."""
    register_kinds()
    return json.dumps(json_schema(), indent=2, ensure_ascii=False)


def list_kinds() -> list[dict[str, Any]]:
    """Return name and summary of the kinds of stages, their tables, and the package that brings each if not vines."""
    register_kinds()
    return [{**row, "tables": list(KINDS.get(row["name"]).tables)} for row in _listed(KINDS)]


def list_plots() -> list[dict[str, Any]]:
    """Return name and summary of the plots of figures, and the package that brings each if not vines."""
    return list(_listed(PLOTS))


def describe_kind(name: str) -> dict[str, Any]:
    """Return what a stage of a kind does, and its options.

    Raises
    ------
    DeclarationError
        If there is no such kind; the message names the nearest.
    """
    register_kinds()
    return _described(KINDS.get(name), name)


def describe_plot(name: str) -> dict[str, Any]:
    """Return what a plot shows, and its options.

    Raises
    ------
    DeclarationError
        If there is no such plot; the message names the nearest.
    """
    register_kinds()
    return _described(PLOTS.get(name), f"figure.{name}")


def _listed(things: Register[Any]) -> Iterator[dict[str, Any]]:
    for name, thing in sorted(things.all().items()):
        yield {"name": name, "summary": thing.summary, "package": things.origin(name)}


def _described(thing: Any, key: str) -> dict[str, Any]:
    form = json_schema()["$defs"][key]
    fields = msgspec.structs.fields(thing.options)
    own = {field.encode_name: form["properties"][field.encode_name] for field in fields}
    options = list(_options(own, [field.encode_name for field in fields if field.required], ""))
    return {"name": thing.name, "summary": thing.summary, "description": form["description"], "options": options}


def _options(forms: Mapping[str, Any], required: Iterable[str], prefix: str) -> Iterator[dict[str, Any]]:
    """Yield a row for each option; those of the tables in a list of tables follow with its name before theirs."""
    for name, form in forms.items():
        yield {
            "option": prefix + name,
            "type": _type(form),
            "default": form.get("default"),
            "required": name in required,
            "meaning": form.get("description", ""),
        }
        for inner in (form, form.get("items", {}), *form.get("anyOf", ())):
            if isinstance(inner, dict) and "properties" in inner:
                yield from _options(inner["properties"], inner.get("required", ()), f"{prefix}{name}.")


def _type(form: Mapping[str, Any]) -> str:
    """Return a form in words.

    Examples
    --------
    >>> _type({"anyOf": [{"type": "integer", "minimum": 2}, {"type": "null"}]}), _type({"enum": ["up", "down"]})
    ('integer >= 2', 'up | down')
    >>> _type({"type": "number", "exclusiveMinimum": 0, "maximum": 1})
    '0 < number <= 1'
    """
    if "enum" in form:
        return " | ".join(map(str, form["enum"]))
    if "anyOf" in form:
        return " or ".join(_type(each) for each in form["anyOf"] if each != {"type": "null"})
    what = str(form.get("type", "anything"))
    if what == "array":
        inner = form.get("prefixItems")
        return f"[{', '.join(map(_type, inner))}]" if inner else f"list of {_type(form.get('items', {}))}"
    if what == "object":
        return "table"
    least = next((f"{form[key]:g} {sign}" for key, sign in _LEAST.items() if key in form), "")
    most = next((f"{sign} {form[key]:g}" for key, sign in _MOST.items() if key in form), "")
    if least and not most:
        number, sign = least.split()
        return f"{what} {sign.replace('<', '>')} {number}"
    return " ".join(filter(None, (least, what, most)))


def default_shown(row: Mapping[str, Any]) -> str:
    """Return the default of an option as a declaration would write it; ``required`` where there is none.

    Examples
    --------
    >>> default_shown({"required": False, "default": 400}), default_shown({"required": True, "default": None})
    ('400', 'required')
    """
    if row["required"]:
        return "required"
    # That of a table of options is said by its options.
    return (
        ""
        if row["default"] is None or (row.get("type") == "table" and row["default"])
        else json.dumps(row["default"], ensure_ascii=False)
    )
