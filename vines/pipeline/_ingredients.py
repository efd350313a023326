"""What the result of a stage depends on, the keys made of it, and what changed between two of them."""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import msgspec

from vines import schema
from vines.errors import FileMissingError
from vines.model import with_all_balls
from vines.pipeline._code import CodeDigests
from vines.pipeline._declaration import Stage
from vines.places import shipped
from vines.store import key_of

__all__ = ["Ingredients", "gather", "what_changed"]

_CHOICE = ("refine", "vary", "zip")


@dataclass(frozen=True, slots=True)
class Ingredients:
    """Everything that a result depends on, as plain data.

    Attributes
    ----------
    form : dict
        ``kind``, ``options``, ``params``, ``vary``, ``carry``, ``inputs``, ``tables``, ``files``, ``code``, and where
        there are such ``zip``, ``refine``, ``link`` and ``messages`` (the digest of the schema of logs).
    files : tuple of Path
        The files that the kind named.
    """

    form: dict[str, Any]
    files: tuple[Path, ...]

    @property
    def pool_key(self) -> str:
        """Key of the pool of points: all but the values that vary, and how they were chosen."""
        plain = {name: value for name, value in self._plain().items() if name not in _CHOICE}
        return key_of({**plain, "vary": [axis[0] for axis in self.form["vary"]]})

    @property
    def request(self) -> str:
        """Key of exactly what is asked for; for a stage of the whole shape also the key of its result."""
        return key_of(self._plain())

    def provenance(self, key: str) -> dict[str, Any]:
        """Return what files say about their origin: no clock, no host, nothing that differs from run to run."""
        from vines.store import revision, versions

        return {
            **self._plain(),
            "code": self.form["code"]["digest"],
            "key": key,
            "versions": versions(),
            "revision": revision(),
            **self._series(),
        }

    def _series(self) -> dict[str, Any]:
        """Return that flights are not exact, and the order of their series, for a system where that is so."""
        name = self.form["options"].get("system")
        order = with_all_balls(name).order if name else 0
        return {"exact": False, "order": order} if order else {}

    def _plain(self) -> dict[str, Any]:
        return {**self.form, "code": self.form["code"]["digest"]}


def gather(stage: Stage, inputs: Mapping[str, str], origin: str, code: CodeDigests, root: Path) -> Ingredients:
    """Return the ingredients of a stage.

    Parameters
    ----------
    stage : Stage
        The stage.
    inputs : mapping of str to str
        Keys of the results that it needs.
    origin : str
        Identity of the point that starts a carried chain, if another stage gives it.
    code : CodeDigests
        Reads the sources.
    root : Path
        Root of the project, for the files that the kind names.

    Raises
    ------
    FileMissingError
        If such a file is missing.
    """
    spec = stage.kind
    files = spec.files(stage.options, root) if spec.files is not None else ()
    bodies = spec.bodies(stage.options)
    # the stage that the start comes from is known by the identity of its point, whatever the stage is called
    carry = (
        None
        if stage.carry is None
        else {"axis": stage.carry.axis, "direction": stage.carry.direction, "origin": origin}
    )
    form = {
        "kind": spec.name,
        # as JSON gives it back, so that it compares equal to what a pin says
        "options": msgspec.json.decode(msgspec.json.encode(stage.options)),
        "params": stage.params,
        "vary": [axis.canonical() for axis in stage.axes],
        "carry": carry,
        "inputs": [[need, inputs[need]] for need in stage.needs],
        "tables": {name: schema.digest(name) for name in spec.tables},
        "files": {name: _digest(path) for name, path in _named(files, root)},
        "code": {"digest": code.digest(*bodies), "modules": code.modules_of_all(bodies)},
    }
    if stage.zipped:
        form["zip"] = [list(names) for names in stage.zipped]
    if stage.refine is not None:
        form["refine"] = stage.refine.canonical()
    if stage.links:
        form["link"] = {name: formula.canonical for name, formula in stage.links.items()}
    if spec.logs:
        form["messages"] = _digest(shipped("schemas") / "vines.v1.binpb")
    return Ingredients(form, tuple(files))


def _named(files: Sequence[Path], root: Path) -> list[tuple[str, Path]]:
    """Return files with their names, and by their paths where several have one name: run folders are alike."""
    counts = Counter(path.name for path in files)
    return [
        (path.name if counts[path.name] == 1 else Path(os.path.relpath(path, root)).as_posix(), path) for path in files
    ]


def what_changed(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return in words what differs between two sets of ingredients: changed values before → after.

    Examples
    --------
    >>> what_changed({"options": {"settle": 400}}, {"options": {"settle": 800}})
    'settle 400 → 800'
    """
    found: list[str] = []
    if before.get("kind") != now.get("kind"):
        return f"kind {before.get('kind')} → {now.get('kind')}"
    for part in ("params", "options"):
        found += _values(before.get(part, {}), now.get(part, {}))
    found += _axes(before.get("vary", []), now.get("vary", []))
    if before.get("carry") != now.get("carry"):
        found.append(f"carry {_carry(before.get('carry'))} → {_carry(now.get('carry'))}")
    found += _values(before.get("refine", {}), now.get("refine", {}), "refine.")
    found += _values(before.get("link", {}), now.get("link", {}), "link.")
    if before.get("zip") != now.get("zip"):
        found.append(f"zip {_shown(before.get('zip'))} → {_shown(now.get('zip'))}")
    old, new = dict(before.get("inputs", [])), dict(now.get("inputs", []))
    found += [f"input {name} is new" for name in new if name not in old]
    found += [f"input {name} is no longer needed" for name in old if name not in new]
    found += [
        f"input {name} changed ({old[name][:8]} → {new[name][:8]})"
        for name in new
        if name in old and old[name] != new[name]
    ]
    if set(old) == set(new) and list(old) != list(new):
        found.append("the order of the inputs changed")
    for part, word in (("tables", "schema of"), ("files", "file")):
        old, new = before.get(part, {}), now.get(part, {})
        found += [f"{word} {name} changed" for name in {**old, **new} if old.get(name) != new.get(name)]
    if before.get("messages") != now.get("messages"):
        found.append("schema of the logs changed")
    found += _code(before.get("code", {}), now.get("code", {}))
    return "; ".join(found)


def _values(before: Mapping[str, Any], now: Mapping[str, Any], prefix: str = "") -> list[str]:
    found = []
    for name in dict.fromkeys([*before, *now]):
        old, new = before.get(name), now.get(name)
        if isinstance(old, dict) and isinstance(new, dict):
            found += _values(old, new, f"{prefix}{name}.")
        elif old != new:
            found.append(f"{prefix}{name} {_shown(old)} → {_shown(new)}")
    return found


def _shown(value: Any) -> str:
    if value is None:
        return "none"
    return f"{value:.12g}" if isinstance(value, float) else str(value)


def _axes(before: list[Any], now: list[Any]) -> list[str]:
    old, new = ({axis[0]: axis for axis in axes} for axes in (before, now))
    return [
        f"vary.{name} {_axis(old.get(name))} → {_axis(new.get(name))}"
        for name in dict.fromkeys([*old, *new])
        if old.get(name) != new.get(name)
    ]


def _axis(axis: list[Any] | None) -> str:
    if axis is None:
        return "fixed"
    _, form, ends, count = axis
    values = [float(Fraction(end)) for end in ends]
    span = f"{values[0]:.12g} to {values[-1]:.12g}"
    return span if form == "range" else f"{count} values from {span}{' (log)' if form == 'log' else ''}"


def _carry(carry: Mapping[str, Any] | None) -> str:
    if carry is None:
        return "none"
    return f"{carry['axis']} {carry['direction']}" + (" from another stage" if carry["origin"] else "")


def _code(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    if before.get("digest") == now.get("digest"):
        return []
    old, new = before.get("modules", {}), now.get("modules", {})
    names = [name for name in {**old, **new} if old.get(name) != new.get(name)]
    listed = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    return [f"code changed: {listed}" if names else "code changed"]


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except FileNotFoundError:
        raise FileMissingError(f"{path}: there is no such file, and a stage needs it") from None
    except OSError as error:
        raise FileMissingError(f"{path}: it cannot be read, and a stage needs it: {error.strerror}") from None
