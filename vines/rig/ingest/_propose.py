"""What a recording says of itself, as cells of ``channels.tsv`` and entries of ``run.json`` that a person looks at."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest._calibrate import calibrate
from vines.rig.ingest._channel_table import Cells, row_of
from vines.rig.ingest._inspect import channel_facts
from vines.rig.ingest._run_form import RECORDING, Proposal
from vines.rig.ingest._tone import find_tone
from vines.rig.recording import ROLES
from vines.rig.units import si_factor

__all__ = ["Known", "known_channels", "known_run", "role_of"]

_BODIES = {
    "base": r"base\w*|table|shaker|ground|found\w*|exc\w*|tisch|fu(?:ss|ß)punkt",
    "lo": r"lo|osc\w*|mass|masse|primary|slider|cart|schwinger|x1",
    "ball": r"ball|kugel|cam|camera|x2",
}
_QUANTITIES = {
    "displacement": r"disp\w*|pos|position|laser|lvdt|weg|x\d?",
    "velocity": r"vel\w*|vibro\w*|v\d?|schnelle",
    "acceleration": r"acc\w*|a\d?|beschl\w*",
}
_OTHERS = {
    "stinger_force": r"stinger|force|kraft|loadcell",
    "temperature": r"temp\w*|thermo\w*",
    "sound": r"sound|mic\w*|schall\w*",
}
_SUFFIX = {"displacement": "disp", "velocity": "vel", "acceleration": "acc"}
_BLOCKS = 8
_FALLS = 0.97
"""Each eighth of a free decay is smaller than the one before by this and more."""
_FALLEN = 0.7
_DIGITS = 6
_DERIVATIVES = {"base_disp": 0, "base_vel": 1, "base_acc": 2}
_EARLIEST = 1990
"""Before it a start is none: LabVIEW and Unix count from 1904 and 1970."""


@dataclass(frozen=True, slots=True)
class Known:
    """What is known of a run from its recordings.

    Attributes
    ----------
    entries : dict
        Of ``run.json``.
    notes : dict of str to Proposal
        From what each follows, by key.
    said : tuple of str
        Length, rate, start and the like, in words, for a person.
    """

    entries: dict[str, Any] = field(default_factory=dict)
    notes: dict[str, Proposal] = field(default_factory=dict)
    said: tuple[str, ...] = ()


def role_of(name: str, unit: str | None) -> str | None:
    """Return the role that a channel has by its name and unit; ``None`` if they leave it open.

    Examples
    --------
    >>> role_of("daq/lo_disp", "V"), role_of("Base acceleration", "V"), role_of("Table", "m/s^2"), role_of("ai0", "V")
    ('lo_disp', 'base_acc', 'base_acc', None)
    >>> role_of("laser lo", "V"), role_of("lo", "V"), role_of("ball camera", "mm")
    ('lo_disp', None, 'ball_cam')
    """
    last = name.rpartition("/")[2]
    if last.casefold() in ROLES:
        return last.casefold()
    words = [word for word in re.split(r"[^a-zA-Zß0-9]+|(?<=[a-z])(?=[A-Z])", last) if word]
    bodies = [key for key, pattern in _BODIES.items() if any(_is(pattern, word) for word in words)]
    if not bodies:
        others = [role for role, pattern in _OTHERS.items() if any(_is(pattern, word) for word in words)]
        return others[0] if len(others) == 1 else None
    if len(bodies) != 1:
        return None
    if bodies == ["ball"]:
        return "ball_cam"
    quantity = None
    if unit is not None:
        try:
            quantity = si_factor(unit)[0]
        except RigError:
            return None
    if quantity not in _QUANTITIES:
        found = [key for key, pattern in _QUANTITIES.items() if any(_is(pattern, word) for word in words)]
        quantity = found[0] if len(found) == 1 else None
    role = f"{bodies[0]}_{_SUFFIX[quantity]}" if quantity else None
    return role if role in ROLES else None


def _is(pattern: str, word: str) -> bool:
    return re.fullmatch(pattern, word, re.IGNORECASE) is not None


def known_channels(name: str, file: RawFile) -> tuple[list[dict[str, str]], dict[str, Proposal]]:
    """Return cells for each channel of a recording, and what they follow from by ``CHANNEL.COLUMN``.

    Parameters
    ----------
    name : str
        Of the file, below ``raw/``.
    file : RawFile
        What it holds.
    """
    rows: list[dict[str, str]] = []
    notes: dict[str, Proposal] = {}
    for channel in file.channels:
        short = re.sub(r"[^A-Za-z0-9_.-]+", "_", channel.name.rpartition("/")[2]).strip("_.-") or "channel"
        taken = {row["name"] for row in rows}
        own = (
            short if short not in taken else next(f"{short}_{k}" for k in range(2, 999) if f"{short}_{k}" not in taken)
        )
        row = {"name": own, "file": name, "field": channel.name}
        by: dict[str, str] = {}
        if role := role_of(channel.name, channel.unit):
            row["role"], by["role"] = role, "name and unit"
            row["dof"] = {"base": "e", "lo": "x1", "ball": "x2"}.get(role.partition("_")[0], "")
        if channel.unit is not None:
            row["unit"], by["unit"] = channel.unit, "unit in the file"
            if _quantity(channel.unit) not in ("voltage", "count", None):
                row["sensitivity"], by["sensitivity"] = "scaled", "unit in the file"
        if "scale" in channel.about and channel.unit == "count":
            row["scale"], by["scale"] = channel.about["scale"], "scale in the file"
            row["unit"], by["unit"] = channel.about.get("scale_unit", ""), "unit beside its scale"
        if channel_facts(channel).rate:
            row["fs"], by["fs"] = "file", "rate in the file"
        row["t0"] = "0" if channel.start is None else "file"
        if file.dialect:
            row["dialect"], by["dialect"] = file.dialect, "layout as it was found"
        rows.append({key: text for key, text in row.items() if text})
        notes |= {
            f"{own}.{key}": Proposal(row[key], f"{RECORDING}{name}, {what}") for key, what in by.items() if row[key]
        }
    return rows, notes


def _quantity(unit: str) -> str | None:
    try:
        return si_factor(unit)[0]
    except RigError:
        return None


def known_run(files: Mapping[str, RawFile], rows: Sequence[Cells], protocol: str | None = None) -> Known:
    """Return what recordings say of their run.

    Parameters
    ----------
    files : mapping of str to RawFile
        By name.
    rows : sequence of Cells
        What is known of the channels by now; the amplitude of the base needs their sensitivity.
    protocol : str, optional
        If it is known; else a free decay is told from a forced motion.
    """
    found = Known(said=tuple(_summary(name, file) for name, file in files.items()))
    entries, notes = found.entries, found.notes
    name, first = next(iter(files.items()))
    if began := _utc(first.started):
        entries["start_utc"], notes["start_utc"] = began, Proposal(began, f"{RECORDING}{name}, its start")
    seen = list(_seen(files, rows))
    if protocol is None:
        decays = next((one for one in seen if one[0].cells.get("role", "").startswith("lo") and _decays(one[1])), None)
        # A motion that neither decays nor is forced says nothing.
        if decays is not None:
            protocol = "ringdown"
            notes["protocol"] = Proposal(protocol, f"{RECORDING}{name}, free decay of {decays[0].name}")
        elif any(_tone(one[1]) for one in seen):
            protocol = "dwell"
            notes["protocol"] = Proposal(protocol, f"{RECORDING}{name}, it doesn't decay")
    if protocol is not None:
        entries["protocol"] = protocol
    if protocol == "ringdown":
        return found
    order = {"base_disp": 0, "base_vel": 1, "base_acc": 2}
    for row, channel in sorted(seen, key=lambda one: order.get(one[0].cells.get("role", ""), 3)):
        role = row.cells.get("role", "")
        if not role.startswith(("base", "lo")) or (tone := _tone(channel)) is None:
            continue
        if "f_cmd" not in entries:
            entries["f_cmd"] = _rounded(tone)
            notes["f_cmd"] = Proposal(entries["f_cmd"], f"{RECORDING}{name}, strongest line of {row.name}")
        if role in order and (E := _amplitude(row, channel, tone)) is not None:
            entries["E_cmd"] = _rounded(E)
            notes["E_cmd"] = Proposal(entries["E_cmd"], f"{RECORDING}{name}, fundamental of {row.name}")
            break
    return found


def _seen(files: Mapping[str, RawFile], rows: Sequence[Cells]) -> list[tuple[Cells, RawChannel]]:
    held = {(name, channel.name): channel for name, file in files.items() for channel in file.channels}
    found = []
    for row in rows:
        channel = held.get((row.cells.get("file", ""), row.cells.get("field", "")))
        if channel is not None and row.cells.get("role"):
            found.append((row, channel))
    return found


def _summary(name: str, file: RawFile) -> str:
    facts = [channel_facts(each) for each in file.channels]
    rates = sorted({each.rate for each in facts if each.rate})
    long = max((each.samples / each.rate for each in facts if each.rate), default=None)
    parts = [f"{len(facts)} channels"]
    parts += [f"{long:.6g} s"] if long is not None else ["length unknown, for it states no rate"]
    parts += [" and ".join(f"{rate:.9g} Hz" for rate in rates)] if rates else []
    if file.started:
        parts.append(f"started {file.started}" + ("" if _utc(file.started) else " (in no stated zone)"))
    return f"{name}: {file.form}, {', '.join(parts)}"


def _utc(text: str | None) -> str | None:
    """Return a time in UTC as ``run.json`` has it; None if it states no zone.

    Examples
    --------
    >>> _utc("2026-03-02T10:00:00.25+01:00"), _utc("2026-03-02T09:00:00Z"), _utc("02.03.2026 09:00")
    ('2026-03-02T09:00:00.25Z', '2026-03-02T09:00:00Z', None)
    """
    try:
        told = datetime.fromisoformat(text or "")
    except ValueError:
        return None
    if told.tzinfo is None or told.year < _EARLIEST:
        return None
    found = told.astimezone(UTC).replace(tzinfo=None).isoformat()
    return (found.rstrip("0") if "." in found else found) + "Z"


def _values(channel: RawChannel) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_], float] | None:
    """Return samples, which of them are numbers, and their rate."""
    rate = channel_facts(channel).rate
    values = np.asarray(channel.values, np.float64)
    good = np.isfinite(values)
    return (values, good, rate) if rate and good.mean() > 0.5 else None


def _tone(channel: RawChannel) -> float | None:
    """Return the frequency of the strongest line, where there is one."""
    held = _values(channel)
    tone = find_tone(held[0], held[1], held[2], 0.0) if held else None
    return tone.f if tone is not None and tone.clear else None


def _decays(channel: RawChannel) -> bool:
    """Say whether a motion gets smaller all along."""
    held = _values(channel)
    if held is None or len(held[0]) < 64:
        return False
    values = np.where(held[1], held[0], 0.0)
    sizes = np.array([part.std() for part in np.array_split(values - values[held[1]].mean(), _BLOCKS)])
    return bool((sizes[1:] < _FALLS * sizes[:-1]).all() and sizes[-1] < _FALLEN * sizes[0])


def _amplitude(row: Cells, channel: RawChannel, f: float) -> float | None:
    """Return by how much the base moves [m], where its channel is described."""
    try:
        told = row_of(row)
        seen = calibrate(told, channel, max_clipped=1.0)
    except RigError:
        return None
    tone = find_tone(seen.values, seen.valid, seen.rate, seen.start, f)
    if tone is None:
        return None
    return tone.amplitude / (2 * np.pi * f) ** _DERIVATIVES[told.role]


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
