"""Which attractors of several sweeps are one, so that each is drawn once and coexisting ones are seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa

from vines.stages.bodies._coexisting import SAME

__all__ = ["Seen", "all_attractors"]

ERRORS = 4.0
"""Two chaotic motions are two attractors if K2/K1 and rms x1 both differ by more than so many standard errors."""

_IRREGULAR = ("chaotic", "unsettled")
_FROM_POINTS = (
    *("regime", "name", "n", "m", "p"),
    *("kinetic_ratio", "kinetic_ratio_error", "max_abs_x1", "rms_x1", "rms_x1_error"),
)


@dataclass(frozen=True, slots=True)
class Seen:
    """An attractor at a value of the varied parameter, its measures, and how it was found (a place in ``FOUND``)."""

    x: float
    kinetic_ratio: float
    max_abs_x1: float
    found: int


def all_attractors(axis: str, points: Sequence[pa.Table], others: Sequence[pa.Table]) -> list[Seen]:
    """Return every attractor once, with the measures of the first stage that came to it.

    Parameters
    ----------
    axis : str
        The varied parameter.
    points : sequence of pyarrow.Table
        Rows of ``points`` of the stages, one a value of the parameter; the first stage goes before the others.
    others : sequence of pyarrow.Table
        Rows of ``attractors`` of the same stages: what random starts came to. Looked at last.

    Returns
    -------
    list of Seen
        In ascending order of the parameter.
    """
    known: dict[float, list[dict[str, Any]]] = {}
    seen: list[Seen] = []
    sources = [(min(k, 1), table.select([axis, *_FROM_POINTS]).to_pylist()) for k, table in enumerate(points)]
    sources += [(2, _random(table)) for table in others]
    for found, rows in sources:
        for row in rows:
            there = known.setdefault(row[axis], [])
            if row["kinetic_ratio"] is None or any(one_attractor(each, row) for each in there):
                continue
            there.append(row)
            seen.append(Seen(row[axis], row["kinetic_ratio"], row["max_abs_x1"], found))
    return sorted(seen, key=lambda one: (one.x, one.found))


def _random(table: pa.Table) -> list[dict[str, Any]]:
    rows = [row for row in table.to_pylist() if row["attractor"] > 0]
    return [{**row, **_counts(row["name"])} for row in rows]


def _counts(name: str | None) -> dict[str, int | None]:
    """Return n, m and p of a name.

    Examples
    --------
    >>> _counts("2:1"), _counts("2:2/2T")
    ({'n': 2, 'm': 1, 'p': 1}, {'n': 2, 'm': 2, 'p': 2})
    """
    if name is None:
        return dict.fromkeys("nmp")
    counts, _, period = name.partition("/")
    n, m = counts.split(":")
    return {"n": int(n), "m": int(m), "p": int(period.rstrip("T") or 1)}


def one_attractor(a: dict[str, Any], b: dict[str, Any]) -> bool:
    """Return whether two rows are one attractor, or mirror images of each other.

    Periodic ones are told apart by their impacts and measures. Of irregular ones too little is known to tell them apart
    where one row has no standard errors; else their means must differ clearly.
    """
    kinds = [("irregular" if row["regime"] in _IRREGULAR else row["regime"]) for row in (a, b)]
    if kinds[0] != kinds[1]:
        return False
    if kinds[0] == "periodic":
        if (a["p"], sorted((a["n"], a["m"]))) != (b["p"], sorted((b["n"], b["m"]))):
            return False
        names = ("kinetic_ratio", "max_abs_x1")
        return all(abs(a[name] - b[name]) <= SAME * (1.0 + abs(a[name])) for name in names)
    return not all(_clearly(a, b, name) for name in ("kinetic_ratio", "rms_x1"))


def _clearly(a: dict[str, Any], b: dict[str, Any], name: str) -> bool:
    first, second = (row.get(f"{name}_error") for row in (a, b))
    if first is None or second is None:
        return False
    return abs(a[name] - b[name]) > ERRORS * math.hypot(first, second) + SAME
