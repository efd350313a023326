"""``run.json`` and the ``rig.json`` of its campaign: read, laid over each other, and checked as one."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from vines.errors import RigError, nearest
from vines.rig.ingest._run_form import CampaignForm, Proposal, RunForm, Stated

__all__ = ["Told", "holding", "read_json", "stated_run"]

_OF_THE_DAY = (
    "protocol", "f_cmd", "E_cmd", "settle", "ball", "temperature_before", "temperature_after", "ringdown", "E_meas",
)  # fmt: skip
"""Keys that say what was done in a run: its own stand before those of the campaign without a reason."""
_FORCED = ("f_cmd", "E_cmd", "settle")
"""Keys of a campaign that don't speak of its ring-downs."""
_BY_PART = ("materials", "more")
"""Keys whose entries are inherited one by one."""
_NEVER = ("run_id", "start_utc", "overrule", "part")


@dataclass(frozen=True, slots=True)
class Told:
    """What is stated of a run, and where.

    Attributes
    ----------
    form : RunForm
        All of it.
    came_from : mapping of str to str
        File or proposal that a key was taken from.
    overruled : tuple of str
        What ``rig.json`` says, what is taken, and why.
    """

    form: RunForm
    came_from: Mapping[str, str]
    overruled: tuple[str, ...] = ()


def read_json(path: Path, kind: Any = RunForm) -> dict[str, Any]:
    """Return the entries of ``run.json`` or ``rig.json`` without comments.

    Parameters
    ----------
    path : Path
    kind : type
        What it may say: `RunForm` or `CampaignForm`.

    Raises
    ------
    RigError
        If it can't be read, is no JSON object, or has a key that there is not.
    """
    try:
        form = json.loads(path.read_text("utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as broken:
        raise RigError(f"{path} is not JSON: {broken}") from None
    except OSError as error:
        raise RigError(f"{path} cannot be read: {error.strerror}") from None
    if not isinstance(form, dict):
        raise RigError(f"{path}: it is not an object {{...}}")
    given = {key: value for key, value in form.items() if not key.startswith("_")}
    known = [field.name for field in msgspec.structs.fields(kind)]
    for key in sorted(set(given) - set(known)):
        if key in _NEVER:
            raise RigError(f"{path}: {key} is a run's own: it belongs into the run.json of each")
        raise RigError(f"{path}: unknown key {key!r}: {nearest(key, known)}; anything else goes under more")
    return given


def stated_run(path: Path, shared: Path | None) -> Told:
    """Read ``run.json``, over the ``rig.json`` of its campaign if there is one.

    A value of the run's own stands before that of the campaign. What describes the rig needs a reason to differ, under
    ``overrule``; what was done in a run does not. What ``vines rig init`` filled in yields to the campaign.

    Raises
    ------
    RigError
        If they don't say what they must; one line.
    """
    own = read_json(path)
    if shared is None:
        run = _checked(own, path)
        return Told(run, {key: f"proposed by {note.by}" for key, note in holding(run).items()})
    base = read_json(shared, CampaignForm)
    _convert({key: value for key, value in base.items() if not _is_null(value)}, CampaignForm, shared)
    notes = {**(base.pop("proposed", None) or {}), **(own.pop("proposed", None) or {})}
    own.setdefault("run_id", path.absolute().parent.name)
    if own.get("protocol", base.get("protocol")) == "ringdown":
        base = {key: value for key, value in base.items() if key not in _FORCED}
        own = {"settle": 0.0, "f_cmd": None, "E_cmd": None, "ball": False} | {
            key: value for key, value in own.items() if value is not None
        }
    else:
        base.setdefault("ball", True)
    mine, ours = _parts(own), _parts(base)
    reasons = own.get("overrule", {})
    proposed = _standing(_convert(notes, dict[str, Proposal], path), own)
    came_from: dict[str, str] = {}
    overruled: list[str] = []
    merged: dict[str, Any] = {}
    for key in dict.fromkeys([*ours, *mine]):
        theirs, value = ours.get(key), mine.get(key)
        if value is None and theirs is None:
            merged[key] = None
        elif value is None or (theirs is not None and key in proposed):
            merged[key], came_from[key] = theirs, "rig.json"
        else:
            merged[key] = value
            came_from[key] = f"proposed by {proposed[key].by}" if key in proposed else "run.json"
            if theirs is None or theirs == value or key in _OF_THE_DAY:
                continue
            if not isinstance(reasons, Mapping) or not reasons.get(key):
                raise RigError(
                    f"{path}: {key} is {_say(value)}, but {shared} says {_say(theirs)}; write why into "
                    f'"overrule": {{"{key}": "..."}}, or leave it out'
                )
            overruled.append(f"{key}: rig.json says {_say(theirs)}, {_say(value)} is taken: {reasons[key]}")
    whole: dict[str, Any] = {}
    for key, value in merged.items():
        name, _, part = key.partition(".")
        if part and value is not None:
            whole.setdefault(name, {})[part] = value
        elif not part:
            whole[name] = value
    came_from.pop("overrule", None)
    return Told(_checked({**whole, "proposed": notes}, path, shared), came_from, tuple(overruled))


def holding(run: RunForm) -> dict[str, Proposal]:
    """Return what ``vines rig init`` filled in of a run and nobody has changed."""
    return _standing(run.proposed, msgspec.to_builtins(run))


def _standing(notes: Mapping[str, Proposal], form: Mapping[str, Any]) -> dict[str, Proposal]:
    now = _parts(form)
    return {key: note for key, note in notes.items() if key in now and now[key] == note.value}


def _parts(form: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries that are inherited one by one, what is null as None."""
    found: dict[str, Any] = {}
    for key, value in form.items():
        if key in _BY_PART and isinstance(value, Mapping):
            found |= {f"{key}.{part}": None if _is_null(each) or each == "" else each for part, each in value.items()}
        else:
            found[key] = None if _is_null(value) or value in ([], "") else value
    return found


def _is_null(value: object) -> bool:
    return value is None or (isinstance(value, Mapping) and bool(value) and all(map(_is_null, value.values())))


def _say(value: object) -> str:
    if isinstance(value, Mapping) and set(value) == {"value", "u"}:
        return f"{value['value']} +- {value['u']}"
    return json.dumps(value)


def _checked(given: dict[str, Any], path: Path, shared: Path | None = None) -> RunForm:
    """Return a run whose entries are all there and fit."""
    if empty := _empty(given, shared is not None):
        both = f"{path}: still null" if shared is None else f"{path}: stated neither there nor in {shared}"
        tail = "README.md of 'vines rig init' says what each is"
        raise RigError(f"{both}: {', '.join(empty)}; {tail}")
    optional = ("E_meas", "f_cmd", "E_cmd", "part")
    kept = {key: value for key, value in given.items() if value is not None or key in optional or shared is None}
    run = _convert(kept, RunForm, path)
    try:
        run = _with_forces(run)
    except msgspec.ValidationError as unfit:
        raise RigError(f"{path}: {unfit}") from None
    for name, value in (("M", run.M.value), ("m", run.m.value), ("b", run.b.value)):
        if not value > 0:
            raise RigError(f"{path}: {name} is {value:g}, allowed is {name} > 0")
    return run


def _convert(given: Any, kind: Any, path: Path) -> Any:
    try:
        return msgspec.convert(given, kind)
    except msgspec.ValidationError as unfit:
        raise RigError(f"{path}: {unfit}") from None


def _with_forces(run: RunForm) -> RunForm:
    """Return a run whose friction and tilt, under more, are numbers with uncertainties, or not there if null."""
    more = dict(run.more)
    for name in ("friction", "tilt"):
        stated = more.get(name)
        if stated is None or (isinstance(stated, Mapping) and all(part is None for part in stated.values())):
            more.pop(name, None)
            continue
        try:
            msgspec.convert(stated, Stated)
        except msgspec.ValidationError as unfit:
            wanted = '{"value": ..., "u": ...} in m/s^2, or null if it was not measured'
            raise msgspec.ValidationError(f"more.{name}: {unfit}; allowed is {wanted}") from None
    return msgspec.structs.replace(run, more=more)


def _empty(form: Mapping[str, Any], inherits: bool) -> list[str]:
    """Return the keys that are null and must not be, and in a campaign those that are nowhere."""
    command = ("f_cmd", "E_cmd")
    needed = [field.name for field in msgspec.structs.fields(RunForm) if field.required] if inherits else []
    found = []
    for key in dict.fromkeys([*needed, *form]):
        value = form.get(key)
        if value is None and key in command and form.get("protocol") != "ringdown":
            found.append(f"{key} (null for protocol ringdown only)")
        elif value is None and key not in (*command, "E_meas", "part") and not (inherits and key not in needed):
            found.append(key)
        elif key in ("M", "m", "b", "E_meas") and isinstance(value, Mapping):
            found += [f"{key}.{part}" for part, number in value.items() if number is None]
    return found
