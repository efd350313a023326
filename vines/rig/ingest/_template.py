"""A commented template of a run folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import msgspec

from vines.errors import StoreError
from vines.rig.ingest._run_form import ChannelRow, RunForm

__all__ = ["write_template"]

_RUN: dict[str, Any] = {
    "run_id": "run_001",
    "start_utc": "2026-01-05T09:00:00Z",
    "protocol": "dwell",
    "f_cmd": None,
    "E_cmd": None,
    "settle": None,
    "M": {"value": None, "u": None},
    "m": {"value": None, "u": None},
    "b": {"value": None, "u": None},
    "ball": True,
    "temperature_before": None,
    "temperature_after": None,
    "ringdown": [],
    "E_meas": None,
    "max_clipped": 0.01,
    "max_offset": 0.05,
    "materials": {"ball": "", "ends": "", "springs": ""},
    "licence": "",
    "doi": "",
    "more": {"friction": {"value": None, "u": None}},
}

_README = """# A run of the rig

1. Copy the files of the recorder into raw/ and never change them.
2. Fill in run.json (every null) and channels.tsv (one row a channel; columns are parted by tabs).
3. `vines rig inspect raw/FILE` shows what a file holds; `vines rig ingest .` reads the run or says what is missing.

derived/ is yours: vines writes nothing there and reads nothing from it.

Positive is to the right, the direction of x1; the ball hits the LEFT end where x1 - x2 = +b.
Nothing is guessed: a channel without unit, sign, rate, sensitivity, range or delay is refused.
more.friction is the ball's deceleration by friction [m/s^2] from a roll-down test; without it r is known less well.

## run.json

{run}

## channels.tsv

{channels}
"""


def write_template(folder: Path) -> tuple[Path, ...]:
    """Write ``run.json``, ``channels.tsv``, a README that explains every entry, ``raw/`` and ``derived/``.

    Parameters
    ----------
    folder : Path
        Where; it may exist, but must not have a ``run.json`` or ``channels.tsv``.

    Returns
    -------
    tuple of Path
        What was written.

    Raises
    ------
    StoreError
        If there is a run already; nothing is overwritten.
    """
    if folder.exists() and not folder.is_dir():
        raise StoreError(f"{folder} is a file; choose another name for the folder")
    for name in ("run.json", "channels.tsv", "README.md"):
        if (folder / name).exists():
            raise StoreError(f"{folder / name} exists already; nothing is overwritten: choose another folder")
    for name in ("raw", "derived"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    notes = _notes(RunForm)
    run: dict[str, Any] = {"_": "Keys that begin with _ are comments. Replace every null."}
    for key, value in _RUN.items():
        run[f"_{key}"] = notes[key]
        run[key] = value
    texts = {
        "run.json": json.dumps(run, indent=2) + "\n",
        "channels.tsv": _channels(),
        "README.md": _README.format(run=_list(notes), channels=_list(_notes(ChannelRow))),
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return tuple(folder / name for name in texts)


def _channels() -> str:
    """Return the table with a comment a column and one row to be filled in."""
    notes = _notes(ChannelRow)
    lines = ["# One row a channel, cells parted by tabs; lines with # are comments, n/a is an empty cell."]
    lines += [f"# {name}: {text}" for name, text in notes.items()]
    example = {
        "name": "lo_disp", "role": "lo_disp", "quantity": "displacement", "dof": "x1", "file": "FILE", "field": "FIELD",
        "t0": "0", "recorder": "1",
    }  # fmt: skip
    lines += ["\t".join(notes), "\t".join(example.get(name, "n/a") for name in notes)]
    return "\n".join(lines) + "\n"


def _list(notes: dict[str, str]) -> str:
    return "\n".join(f"- `{name}`: {text}" for name, text in notes.items())


def _notes(kind: type[msgspec.Struct]) -> dict[str, str]:
    """Return the description of each key, as its JSON Schema has it."""
    form = msgspec.json.schema(kind)["$defs"][kind.__name__]["properties"]
    return {name: _note(each) for name, each in form.items()}


def _note(form: dict[str, Any]) -> str:
    """Return the description of a key, which a choice of types has in one of them."""
    inner = (each.get("description", "") for each in form.get("anyOf", ()))
    text = form.get("description") or next((each for each in inner if each), "")
    words = form.get("enum")
    return f"{text} ({', '.join(map(str, words))})" if words else text
