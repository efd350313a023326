"""Which attractors of several sweeps are one, so that each is drawn once and coexisting ones are seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pyarrow as pa

from vines.attractors import SAME, Motion, apart

__all__ = ["Seen", "all_attractors"]


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
    known: dict[float, list[Motion]] = {}
    seen: list[Seen] = []
    sources = [(min(k, 1), table.select([axis, *Motion._fields]).to_pylist()) for k, table in enumerate(points)]
    sources += [(2, [row for row in table.to_pylist() if row["attractor"] > 0]) for table in others]
    for found, rows in sources:
        for row in rows:
            there, motion = known.setdefault(row[axis], []), Motion.of_row(row)
            if row["kinetic_ratio"] is None or any(apart(each, motion) <= SAME for each in there):
                continue
            there.append(motion)
            seen.append(Seen(row[axis], row["kinetic_ratio"], row["max_abs_x1"], found))
    return sorted(seen, key=lambda one: (one.x, one.found))
