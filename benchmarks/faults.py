"""Every fault in every file that the store writes, and what each command does: written to docs/damage.md.

Run as ``python -m benchmarks.faults``; it takes some minutes. That no command is ever wrong is asserted by
``tests/stages/test_faults.py``, whose injections these are.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

from tests.stages.test_faults import FAULTS, files_of, inject, run_two

PAGE = Path(__file__).resolve().parent.parent / "docs" / "damage.md"
COMMANDS = ("status", "query", "verify", "gc", "export", "run")
HEAD = """\
# Damage: every file that the store writes, hurt

Written by `python -m benchmarks.faults`. Each file below `data/` of a small pipeline (a sweep `up`, a `run`,
a `picture`) was deleted, truncated (to nothing or to half), had a bit flipped, and was replaced by the same
file of another pipeline, one at a time: {count} faults. Then the commands were called in the order of the
columns. Kernels have tests of their own (`tests/kernels/test_cache.py`). Two more faults, a JSON object without
content and a link to itself, are in the full tests and end as those here.

- **named**: told in a line with what mends it, exit code 1 or 2; no traceback, no wrong number.
- **right**, **up to date**, **whole**, **nothing to do**: what was hurt is not needed, and the answer is that
  of the whole store, byte for byte. A part of a pool is needed only when rows are taken from it; before,
  `verify` alone reads it.
- **mended**: the run made it again, and every result has the bytes that it had; points were computed only
  where their part was hurt.
- **keeps points**: no points are garbage.

| file | fault | {commands} |
|---|---|{lines}|
"""


def rows(table: list[tuple[str, str, dict[str, str]]]) -> list[str]:
    """Return a line for each file and outcome; faults with one outcome stand together."""
    found: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for fault, name, said in table:
        faults = found.setdefault((name, tuple(said[command] for command in COMMANDS)), [])
        if fault not in faults:
            faults.append(fault)
    return [f"| `{name}` | {', '.join(faults)} | {' | '.join(words)} |" for (name, words), faults in found.items()]


def measure(fault: Callable[[Path, Path], None]) -> list[tuple[str, str, dict[str, str]]]:
    """Return for each file that a fault has hurt what each command does."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "injected"
        place.mkdir()
        whole = run_two(Path(folder) / "whole")
        return inject(whole, place, lambda number: fault, files_of(whole))


def write(table: list[tuple[str, str, dict[str, str]]]) -> None:
    """Write the page."""
    order = {name: place for place, name in enumerate(dict.fromkeys(name for _, name, _ in table))}
    table = sorted(table, key=lambda row: order[row[1]])
    head = HEAD.format(count=len(table), commands=" | ".join(COMMANDS), lines="|".join("---" for _ in COMMANDS))
    PAGE.write_text(head + "\n".join(rows(table)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write([row for fault in FAULTS for row in measure(fault)])
