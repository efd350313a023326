"""Two rows side by side, as the promise of reproducibility says (docs/verify.md)."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from vines import schema
from vines.model import PARAMETER_NAMES, Params

__all__ = ["TOLERANCE", "Comparison", "compare_rows", "compare_within_errors", "params_of", "stored_row"]

TOLERANCE = 1e-9
_ERRORS = 4.0


class Comparison:
    """The largest difference, in units of what is allowed, and the first that is too large."""

    def __init__(self) -> None:
        self.largest = 0.0
        self.wrong = ""
        self.made = False
        """Whether anything was compared: a row to which no comparison applies is no row that holds."""

    def number(self, name: str, stored: float | None, again: float | None, allowed: float) -> None:
        """Compare two numbers; missing ones and nan are alike."""
        self.made = True
        a, b = (math.nan if value is None else float(value) for value in (stored, again))
        if math.isnan(a) and math.isnan(b):
            return
        if a == b:
            return
        off = abs(a - b) / allowed if allowed > 0 and math.isfinite(a - b) else math.inf
        self.largest = max(self.largest, off)
        if off > 1 and not self.wrong:
            self.wrong = f"{name} is stored as {stored!r} and comes out as {again!r}"

    def same(self, name: str, stored: Any, again: Any) -> None:
        """Compare what has to be equal; an empty text is like a missing one."""
        self.made = True
        if (stored or None) != (again or None) and not self.wrong:
            self.largest = math.inf
            self.wrong = f"{name} is stored as {stored!r} and comes out as {again!r}"


def compare_rows(
    comparison: Comparison,
    table: str,
    stored: Mapping[str, Any],
    again: Mapping[str, Any],
    *,
    leave: Collection[str] = (),
    tolerance: float = TOLERANCE,
) -> None:
    """Compare all columns of a row: numbers to a tolerance times 1 + |number|, phases around the circle.

    Parameters
    ----------
    comparison : Comparison
        Takes what is found.
    table : str
        Table of ``schemas/``.
    stored, again : mapping
        The two rows.
    leave : collection of str
        Columns that are left out.
    tolerance : float
        What is allowed.
    """
    for column in schema.table(table).columns:
        name = column.name
        if name in leave or name not in stored:
            continue
        a, b = stored[name], again.get(name)
        if column.dtype == "float64":
            if column.unit == "rad" and a is not None and b is not None:
                b = a + math.remainder(b - a, 2 * math.pi)
            comparison.number(name, a, b, tolerance * (1 + abs(a or 0.0)))
        elif column.dtype == "list<float64>":
            one, other = (np.asarray(values if values is not None else ()) for values in (a, b))
            if len(one) != len(other):
                comparison.same(f"number of {name}", len(one), len(other))
                continue
            for k, (x, y) in enumerate(zip(one.tolist(), other.tolist(), strict=True)):
                near = x + math.remainder(y - x, 2 * math.pi) if column.unit == "rad" else y
                comparison.number(f"{name}[{k}]", x, near, tolerance * (1 + abs(x)))
        else:
            comparison.same(name, list(a) if isinstance(a, list) else a, list(b) if isinstance(b, list) else b)


def compare_within_errors(
    comparison: Comparison, stored: Mapping[str, Any], again: Mapping[str, Any], *, names: Collection[str]
) -> None:
    """Compare rows of points that are not periodic: regime, the columns `names`, and the measures within their errors.

    Both rows are samples of the motion, so four standard errors are those of their difference.
    """
    for name in names:
        comparison.number(name, stored[name], again[name], TOLERANCE * (1 + abs(stored[name] or 0.0)))
    for name in ("regime", "settled", "status"):
        comparison.same(name, stored[name], again[name])
    for name in ("kinetic_ratio", "max_abs_x1", "rms_x1", "lyapunov"):
        if f"{name}_error" not in stored:
            continue  # what is shaken has no displacement of its own
        errors = [math.nan if row[f"{name}_error"] is None else row[f"{name}_error"] for row in (stored, again)]
        allowed = _ERRORS * math.hypot(*errors) if all(map(math.isfinite, errors)) else 0.0
        comparison.number(name, stored[name], again[name], max(allowed, TOLERANCE * (1 + abs(stored[name] or 0.0))))


def params_of(row: Mapping[str, Any]) -> Params:
    """Return the parameters of a row."""
    return Params(**{name: row[name] for name in PARAMETER_NAMES})


def stored_row(result: Any, table: str, place: int) -> dict[str, Any]:
    """Return one row of a table of a result, reading no more of the file than its row group."""
    import pyarrow.parquet as pq

    with pq.ParquetFile(result.folder / f"{table}.parquet") as file:
        for number in range(file.num_row_groups):
            rows = file.metadata.row_group(number).num_rows
            if place < rows:
                return file.read_row_group(number).slice(place, 1).to_pylist()[0]
            place -= rows
    raise IndexError(place)
