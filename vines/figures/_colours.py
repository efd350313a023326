"""The colours of all figures, by names that a declaration may give others."""

from __future__ import annotations

from vines.figures._look import WornColours, WornList, WornPairs

__all__ = [
    "BALLS",
    "CHAOS",
    "COLOURS",
    "COLOUR_NAMES",
    "CURVES",
    "FAMILIES",
    "HUES",
    "PALETTE",
    "REGIME_CLASSES",
    "SETS",
]


def _lighter(colour: str) -> str:
    """Return a colour halfway to white.

    Examples
    --------
    >>> _lighter("#000000")
    '#808080'
    """
    return "#" + "".join(f"{(int(colour[k : k + 2], 16) + 256) // 2:02x}" for k in (1, 3, 5))


COLOURS = WornColours(
    {
        "L": "#c8102e",
        "R": "#0b4ea2",
        "L light": "#ef8a97",
        "R light": "#85b0e6",
        "ink": "#222222",
        "mark": "#555555",
        "stop": "#8f949c",
    },
    follow={"L light": ("L", _lighter), "R light": ("R", _lighter)},
)
"""As in the paper: impacts on the left end red, on the right end blue; light for simulated dots, full for branches;
grey where a ball stops in mid-cavity."""

FAMILIES = WornPairs(
    {
        "symmetric": ("#c8102e", "#0b4ea2"),
        "asymmetric": ("#d0118f", "#0aa0bd"),
        "doubled": ("#7a2bbf", "#0b7d6b"),
        "doubled again": ("#a98bd0", "#6cb8aa"),
        "unequal": ("#e87800", "#2c962c"),
    }
)
"""Colours of branches on L and R: symmetric, asymmetric and unequal (2:1) ones as in the paper's Figs 4 and 5."""

BALLS = WornList("ball", ("#e87800", "#2c962c", "#7a2bbf", "#0aa0bd", "#d0118f", "#8a6d3b", "#555555", "#a39a00"))
"""Colours of balls with numbers, unlike those of the ends; the end of an impact is then its shape."""

PALETTE = WornColours(
    {
        "red": "#c8102e",
        "green": "#2c962c",
        "blue": "#0b4ea2",
        "black": "#222222",
        "orange": "#e87800",
        "magenta": "#d0118f",
        "cyan": "#0aa0bd",
    }
)
"""Colours that declarations name."""

CURVES = WornColours(
    {
        "fold": "#333333",
        "symmetry_breaking": "#c8102e",
        "period_doubling": "#7a2bbf",
        "neimark_sacker": "#0b7d6b",
        "grazing": "#0b4ea2",
        "incomplete_chatter": "#d3005f",
        "release_tangency": "#9a5b00",
    }
)
"""Colours of curves of bifurcations."""

REGIME_CLASSES = WornColours(
    {
        "1:1, symmetric": "#33658a",
        "1:1, asymmetric": "#86bbd8",
        "n:n, n > 1": "#117733",
        "n:m, n ≠ m": "#ddcc77",
        "p > 1 periods": "#aa4499",
        "quasi-periodic": "#e07a1f",
        "chaotic": "#c9c9c9",
        "no impact": "#ffffff",
        "unsettled": "#000000",
    }
)
"""What a point can be, and its colour: told apart by all kinds of colour vision (after Tol's muted scheme)."""

HUES = WornList("attractor", ("#33658a", "#e07a1f", "#117733", "#aa4499", "#ddcc77", "#86bbd8"))
"""Colours of attractors in a map of starts; chaotic ones are grey."""

SETS = WornList("set", ("#33658a", "#8fc1de", "#117733", "#d9b93b", "#aa4499", "#e07a1f", "#7a7a7a", "#7b2d2d"))
"""Colours of what is compared in maps and lines: told apart by all kinds of colour vision, and in grey by steps."""

CHAOS = WornList("chaos", ("#d2d2d2", "#a9a9a9", "#808080"))


COLOUR_NAMES = (
    *COLOURS,
    *PALETTE,
    *(f"{name} {side}" for name in FAMILIES for side in "LR"),
    *(name for own in (BALLS, HUES, SETS, CHAOS) for name in own.names),
    *CURVES,
    *REGIME_CLASSES,
)
"""Names of all colours that a declaration may change."""
