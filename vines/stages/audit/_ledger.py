"""What a verification found, one line a check."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Ledger", "Line"]


@dataclass
class Line:
    """One check over everything that was verified.

    Attributes
    ----------
    group : str
        ``files``, ``recomputed``, or a table of ``schemas/``.
    name : str
        What is checked.
    says : str
        What should hold.
    unit : str
        What is counted: rows, files, tables, results.
    checked, skipped, failed : int
        How many were checked, left out because the check does not apply to them, and wrong.
    largest : float
        Largest defect that is finite.
    allowed : float
        Largest defect that is right.
    first : str
        The first one that is wrong, and what is wrong with it; empty if none is.
    """

    group: str
    name: str
    says: str
    unit: str
    allowed: float = 0.0
    checked: int = 0
    skipped: int = 0
    failed: int = 0
    largest: float = 0.0
    first: str = ""

    @property
    def good(self) -> bool:
        """Whether nothing failed."""
        return not self.failed


class Ledger:
    """The lines, in the order in which their checks were first made."""

    def __init__(self) -> None:
        self._lines: dict[tuple[str, str], Line] = {}

    @property
    def lines(self) -> list[Line]:
        """All lines: files, then table by table, then what was computed again."""
        order = {"files": "", "recomputed": "~"}
        return sorted(self._lines.values(), key=lambda line: order.get(line.group, line.group))

    def line(self, group: str, name: str, says: str, unit: str, allowed: float = 0.0) -> Line:
        """Return the line of a check."""
        return self._lines.setdefault((group, name), Line(group, name, says, unit, allowed))

    def note(self, group: str, name: str, says: str, unit: str, wrong: str, count: int = 1) -> None:
        """Count one thing, or several, that were checked; `wrong` says what is wrong, empty if nothing is."""
        line = self.line(group, name, says, unit)
        line.checked += count
        if wrong:
            line.failed += 1
            line.first = line.first or wrong

    def values(self, line: Line, defects: np.ndarray) -> int:
        """Count the defects of rows and return the place of the first that is wrong, -1 if none is."""
        known = ~np.isnan(defects)
        line.checked += int(known.sum())
        line.skipped += int((~known).sum())
        finite = defects[np.isfinite(defects)]
        line.largest = max(line.largest, float(finite.max(initial=0.0)))
        wrong = np.flatnonzero(known & ~(defects <= line.allowed))
        line.failed += len(wrong)
        return int(wrong[0]) if len(wrong) else -1
