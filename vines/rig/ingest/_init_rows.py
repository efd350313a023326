"""Rows of ``channels.tsv`` for a run or a campaign that is begun from recordings, or like another run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from vines.rig.formats import RawFile
from vines.rig.ingest._channel_table import ALL, COLUMNS, Cells
from vines.rig.ingest._propose import known_channels
from vines.rig.ingest._run_folder import RunFolder
from vines.rig.ingest._run_form import Proposal

__all__ = ["differing_rows", "like_rows", "shared_rows"]

_PER_FILE = ("field", "unit", "fs", "dialect")
"""Cells in which a recording may differ from that by which a campaign was described."""


def differing_rows(
    base: Sequence[Cells], files: Mapping[str, RawFile]
) -> tuple[list[dict[str, str]], list[Cells], list[str]]:
    """Return the cells in which recordings differ from a shared table, its rows with their files, and what to know."""
    held = {(name, row["field"]): row for name, file in files.items() for row in known_channels(name, file)[0]}
    own, placed, remarks = [], [], []
    for row in base:
        place = next((key for key in held if key[1] == row.cells.get("field")), None)
        last = [key for key in held if key[1].rpartition("/")[2] == row.cells.get("field", "").rpartition("/")[2]]
        place = place or (last[0] if len(last) == 1 else None)
        if place is None:
            if files:
                remarks.append(
                    f"no channel {row.cells.get('field', '?')!r} for {row.name} in {', '.join(files)}: there is "
                    f"{', '.join(key[1] for key in held)}; write its field into channels.tsv of the run"
                )
            continue
        found = held[place]
        cells = {key: found[key] for key in _PER_FILE if key in found and found[key] != row.cells.get(key)}
        if row.cells.get("fs", "file") != "file":
            cells.pop("fs", None)
        if row.cells.get("dialect") is None:
            cells.pop("dialect", None)
        if cells:
            own.append({"name": row.name, **cells})
            remarks.append(f"{row.name} differs from the campaign: {', '.join(f'{k} {v}' for k, v in cells.items())}")
        placed.append(Cells({**row.cells, **cells, "file": place[0]}, row.where))
    return own, placed, remarks


def shared_rows(files: Mapping[str, RawFile]) -> tuple[list[dict[str, str]], dict[str, Proposal]]:
    """Return the table of a campaign, by the recording with the most channels; what all share is in the row ``*``."""
    if not files:
        return [{"name": ALL, "t0": "0", "recorder": "1"}, {"name": "lo_disp", "role": "lo_disp", "dof": "x1"}], {}
    name = max(files, key=lambda each: len(files[each].channels))
    rows, notes = known_channels(name, files[name])
    suffixes = {Path(each).suffix for each in files}
    common = {
        key: rows[0][key]
        for key in ("fs", "t0", "dialect")
        if len({row.get(key) for row in rows}) == 1 and key in rows[0]
    }
    if len({file.dialect for file in files.values()}) > 1:
        common.pop("dialect", None)
        rows = [{key: text for key, text in row.items() if key != "dialect"} for row in rows]
    common["file"] = f"*{suffixes.pop()}" if len(suffixes) == 1 else "*"
    rows = [{key: text for key, text in row.items() if key not in common} for row in rows]
    kept = {key: note for key, note in notes.items() if key.partition(".")[2] not in ("fs", "t0", "dialect")}
    return [{"name": ALL, **common, "recorder": "1"}, *rows], kept


def like_rows(
    other: RunFolder, found: Sequence[Mapping[str, str]], notes: Mapping[str, Proposal]
) -> tuple[list[dict[str, str]], dict[str, Proposal], list[str]]:
    """Return the channels of another run with the files of this one, where they are the same."""
    rows, kept, remarks = [], {key: note for key, note in notes.items() if "." not in key}, []
    by_field = {row["field"]: row for row in found}
    for row in other.rows:
        cells = {key: str(getattr(row, key)) for key in COLUMNS if getattr(row, key) not in (None, "")}
        cells.pop("overrule", None)
        here = by_field.get(row.field)
        if found and here is None:
            remarks.append(
                f"{row.name}: no channel {row.field!r} as {other.form.run_id} has; there is {', '.join(by_field)}"
            )
            cells["file"] = cells["field"] = ""
        elif here is not None:
            cells |= {key: here[key] for key in ("file", "dialect") if key in here}
            told = here.get("unit")
            if told is not None and told != cells.get("unit"):
                remarks.append(f"{row.name}: {other.form.run_id} has it in {cells['unit']}, {here['file']} in {told}")
                cells["unit"] = told
        kept |= {
            f"{row.name}.{key}": Proposal(text, f"{other.form.run_id}, which it is like")
            for key, text in cells.items()
            if key not in ("name", "file", "field", "dialect")
        }
        rows.append(cells)
    return rows, kept, remarks
