"""The form of a declaration as JSON Schema, for editors that complete and check TOML."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from typing import Any

import msgspec

from vines import schema
from vines.catalogue import Deposit
from vines.model import VI_NES, counted, system_names
from vines.pipeline._kinds import Kind, kinds
from vines.pipeline._names import NAME
from vines.pipeline._parameters import COUNTS, counts_of, quantities, stems

__all__ = ["json_schema"]

_NUMBER = {"type": "number"}
_NUMBERS = {"anyOf": [_NUMBER, {"type": "array", "items": _NUMBER, "minItems": 1}]}
_SYSTEM = "The system, vi_nes if nothing is said"


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a declaration with the kinds that are registered.

    It checks names, types, allowed words and the ranges of options. Parameters that cannot be, and how stages hang
    together, are checked when the declaration is read.
    """
    known = kinds()
    every = [each for spec in known.values() for each in _all_systems(spec).values()]
    parameters = sorted({name for each in every for name in stems(each.parameters)})
    physical = sorted({name for each in every for name in quantities(each)})
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A pipeline of vines",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "title": {"type": "string", "description": "What the pipeline is for"},
            "source": {"type": "string", "description": "Figure or section that it reproduces"},
            "study": {"$ref": "#/$defs/study", "description": "What an export tells a data repository"},
            "include": {"type": "string", "description": "A file that this one is laid over, relative to it"},
            "pipelines": {
                "type": "array",
                "description": "Pipelines that run as one, in this order; instead of stages",
                "items": {"type": "string", "pattern": f"^{NAME.pattern}$"},
                "minItems": 1,
                "uniqueItems": True,
            },
            "params": {
                "type": "object",
                "description": "Parameters of every stage that takes them",
                "additionalProperties": False,
                "properties": {**dict.fromkeys(parameters, _NUMBERS), **{key: _count(key) for key in COUNTS}},
            },
            "physical": _physical(physical),
            "system": {"enum": list(system_names()), "description": _SYSTEM},
            "stages": {
                "type": "object",
                "propertyNames": {"pattern": f"^{NAME.pattern}$"},
                "additionalProperties": {
                    "type": "object",
                    "required": ["kind"],
                    "properties": {"kind": {"enum": sorted(known)}},
                    "allOf": [each for name in sorted(known) for each in _choices(known[name])],
                },
            },
        },
        "not": {"required": ["pipelines", "stages"]},
        "$defs": {
            key: form
            for name in sorted(known)
            for system, spec in _all_systems(known[name]).items()
            for key, form in _kind(spec, _key(name, system))
        }
        | {"axis": _axis(), "study": _study()},
    }


def _count(key: str) -> dict[str, Any]:
    return {"type": "integer", "minimum": 1, "description": f"How many {key} there are"}


def _all_systems(spec: Kind) -> dict[str, Kind]:
    """Return what a kind is for each system that it can do, with as many balls or modes as there may be."""
    if not spec.parameters:
        return {spec.system: spec}
    return {spec.system: spec} | {name: spec.of_system(name, counted(name)[1]) for name in spec.systems}


def _key(kind: str, system: str) -> str:
    return kind if system == VI_NES.name else f"{kind}.{system}"


def _choices(spec: Kind) -> Iterator[dict[str, Any]]:
    """Yield which form a stage of a kind has: that of its system, or of any where the file may name the system."""
    is_kind = {"kind": {"const": spec.name}}
    if not spec.systems:
        yield {"if": {"properties": is_kind}, "then": {"$ref": f"#/$defs/{spec.name}"}}
        return
    forms = {name: {"$ref": f"#/$defs/{_key(spec.name, name)}"} for name in _all_systems(spec)}
    for name, form in forms.items():
        named = {"properties": is_kind | {"system": {"const": name}}, "required": ["system"]}
        yield {"if": named, "then": form}
    yield {
        "if": {"properties": is_kind, "not": {"required": ["system"]}},
        "then": {"anyOf": list(forms.values())},
    }


def _kind(spec: Kind, called: str) -> Iterator[tuple[str, Any]]:
    """Yield the definitions of a kind: of its stages, and where a key names a variant, of the stages of each."""
    if spec.variants is None:
        yield called, _stage(spec, spec.options)
        return
    variants = spec.variants.all()
    key, names = spec.variant, sorted(variants)
    yield (
        spec.name,
        {
            "type": "object",
            "description": _described(spec.options, spec.summary),
            "required": ["kind", key],
            "properties": {
                "kind": {"const": spec.name, "description": spec.summary},
                key: {"enum": names},
                **_options(spec.options),
            },
            "allOf": [
                {"if": {"properties": {key: {"const": name}}}, "then": {"$ref": f"#/$defs/{spec.name}.{name}"}}
                for name in names
            ],
        },
    )
    for name in names:
        yield f"{spec.name}.{name}", _stage(spec, variants[name].options)


def _described(options: type[msgspec.Struct], otherwise: str) -> str:
    return inspect.cleandoc(vars(options).get("__doc__") or otherwise)


def _stage(spec: Kind, options: type[msgspec.Struct]) -> dict[str, Any]:
    properties: dict[str, Any] = {"kind": {"const": spec.name, "description": spec.summary}}
    axes = list(spec.parameters)
    if spec.parameters:
        properties["params"] = {
            "type": "object",
            "description": "Fixed parameters of this stage",
            "additionalProperties": False,
            "properties": {
                **dict.fromkeys(stems(axes), _NUMBERS if spec.balls else _NUMBER),
                **({counts_of(spec): _count(counts_of(spec))} if spec.balls else {}),
            },
        }
        properties["system"] = {"const": spec.system, "description": _SYSTEM}
        properties["link"] = {
            "type": "object",
            "description": "Parameters that follow from others, such as '0.02 - mu_1'",
            "additionalProperties": False,
            "properties": {key: {"type": "string"} for key in axes},
        }
        if named := quantities(spec):
            properties["physical"] = _physical(named)
    if spec.vary != "none":
        form = {"$ref": "#/$defs/axis"} if spec.vary == "grid" else _range(("from", "to"))
        properties["vary"] = {
            "type": "object",
            "description": "Parameters that vary",
            "additionalProperties": False,
            "properties": dict.fromkeys(axes, form),
        }
    if spec.vary == "grid":
        names = {"type": "array", "items": {"enum": axes}, "minItems": 2}
        properties["zip"] = {
            "description": "Axes that run together",
            "anyOf": [names, {"type": "array", "items": names, "minItems": 1}],
        }
        properties["refine"] = _refine(spec)
    if spec.carry:
        properties["carry"] = _carry(axes)
    if spec.needs:
        properties["needs"] = {
            "type": "array",
            "description": "Stages whose results it takes",
            "items": {"type": "string", "pattern": f"^{NAME.pattern}$"},
            "uniqueItems": True,
        }
    properties |= _options(options)
    return {
        "type": "object",
        "description": _described(options, spec.summary),
        "additionalProperties": False,
        "properties": properties,
    }


def _options(options: type[msgspec.Struct]) -> dict[str, Any]:
    """Return the options of a stage; structs inside them stand where they are used."""
    (reference,), parts = msgspec.json.schema_components([options], ref_template="{name}")
    properties = parts[reference["$ref"]]["properties"]
    return {name: _inlined(form, parts) for name, form in properties.items() if name not in ("kind", "system")}


def _inlined(form: Any, parts: dict[str, Any]) -> Any:
    if isinstance(form, dict):
        if "$ref" in form:
            # what an option says of itself stands before what the table in it says
            return {**_inlined(parts[form["$ref"]], parts), **{key: form[key] for key in form if key != "$ref"}}
        return {key: _inlined(value, parts) for key, value in form.items()}
    return [_inlined(each, parts) for each in form] if isinstance(form, list) else form


def _study() -> dict[str, Any]:
    (reference,), parts = msgspec.json.schema_components([Deposit], ref_template="{name}")
    return _inlined(reference, parts)


def _physical(names: Iterable[str]) -> dict[str, Any]:
    return {
        "type": "object",
        "description": "Quantities in SI units, angles in degrees, from which parameters follow",
        "additionalProperties": False,
        "properties": dict.fromkeys(names, _NUMBERS),
    }


def _range(keys: tuple[str, ...]) -> dict[str, Any]:
    whole = {"type": "integer", "minimum": 1}
    forms = {"from": _NUMBER, "to": _NUMBER, "count": whole, "step": _NUMBER, "log": {"type": "boolean"}}
    return {
        "type": "object",
        "additionalProperties": False,
        "required": ["from", "to"],
        "properties": {key: forms[key] for key in keys},
    }


def _axis() -> dict[str, Any]:
    values = {"type": "array", "items": _NUMBER, "minItems": 1}
    return {
        "description": "A list, or an evenly spaced range with either count or step",
        "anyOf": [values, _range(("from", "to", "count", "step", "log"))],
    }


def _refine(spec: Kind) -> dict[str, Any]:
    columns = [column.name for column in schema.table(spec.tables[0]).columns if not column.dtype.startswith("list")]
    jumps = {"type": "object", "additionalProperties": _NUMBER}
    return {
        "type": "object",
        "description": "More points where a watched column changes or jumps",
        "additionalProperties": False,
        "required": ["on", "tolerance"],
        "properties": {
            "on": {"type": "array", "items": {"enum": columns}, "minItems": 1},
            "along": {"enum": list(spec.parameters)},
            "tolerance": {"type": "number", "exclusiveMinimum": 0},
            "jump": {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, jumps]},
            "most": {"type": "integer", "minimum": 1},
        },
    }


def _carry(axes: list[str]) -> dict[str, Any]:
    start = {
        "type": "object",
        "additionalProperties": False,
        "required": ["from"],
        "properties": {"from": {"type": "string"}, "at": {"type": "object", "additionalProperties": _NUMBER}},
    }
    table = {
        "type": "object",
        "additionalProperties": False,
        "required": ["axis"],
        "properties": {"axis": {"enum": axes}, "direction": {"enum": ["up", "down"]}, "start": start},
    }
    return {"description": "Each point starts where the one before it ended", "anyOf": [{"enum": axes}, table]}
