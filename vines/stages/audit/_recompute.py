"""Rows drawn at random, computed again from their provenance and stored start state alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.errors import VinesError
from vines.pipeline import CodeDigests, kind
from vines.stages.audit._again import PointsAgain, start_again
from vines.stages.audit._located import locate_again
from vines.stages.audit._resolved import resolve_again
from vines.stages.audit._systems import base_of, kind_of
from vines.stages.kinds._register import register_kinds

if TYPE_CHECKING:
    from vines.stages.audit._compare import Comparison
    from vines.stages.audit._ledger import Ledger
    from vines.store import Result

__all__ = ["recompute_rows"]

_REDRAWN = 20
"""So many rows are drawn for each that is wanted: those that nothing can be compared with are passed over."""
_SAYS = {
    "points": "settled periodic ones to 1e-9, the others within four standard errors",
    "impacts": "with their point: of settled periodic ones to 1e-9",
    "attractors": "with their point or from their end state, to 1e-9 if settled and periodic",
    "reduced": "to 1e-9",
    "orbits": "solved from a disturbed state, to 1e-9, and flown by the simulator",
    "bifurcations": "located again from beside it, to 1e-9",
    "transients": "with their point: to 1e-9",
    "basins": "each start comes to the attractor of its cell",
    "exit_points": "one point of each result: bit for bit, or samples of one law",
    "exit_regimes": "with their point: bit for bit, or samples of one law",
    "exits": "with their point: bit for bit, but where rounding decides",
}
_OTHERS = "with their point: to 1e-9"
"""Of tables that another package brings."""


@dataclass(frozen=True)
class _Source:
    """The rows of one table of one result."""

    where: str
    result: Result
    table: str

    @property
    def rows(self) -> int:
        return self.result.manifest["tables"][self.table]["rows"]


def recompute_rows(
    ledger: Ledger,
    results: dict[str, Result],
    count: int,
    rng: np.random.Generator,
    say: Callable[[str], object],
) -> None:
    """Draw rows of all kinds of tables in equal shares, compute them again, and note how far off they are.

    Parameters
    ----------
    ledger : Ledger
        Takes what is found.
    results : dict
        Results whose tables can be read, by ``<pipeline>.<stage>``.
    count : int
        How many rows.
    rng : numpy.random.Generator
        Draws them, and the disturbances from which orbits are solved again.
    say : callable
        Gets a line for each table.
    """
    register_kinds()
    sources: dict[str, list[_Source]] = {}
    for where, result in results.items():
        for table in result.tables:
            source = _Source(where, result, table)
            if source.rows and _can(result, table):
                sources.setdefault(table, []).append(source)
    points, codes = PointsAgain(), CodeDigests(None)
    for table, share in _shares({name: sum(s.rows for s in found) for name, found in sources.items()}, count).items():
        say(f"computing {share} rows of {table} again")
        line = ledger.line("recomputed", table, _SAYS.get(base_of(table), _OTHERS), "rows", 1.0)
        for source, place in _draw(sources[table], _REDRAWN * share, rng):
            if line.checked == share:
                break
            if points.passes_over(source.result, source.table, place):
                continue
            try:
                found = _again(source, place, points, rng)
                off, wrong, made = found.largest, found.wrong, found.made
            except VinesError as error:
                off, wrong, made = np.inf, str(error), True
            if not made:
                line.skipped += 1
                continue
            line.checked += 1
            if np.isfinite(off):
                line.largest = max(line.largest, off)
            if wrong:
                line.failed += 1
                aside = "" if _same_code(source.result, codes) else " (it was computed by other code than this)"
                line.first = line.first or f"{source.where}: {table} row {place}: {wrong}{aside}"


def _same_code(result: Result, codes: CodeDigests) -> bool:
    """Say whether the result was computed by the sources that are here now."""
    return codes.digest(kind_of(result).body) == result.manifest["provenance"]["code"]


def _can(result: Result, table: str) -> bool:
    """Say whether a row of the table has what is needed to compute it again."""
    return base_of(table) in ("orbits", "bifurcations") or _from_starts(result, table) or PointsAgain.can(result)


def _from_starts(result: Result, table: str) -> bool:
    """Say whether a row of the table stands for starts, which are settled again."""
    return kind(result.manifest["kind"]).again == "starts" and base_of(table) in ("attractors", "basins")


def _again(source: _Source, place: int, points: PointsAgain, rng: np.random.Generator) -> Comparison:
    """Compute a row again and compare it with the stored one."""
    table = source.table
    match base_of(table):
        case "orbits":
            return resolve_again(source.result, table, place, rng)
        case "bifurcations":
            return locate_again(source.result, table, place)
        case _ if _from_starts(source.result, table):
            return start_again(source.result, table, place)
        case _:
            return points.compare(source.result, table, place)


def _shares(rows: dict[str, int], count: int) -> dict[str, int]:
    """Return how many rows each table gives: equal shares, as far as it has rows.

    Examples
    --------
    >>> _shares({"orbits": 500, "bifurcations": 3}, 10)
    {'orbits': 7, 'bifurcations': 3}
    """
    shares = dict.fromkeys(rows, 0)
    left = min(count, sum(rows.values()))
    while left:
        open_ones = [name for name in rows if shares[name] < rows[name]]
        for name in open_ones[:left]:
            take = max(1, min(left // len(open_ones), rows[name] - shares[name]))
            shares[name] += take
            left -= take
            if not left:
                break
    return {name: share for name, share in shares.items() if share}


def _draw(sources: list[_Source], count: int, rng: np.random.Generator) -> list[tuple[_Source, int]]:
    """Draw rows without putting them back, as many as there are if there are fewer."""
    ends = np.cumsum([source.rows for source in sources])
    total = int(ends[-1])
    drawn: Any = rng.choice(total, size=min(count, total), replace=False)
    which = np.searchsorted(ends, drawn, side="right")
    return [
        (sources[k], int(row - (ends[k - 1] if k else 0)))
        for k, row in zip(which.tolist(), drawn.tolist(), strict=True)
    ]
