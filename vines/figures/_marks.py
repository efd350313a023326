"""Symbols of bifurcations and styles of lines that all figures share."""

from __future__ import annotations

from typing import Any

from vines.figures._colours import COLOURS

__all__ = ["DOTTED", "MARKS", "mark_style"]

DOTTED: Any = (0, (1, 1.6))
"""Line style of what is unstable."""

MARKS = {
    "symmetry_breaking": ("o", "symmetry breaking"),
    "period_doubling": ("s", "period doubling"),
    "fold": ("D", "fold"),
    "neimark_sacker": ("^", "Neimark–Sacker"),
    "grazing": ("v", "grazing"),
    "incomplete_chatter": ("X", "chatter no longer completes"),
    "release_tangency": ("P", "release without a fall of the contact force"),
    "crossing_sliding": ("8", "a turn becomes a stop"),
    "switching_sliding": ("d", "a ball stops that turned first"),
    "adding_sliding": ("p", "a stop is broken"),
    "grazing_sliding": ("h", "the ball stops on its way"),
    "tie": ("*", "two balls hit together"),
    "pair_turns_real": ("|", "a pair of multipliers turns real"),
}
"""Symbol and name of each type."""


def mark_style(kind: str, size: float = 5.0) -> dict[str, Any]:
    """Return the options of a line of matplotlib that draw the symbol of a type.

    Examples
    --------
    >>> mark_style("fold")["marker"]
    'D'
    """
    symbol, _ = MARKS.get(kind, ("x", kind))
    return {
        "marker": symbol,
        "markersize": 0.85 * size if symbol == "D" else size,
        "markerfacecolor": "white",
        "markeredgecolor": COLOURS["ink"],
        "markeredgewidth": 0.9,
    }
