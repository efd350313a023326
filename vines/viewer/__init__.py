"""Runs in the Rerun viewer: a recording, a picture, a window, a page, or a catalogue of many.

Importing this room loads no rerun: each function does when it is called.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.viewer._browse import browse, catalogue_of
from vines.viewer._cache import cached_rrd
from vines.viewer._show import save_rrd, screenshot, view, web

if TYPE_CHECKING:
    from vines.viewer._layout import Shown, blueprint

__all__ = [
    "Shown",
    "blueprint",
    "browse",
    "cached_rrd",
    "catalogue_of",
    "save_rrd",
    "screenshot",
    "view",
    "web",
]


def __getattr__(name: str) -> Any:
    if name not in {"Shown", "blueprint"}:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from vines.viewer import _layout

    return getattr(_layout, name)
