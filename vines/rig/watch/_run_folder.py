"""The run folder that a stream is logged to: what the source states of it, and what is left to a person."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from vines.errors import RigError, StoreError
from vines.rig.ingest import (
    CAMPAIGN,
    COLUMNS,
    RECORDING,
    RUN,
    Proposal,
    json_text,
    run_readme,
    table_text,
)
from vines.rig.watch._report import Report
from vines.rig.watch._stream import Stream

__all__ = ["LoggedRun"]

_DIGITS = 6
_OF_THE_DAY = ("start_utc", "protocol", "f_cmd", "E_cmd", "settle", "temperature_before", "temperature_after")


class LoggedRun:
    """A run folder of a stream, in a campaign or on its own.

    Parameters
    ----------
    folder : Path
        Where; it must not hold a run.
    stream : Stream
        What is logged.
    start_utc : str
        When its first sample was taken.
    settle : float or None
        Seconds for which the rig ran at this point before, if it was watched then.

    Raises
    ------
    StoreError
        If there is a run already.
    RigError
        If its name is none.
    """

    def __init__(self, folder: Path, stream: Stream, start_utc: str, settle: float | None = None):
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", folder.name):
            raise RigError(f"{folder.name!r} is no name of a run; allowed are letters, digits, and _ . - inside")
        for name in ("run.json", "channels.tsv"):
            if (folder / name).exists():
                raise StoreError(f"{folder / name} exists already; nothing is overwritten: give another --name")
        self.folder, self.run_id = folder, folder.name
        self.log = folder / "raw" / f"{folder.name}.mcap"
        self._stream, self._start = stream, start_utc
        self._settle = settle
        self._shared = (folder.absolute().parent / CAMPAIGN).is_file()
        for name in ("raw", "derived"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        self.write()

    def write(self, last: Report | None = None) -> None:
        """Write ``run.json`` and ``channels.tsv``; command and protocol are proposed by what was seen last."""
        stated: dict[str, Any] = {**self._stream.run, "start_utc": self._start}
        if self._settle is not None:
            stated["settle"] = self._settle
        entries = dict.fromkeys(_OF_THE_DAY) if self._shared else {**RUN, "start_utc": None, "protocol": None}
        entries |= {"run_id": self.run_id} | stated
        proposed: dict[str, Proposal] = {}
        by = f"{RECORDING}{self.log.name}, while it was watched"
        if last is not None and last.f is not None and last.E is not None:
            for key, value in (("f_cmd", last.f), ("E_cmd", last.E), ("protocol", "dwell")):
                if entries.get(key) is None:
                    entries[key] = float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
                    proposed[key] = Proposal(entries[key], by)
        if self._shared:  # what is null is taken from the campaign
            entries = {key: value for key, value in entries.items() if value is not None or key != "settle"}
        (self.folder / "run.json").write_text(json_text(entries, (), proposed), encoding="utf-8")
        (self.folder / "channels.tsv").write_text(table_text(self._rows(), self._columns()), encoding="utf-8")
        if not self._shared:
            (self.folder / "README.md").write_text(run_readme(), encoding="utf-8")

    def _rows(self) -> list[dict[str, str]]:
        of_the_log = {"file": self.log.name, "fs": repr(self._stream.rate), "t0": "0", "recorder": "1"}
        own = ("name", "file", "field")
        rows = []
        for each in self._stream.channels:
            row = {**each.cells, **of_the_log, "field": each.name}
            # In a campaign its table says the rest.
            rows.append({key: row[key] for key in own} if self._shared else row)
        return rows

    def _columns(self) -> tuple[str, ...]:
        return ("name", "file", "field") if self._shared else COLUMNS

    @property
    def missing(self) -> list[str]:
        """What ``ingest`` will still ask for, in words; empty where it is known to be all there."""
        if self._shared:
            return []
        form: Mapping[str, Any] = msgspec.json.decode((self.folder / "run.json").read_bytes())
        return [
            key
            for key, value in form.items()
            if not key.startswith("_") and key not in ("E_meas", "part", "proposed") and _is_empty(value)
        ]


def _is_empty(value: object) -> bool:
    return value is None or (isinstance(value, Mapping) and "value" in value and value["value"] is None)
