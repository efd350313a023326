"""Commented templates: ``run.json``, ``rig.json``, ``channels.tsv`` and a README that explains every entry."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from vines.rig.ingest._channel_table import ALL, COLUMNS
from vines.rig.ingest._run_form import ChannelRow, Proposal, RunForm

__all__ = ["RUN", "SHARED", "campaign_readme", "json_text", "run_readme", "table_text"]

SHARED: dict[str, Any] = {
    "f_cmd": None,
    "settle": None,
    "M": {"value": None, "u": None},
    "m": {"value": None, "u": None},
    "b": {"value": None, "u": None},
    "max_clipped": 0.01,
    "max_offset": 0.05,
    "materials": {"ball": "", "ends": "", "springs": ""},
    "licence": "",
    "doi": "",
    "more": {"friction": {"value": None, "u": None}},
}
"""Entries of a ``rig.json`` to be filled in."""

RUN: dict[str, Any] = {
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
    **{key: SHARED[key] for key in ("max_clipped", "max_offset", "materials", "licence", "doi", "more")},
}
"""Entries of a ``run.json`` to be filled in."""

_README = """# A run of the rig

1. Copy the files of the recorder into raw/ and never change them.
2. Fill in run.json (every null) and channels.tsv (one row a channel; columns are parted by tabs).
3. `vines rig inspect raw/FILE` shows what a file holds; `vines rig ingest .` reads the run or says what is missing.

derived/ is yours: vines writes nothing there but what `vines rig reconstruct` and `compare` find.

{rules}
## run.json

{run}

## channels.tsv

{channels}
"""

_CAMPAIGN = """# A campaign of the rig

1. Fill in rig.json (every null) and channels.tsv: what all runs share is said there once. The row `*` of the table
   holds for all channels that leave a cell empty; a file may be a pattern that fits one file in raw/, such as *.tdms.
2. Fill in what is a run's own in its run.json: every null that has no value in rig.json.
3. `vines rig ingest .` reads all runs; one that cannot be read is a row with the reason.

`vines rig init RUN --from RECORDING` adds a run. What `init` filled in is noted under "proposed", with what it follows
from; look at it. A run may state what rig.json or channels.tsv state too, and then its own holds: what was done in a
run (protocol, command, temperatures) just so, what describes the rig with the reason, under "overrule" of its run.json:
"overrule": {{"M": "weighed again", "lo_acc.sensitivity": "another sensor"}}. A channels.tsv of a run has only the
cells that differ.

{rules}
## rig.json, and run.json of each run

{run}

## channels.tsv

{channels}
"""

_RULES = """Positive is to the right, the direction of x1; the ball hits the LEFT end where x1 - x2 = +b.
Nothing is guessed: a channel without unit, sign, rate, sensitivity, range or delay is refused.
more.friction is the ball's deceleration by friction [m/s^2] from a roll-down test; without it r is known less well.
"""


def run_readme() -> str:
    """Return the README of a run folder."""
    return _README.format(rules=_RULES, run=_list(_notes(RunForm)), channels=_list(_notes(ChannelRow)))


def campaign_readme() -> str:
    """Return the README of a campaign."""
    return _CAMPAIGN.format(rules=_RULES, run=_list(_notes(RunForm)), channels=_list(_notes(ChannelRow)))


def json_text(
    entries: Mapping[str, Any], remarks: Sequence[str] = (), proposed: Mapping[str, Proposal] | None = None
) -> str:
    """Return a form with a comment before each entry.

    Parameters
    ----------
    entries : mapping
        Of ``run.json`` or ``rig.json``.
    remarks : sequence of str
        What is known of its recordings, in words.
    proposed : mapping of str to Proposal, optional
        What of it was filled in, and from what.
    """
    notes = _notes(RunForm)
    form: dict[str, Any] = {"_": "Keys that begin with _ are comments. Replace every null."}
    if remarks:
        form["_recordings"] = list(remarks)
    for key, value in entries.items():
        form[f"_{key}"] = notes[key]
        form[key] = value
    if proposed:
        form["_proposed"] = notes["proposed"]
        form["proposed"] = {key: msgspec.to_builtins(note) for key, note in proposed.items()}
    return json.dumps(form, indent=2, ensure_ascii=False) + "\n"


def table_text(rows: Sequence[Mapping[str, str]] = (), columns: Sequence[str] = COLUMNS) -> str:
    """Return a table with a comment a column, and one row to be filled in if there are none."""
    notes = {name: text for name, text in _notes(ChannelRow).items() if name in columns}
    lines = [
        "# One row a channel, cells parted by tabs; lines with # are comments, n/a is an empty cell.",
        f"# Cells of a row that is called {ALL} hold for all channels that leave them empty.",
    ]
    lines += [f"# {name}: {text}" for name, text in notes.items()]
    example = {
        "name": "lo_disp", "role": "lo_disp", "quantity": "displacement", "dof": "x1", "file": "FILE", "field": "FIELD",
        "t0": "0", "recorder": "1",
    }  # fmt: skip
    lines.append("\t".join(columns))
    lines += ["\t".join(row.get(name) or "n/a" for name in columns) for row in rows or [example]]
    return "\n".join(lines) + "\n"


def _list(notes: Mapping[str, str]) -> str:
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
