"""From TOML to a checked declaration; every mistake is one line with file, key, what is allowed, the nearest name."""

from __future__ import annotations

import copy
import itertools
import math
import tomllib
from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError, VinesError, nearest
from vines.model import VI_NES
from vines.pipeline._axes import Axis, exact, read_axis
from vines.pipeline._declaration import Pipeline, Stage
from vines.pipeline._deposit import read_deposit
from vines.pipeline._include import with_included
from vines.pipeline._kinds import Kind, kind
from vines.pipeline._links import linked_values
from vines.pipeline._names import NAME, RESERVED
from vines.pipeline._options import known, option_names, read_options
from vines.pipeline._parameters import Given, count_of, read_params
from vines.pipeline._points import read_carry, read_refine, read_zipped
from vines.pipeline._written import written
from vines.places import find_root

__all__ = ["GENERAL", "TOP", "load", "read_form"]

TOP = ("include", "params", "physical", "source", "stages", "study", "system", "title")
MOST_POINTS = 100_000_000
"""Points of a stage; their ids take a gigabyte."""
GENERAL = ("carry", "kind", "link", "needs", "params", "physical", "refine", "system", "vary", "zip")


def load(path: Path, overrides: Mapping[str, Any] | None = None, *, root: Path | None = None) -> Pipeline:
    """Read a declaration.

    Parameters
    ----------
    path : Path
        A TOML file; its stem is the name of the pipeline.
    overrides : mapping, optional
        Values that replace those of the file, by dotted key such as ``stages.up.vary.A.count``. Texts are read as
        TOML values where they are such.
    root : Path, optional
        Root of the project; found from the current folder if left out.

    Raises
    ------
    FileMissingError
        If there is no such file.
    DeclarationError
        If it cannot be read; one line with file, key, what is allowed and the nearest name.
    ParameterError, StateError
        If a parameter or start state is one that the model cannot have.
    """
    path = Path(path)
    form = with_included(path)
    if "pipelines" in form:
        raise DeclarationError(f"{path}: a collection of pipelines, which are run, not the file; name one of them here")
    return read_form(path.stem, form, overrides or {}, path, root)


def read_form(
    name: str, declared: Mapping[str, Any], overrides: Mapping[str, Any], path: Path, root: Path | None
) -> Pipeline:
    """Check a declaration that was read from a file or made in Python.

    Parameters
    ----------
    name : str
        Name of the pipeline.
    declared : mapping
        The declaration as plain data.
    overrides : mapping
        Values that replace some of it, by dotted key.
    path : Path
        Where it comes from, for messages.
    root : Path or None
        Root of the project; found from the current folder if None.

    Raises
    ------
    DeclarationError, ParameterError, StateError
        As :func:`vines.pipeline.load`.
    """
    form = _override(declared, overrides, path)
    known(form, TOP, f"{path}")
    if not NAME.fullmatch(name) or name in RESERVED:
        rule = "a name is [a-z][a-z0-9_]* and no reserved word of SQL"
        raise DeclarationError(f"{path}: a pipeline cannot be called {name!r}; {rule}; rename the file")
    tables = _table(form.get("stages", {}), f"{path}: stages")
    if not tables:
        raise DeclarationError(f"{path}: no stages; declare at least one as [stages.NAME]")
    common = Given.read(form, f"{path}: ")
    system = _text(form.get("system", VI_NES.name), f"{path}: system")
    kinds = {stage: _kind(table, common, system, f"{path}: stages.{stage}") for stage, table in tables.items()}
    common.check(kinds.values())
    stages = {stage: _stage(stage, tables[stage], kinds[stage], common, path) for stage in tables}
    title, source = (_text(form.get(key, ""), f"{path}: {key}") for key in ("title", "source"))
    read_deposit(form.get("study"), f"{path}: study")  # refuses what a repository would
    pipeline = Pipeline(name, title, source, path, root or find_root(), stages)
    for stage in stages.values():
        _check_needs(stage, stages, f"{path}: stages.{stage.name}")
    assert pipeline.order  # finds circles
    for stage in stages.values():
        _check_box(stage, f"{path}: stages.{stage.name}")
    for stage in stages.values():
        _check_fit(stage, pipeline)
    return pipeline


def _override(declared: Mapping[str, Any], overrides: Mapping[str, Any], path: Path) -> dict[str, Any]:
    form = copy.deepcopy(dict(declared)) if overrides else dict(declared)
    for dotted, value in overrides.items():
        keys = dotted.split(".")
        place: Any = form
        for depth, key in enumerate(keys[:-1]):
            if keys[0] == "stages" and depth == 1 and key not in place:
                raise DeclarationError(f"{path}: no stage {key!r} to set {dotted}: {nearest(key, place)}")
            place = place.setdefault(key, {})
            if not isinstance(place, dict):
                inner = ".".join(keys[: depth + 1])
                raise DeclarationError(f"{path}: cannot set {dotted}: {inner} is {written(place)}, not a table")
        place[keys[-1]] = _value(value)
    return form


def _value(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    try:
        return tomllib.loads(f"value = {value}", parse_float=Decimal)["value"]
    except tomllib.TOMLDecodeError:
        return value


def _stage(name: str, table: dict[str, Any], spec: Kind, common: Given, path: Path) -> Stage:
    where = f"{path}: stages.{name}"
    if not NAME.fullmatch(name):
        raise DeclarationError(f"{where}: a stage cannot be called {name!r}; a name is [a-z][a-z0-9_]*")
    try:
        form = spec.options_of(table)
    except VinesError as error:
        raise type(error)(f"{where}: {error}") from None
    general = _general(spec)
    own_keys = filter(None, (spec.variant, *option_names(form)))
    if "needs" in table and "needs" not in general:
        start = (
            ", or start from a stage by carry = { axis = …, start = { from = …, at = { … } } }" if spec.carry else ""
        )
        raise DeclarationError(
            f"{where}.needs is {written(table['needs'])}; the kind {spec.name!r} takes no results of other stages: "
            f"leave it out{start}"
        )
    known(table, [*general, *own_keys], where)
    # a kind may have an option of its own under a general key that it does not take, as basins have refine
    shared = {key: value for key, value in table.items() if key in general}
    zipped = read_zipped(shared["zip"], shared.get("vary", {}), f"{where}.zip") if "zip" in shared else ()
    axes = _axes(shared.get("vary", {}), spec, where, {name for names in zipped for name in names})
    _check_zipped(zipped, axes, where)
    _check_count(zipped, axes, where)
    given = Given.read(shared, f"{where}.")
    params, links = read_params(spec, axes, given, common, shared.get("link", {}), where)
    own = {key: value for key, value in table.items() if key not in general}
    if "system" in option_names(form):
        own["system"] = spec.system
    plain = {key: _plain(value, f"{where}.{key}") for key, value in own.items()}
    options = read_options(plain, form, where)
    carry = read_carry(shared["carry"], axes, shared["vary"], f"{where}.carry") if "carry" in shared else None
    refine = None
    if "refine" in shared:
        refine = read_refine(shared["refine"], spec, axes, zipped, carry, f"{where}.refine")
    needs = shared.get("needs", [])
    if not isinstance(needs, list) or not all(isinstance(need, str) for need in needs):
        raise DeclarationError(f'{where}.needs is {written(needs)}; list names of stages, such as ["up"]')
    if len(set(needs)) < len(needs):
        raise DeclarationError(f"{where}.needs names a stage twice; once is enough")
    return Stage(name, spec, options, params, axes, carry, tuple(needs), zipped, refine, links)


def _kind(table: object, common: Given, system: str, where: str) -> Kind:
    stage = _table(table, where)
    if "kind" not in stage:
        raise DeclarationError(f"{where}: 'kind' is missing; every stage has one, such as kind = \"sweep\"")
    try:
        spec = kind(_text(stage["kind"], f"{where}.kind"))
    except DeclarationError as error:
        text = str(error)
        raise DeclarationError(text if text.startswith(where) else f"{where}.kind: {text}") from None
    if not spec.parameters:
        return spec
    own = Given.read(stage, f"{where}.")
    system = _text(stage.get("system", system), f"{where}.system")
    tables = (_table(stage.get(key, {}), f"{where}.{key}") for key in ("vary", "link"))
    names = [*own.params, *own.physical, *(name for each in tables for name in each)]
    try:
        count = own.count or common.count
        return spec.of_system(system, count_of(system, [*names, *common.params, *common.physical], count))
    except VinesError as error:
        raise type(error)(f"{where}: {error}") from None


def _general(spec: Kind) -> list[str]:
    """Return the general keys that a kind allows."""
    grid = spec.vary == "grid"
    allowed = {"carry": spec.carry, "needs": spec.needs, "vary": spec.vary != "none", "zip": grid, "refine": grid}
    allowed |= dict.fromkeys(("link", "params", "physical", "system"), bool(spec.parameters))
    return [key for key in GENERAL if allowed.get(key, True)]


def _axes(form: object, spec: Kind, where: str, zipped: Iterable[str]) -> tuple[Axis, ...]:
    table = _table(form, f"{where}.vary")
    known(table, spec.parameters, f"{where}.vary")
    interval = spec.vary == "range"
    return tuple(
        read_axis(name, value, f"{where}.vary.{name}", interval=interval, zipped=name in zipped)
        for name, value in table.items()
    )


def _check_zipped(zipped: tuple[tuple[str, ...], ...], axes: tuple[Axis, ...], where: str) -> None:
    counts = {axis.name: axis.count for axis in axes}
    for names in zipped:
        if len({counts[name] for name in names}) > 1:
            said = ", ".join(f"{name} has {counts[name]}" for name in names)
            raise DeclarationError(f"{where}.zip: axes that run together need equally many values: {said}")
        rows = list(zip(*(axis.values() for axis in axes if axis.name in names), strict=True))
        if len(set(rows)) < len(rows):
            raise DeclarationError(f"{where}.zip: {', '.join(names)} take the same values twice; each point is once")


def _check_count(zipped: tuple[tuple[str, ...], ...], axes: tuple[Axis, ...], where: str) -> None:
    """Refuse a grid whose ids alone would not fit into memory; an interval has no values and counts as one."""
    together = {name for names in zipped for name in names[1:]}
    points = math.prod(max(1, axis.count) for axis in axes if axis.name not in together)
    if points > MOST_POINTS:
        raise DeclarationError(f"{where}.vary: the axes make {points} points; at most {MOST_POINTS} are in one stage")


def _check_needs(stage: Stage, stages: Mapping[str, Stage], where: str) -> None:
    for need in stage.needs:
        if need not in stages:
            others = [name for name in stages if name != stage.name]
            raise DeclarationError(f"{where}.needs: unknown stage {need!r}: {nearest(need, others)}")
    if stage.carry is None or stage.carry.stage is None:
        return
    source = stages.get(stage.carry.stage)
    fit = [name for name, each in stages.items() if each.kind.tables == stage.kind.tables and name != stage.name]
    if source is None or source.kind.tables[:1] != stage.kind.tables[:1]:
        raise DeclarationError(f"{where}.carry.start.from: {stage.carry.stage!r}: {nearest(stage.carry.stage, fit)}")
    from vines.pipeline._grid import Grid

    at, grid = dict(stage.carry.at), Grid(source)
    if grid.has(at):
        return
    text = f"{where}.carry.start.at is {written(at)}, no point of stage {source.name!r}"
    if set(at) != set(grid.names):
        axes = ", ".join(grid.names) or "nothing"
        raise DeclarationError(f"{text}, which varies {axes}; name one value of each")
    near = " and ".join(written(each) for each in grid.nearest(at))
    raise DeclarationError(f"{text}; nearest: {near}")


def _check_box(stage: Stage, where: str) -> None:
    if stage.kind.check is None and not stage.links:
        return
    ends = [[(axis.name, end) for end in _extremes(axis)] for axis in stage.axes]
    for corner in itertools.product(*ends):
        try:
            there = {**stage.params, **dict(corner)}
            there |= {name: float(value) for name, value in linked_values(stage.links, there).items()}
            params = {name: there[name] for name in stage.kind.parameters}
            if stage.kind.check is not None:
                stage.kind.check(params, stage.options)
        except VinesError as error:
            raise type(error)(f"{where}: {error}") from None


def _check_fit(stage: Stage, pipeline: Pipeline) -> None:
    if stage.kind.fits is None:
        return
    try:
        stage.kind.fits(stage, pipeline)
    except VinesError as error:
        raise type(error)(f"{pipeline.path}: stages.{stage.name}: {error}") from None


def _extremes(axis: Axis) -> tuple[float, ...]:
    ends: tuple[Fraction, ...] = (min(axis.ends), max(axis.ends))
    return tuple(dict.fromkeys(float(end) for end in ends))


def _table(form: object, where: str) -> dict[str, Any]:
    if not isinstance(form, dict):
        raise DeclarationError(f"{where} is {written(form)}; a table of keys is needed here")
    return form


def _text(form: object, where: str) -> str:
    if not isinstance(form, str):
        raise DeclarationError(f"{where} is {written(form)}; a text is needed here")
    return form


def _plain(form: Any, where: str) -> Any:
    if isinstance(form, Decimal | float):
        return float(exact(form, where))
    if isinstance(form, dict):
        return {key: _plain(value, f"{where}.{key}") for key, value in form.items()}
    if isinstance(form, list):
        return [_plain(value, f"{where}[{i}]") for i, value in enumerate(form)]
    return form
