"""Body of the kind ``atlas``: all orbits of a set of words along lines of the forcing amplitude."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vines.model import Params, Word
from vines.orbits import Branch, Families, Orbit, bifurcation_row, branch_row, follow_families, orbit_row, words_up_to
from vines.pipeline import Batch, Job

if TYPE_CHECKING:
    from vines.stages.kinds.atlas import AtlasOptions

__all__ = ["compute"]

Rows = list[dict[str, Any]]


def compute(job: Job[AtlasOptions]) -> Batch:
    """Seek and follow the orbits along the line of every point of the job."""
    options = job.options
    words = [Word(word) for word in options.words] or words_up_to(options.length, options.period)
    tables: dict[str, Rows] = {"atlas": [], "orbits": [], "branches": [], "bifurcations": []}
    for point in job.points:
        for name, rows in _line(options.amplitude, words, point.params).items():
            tables[name] += [{"point_id": point.id, **row} for row in rows]
    return Batch(tables=tables)


def _line(along: Any, words: list[Word], params: dict[str, float]) -> dict[str, Rows]:
    """Return the rows of one line.

    Orbits are those at the amplitudes of the grid. One that continuation leads to is there though the search at its
    own amplitude missed it.
    """
    p = Params(**params, A=along.start)
    values = np.linspace(along.start, along.stop, along.count).tolist()
    ends = (values[0], values[-1])
    families = {word: follow_families(word, p, "A", ends, seeds=values) for word in words}
    branches = [branch for found in families.values() for branch in found]
    orbits = [(orbit, branch.branch_id) for branch in branches for orbit in _at(branch, values)]
    loose = [orbit for found in families.values() for orbit in found.loose]
    everything = [*orbits, *((orbit, None) for orbit in loose)]
    bifurcations = [(found, branch) for branch in branches for found in (*branch.bifurcations, *branch.events)]
    row = {
        **params,
        "from": along.start,
        "to": along.stop,
        "count": along.count,
        "words": ", ".join(map(str, words)),
        "incomplete": _incomplete(families),
        "branches": len(branches),
        "orbits": len(everything),
        "stable": sum(orbit.stable for orbit, _ in everything),
        "loose": len(loose),
        "bifurcations": len(bifurcations),
        "status": "ok",
        "reason": "",
    }
    return {
        "atlas": [row],
        "orbits": [orbit_row(orbit, branch_id=name) for orbit, name in everything],
        "branches": [branch_row(branch) for branch in branches],
        "bifurcations": [bifurcation_row(found, branch_id=branch.branch_id) for found, branch in bifurcations],
    }


def _at(branch: Branch, values: list[float]) -> list[Orbit]:
    wanted = set(values)
    return [orbit for orbit in branch.orbits if orbit.params.A in wanted and orbit.admissible]


def _incomplete(families: dict[Word, Families]) -> str:
    return ", ".join(str(word) for word, found in families.items() if not found.complete)
