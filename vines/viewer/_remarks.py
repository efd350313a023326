"""What somebody who looks at a log should know, and what of it can be drawn."""

from __future__ import annotations

from vines.errors import printable
from vines.logs import Log
from vines.viewer._drawn import thinning

__all__ = ["is_foreign", "remarks"]

_DRAWN = ("protobuf", "cdr")
"""Encodings of other people's channels that Rerun decodes."""


def is_foreign(log: Log) -> bool:
    """Return whether a log holds nothing that vines draws, so that Rerun shows it by its own lights."""
    return log.kind == "foreign" and not (log.states.num_rows or log.base.num_rows or log.sensors)


def remarks(log: Log, *, full: bool = False) -> list[str]:
    """Return what somebody who looks at a log should know, a line each: what is missing from it or from the picture.

    Parameters
    ----------
    log : Log
        What is looked at.
    full : bool
        Whether every state of a long run is drawn.
    """
    lines = list(log.remarks)
    if log.kind == "foreign" and not is_foreign(log):
        lines.append("no provenance: nothing vouches that these are the messages that vines wrote")
    if is_foreign(log):
        lines = ["not a log of vines: Rerun shows what it knows"]
        undrawn = [printable(f"{topic} ({kind})") for topic, kind in log.encodings.items() if kind not in _DRAWN]
        if undrawn:
            lines.append(f"Rerun does not draw {', '.join(sorted(undrawn))}")
    elif log.encodings:
        lines.append(f"not drawn: {', '.join(map(printable, log.encodings))}")
    if not log.parameters and (log.states.num_rows or log.kind == "run"):
        lines.append("no parameters: forcing cycles are drawn as if Omega were 1")
    if not full and (left_out := thinning(log)):
        lines.append(f"{left_out}; --full draws all")
    return lines
