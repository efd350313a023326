"""What can be told of runs with noise: counts, means and their intervals, shares; and two computations side by side."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.stages.audit._compare import Comparison, compare_rows
from vines.stages.audit._defect import Defect, relative
from vines.stages.audit._systems import base_of

if TYPE_CHECKING:
    from vines.stages.audit._ledger import Ledger
    from vines.stages.audit._rows import Floats, Rows
    from vines.store import Result

__all__ = ["check_exit_counts", "compare_exits", "exit_defects", "exit_point_defects", "exit_regime_defects"]

_REGULAR = ("periodic", "no_impact")
_ERRORS = 4.0

Tables = Mapping[str, Sequence[Mapping[str, Any]]]


def exit_point_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``exit_points``."""
    bad = ~(rows["exits"] <= rows["runs"]) | ~(rows["most_probable"] < rows["regimes"])
    bad |= rows["most_started"] >= rows["regimes"]
    yield Defect("counts", "no more exits than runs; the regimes named are there", 0.0, np.where(bad, np.inf, 0.0))


def exit_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``exits``."""
    to, censored = rows["to"], rows["censored"] == 1
    bad = (np.isnan(to) != censored) | (to == rows["attractor"]) | ~(rows["T_exit"] >= 0)
    yield Defect("runs", "left to another regime, or censored", 0.0, np.where(bad, np.inf, 0.0))


def exit_regime_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``exit_regimes``."""
    plain, exits = rows.text("method") == "runs", rows["exits"]
    mean, low, high = (np.where(np.isnan(rows[name]), np.inf, rows[name]) for name in ("mean", "mean_low", "mean_high"))
    seen = plain & (exits > 0)
    garwood = np.where(plain, _garwood(rows, low, high), np.nan)
    off = relative(np.where(seen, mean, 1.0) * exits, rows["watched"])
    yield Defect("mean", "the time watched over the exits", 1e-12, np.where(seen, off, np.nan))
    yield Defect("interval", "of a Poisson count (Garwood 1936)", 1e-9, garwood)
    told = ~plain & np.isfinite(mean)
    remarked = np.array([bool(each) for each in rows.text("remark")], dtype=bool)
    bad = np.where(told, ~((low <= mean) & (mean <= high)), ~remarked)
    bad = np.where(plain, np.nan, np.where(bad, np.inf, 0.0))
    yield Defect("splitting", "a mean in its interval, or a remark", 0.0, bad)
    shares = [math.fsum(each) - 1.0 if each else 0.0 for each in rows.table.column("to_share").to_pylist()]
    yield Defect("destinations", "their shares sum to 1", 1e-12, np.abs(np.array(shares)))
    sums: dict[str, float] = {}
    for point, own, share in zip(rows.text("point_id"), plain, rows["long_run"], strict=True):
        sums[point] = sums.get(point, 0.0) + (share if own else 0.0)
    total = np.array([abs(sums[point] - 1.0) for point in rows.text("point_id")])
    yield Defect("long run", "the shares of a point sum to 1", 1e-9, total)


def _garwood(rows: Rows, low: Floats, high: Floats) -> Floats:
    """Return how far intervals are from 2 watched/chi2 with 2 exits + 2 and 2 exits degrees of freedom."""
    from scipy.stats import chi2

    exits, twice = rows["exits"], 2.0 * rows["watched"]
    lower = twice / chi2.ppf(0.975, 2 * exits + 2)
    upper = twice / chi2.ppf(0.025, np.maximum(2 * exits, 1))
    above = np.where(exits > 0, relative(np.where(exits > 0, high, 1.0), upper), np.where(np.isinf(high), 0.0, np.inf))
    return np.maximum(relative(low, lower), above)


def check_exit_counts(ledger: Ledger, where: str, result: Result) -> None:
    """Check that what is told of a regime is what its runs add up to."""
    own = {base_of(table): table for table in result.tables}
    if not {"exits", "exit_regimes"} <= set(own):
        return
    table = own["exit_regimes"]
    runs: dict[tuple[str, int], list[Mapping[str, Any]]] = {}
    for row in result.table(own["exits"]).select(["point_id", "attractor", "T_exit", "censored"]).to_pylist():
        runs.setdefault((row["point_id"], row["attractor"]), []).append(row)
    wrong, checked = "", 0
    for place, row in enumerate(result.table(table).to_pylist()):
        if row["method"] != "runs":
            continue
        checked += 1
        all_of_it = runs.get((row["point_id"], row["attractor"]), [])
        wait = row["wait"] if any(each["T_exit"] >= row["wait"] for each in all_of_it) else 0.0
        counted = [each for each in all_of_it if each["T_exit"] >= wait]
        watched = max(math.fsum(each["T_exit"] - wait for each in counted), 1.0)
        told = (row["runs"], row["early"], row["exits"], row["watched"])
        exits = sum(not each["censored"] for each in counted)
        if told != (len(all_of_it), len(all_of_it) - len(counted), exits, watched):
            wrong = wrong or f"{where}: {table} row {place} is not what its runs add up to"
    ledger.note(table, "counts", "those of the runs in " + own["exits"], "rows", wrong, checked)


def compare_exits(comparison: Comparison, table: str, stored: Tables, again: Tables) -> None:
    """Compare the rows of a table of a point; on one machine they come out the same to the last digit.

    On another machine runs of an irregular regime part by rounding. Where most of its exits differ, they are samples:
    means within four standard errors of their difference; of everything else all columns agree to 1e-9.

    Parameters
    ----------
    comparison : Comparison
        Takes what is found.
    table : str
        The table.
    stored, again : mapping of str to sequence of rows
        All tables of the point.
    """
    if all(list(stored[name]) == list(again[name]) for name in stored):
        comparison.made = True
        return
    base = base_of(table)
    names = {base_of(name): name for name in stored}
    irregular = {row["attractor"] for row in stored[names["attractors"]] if row["regime"] not in _REGULAR}
    irregular &= _parted(stored[names["exits"]], again[names["exits"]])
    ours, theirs = stored[table], again[table]
    comparison.same("number of rows", len(ours), len(theirs))
    rests = ("exits", "most_probable", "most_probable_name") if irregular else ()
    for one, other in zip(ours, theirs, strict=False):
        if base == "exit_points":
            compare_rows(comparison, table, one, other, leave=rests)
        elif one["attractor"] not in irregular:
            shares = ("long_run", "long_run_low", "long_run_high") if irregular and base == "exit_regimes" else ()
            compare_rows(comparison, table, one, other, leave=shares)
        elif base == "exit_regimes":
            _means(comparison, one, other)
        else:
            comparison.same("attractor", one["attractor"], other["attractor"])


def _parted(stored: Sequence[Mapping[str, Any]], again: Sequence[Mapping[str, Any]]) -> set[int]:
    """Return the regimes of which no more than half of the exits came out the same."""
    left = Counter(row["attractor"] for row in stored if not row["censored"])
    same = Counter(
        one["attractor"] for one, other in zip(stored, again, strict=False) if not one["censored"] and one == other
    )
    return {row["attractor"] for row in stored if 2 * same[row["attractor"]] <= left[row["attractor"]]}


def _means(comparison: Comparison, one: Mapping[str, Any], other: Mapping[str, Any]) -> None:
    """Compare the rates of exits of two samples; half an exit more keeps those that saw none."""
    a, b = (row["exits"] + 0.5 for row in (one, other))
    off = math.log(a / one["watched"]) - math.log(b / other["watched"])
    comparison.number("logarithm of the rate", 0.0, off, _ERRORS * math.sqrt(1 / a + 1 / b))
