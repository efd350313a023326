"""Runs in the Rerun viewer: a recording, a picture, a window, a page, or a catalogue of many.

Importing this room loads no rerun (PEP 562): each function does when it is called. Where rerun is missing, the room
says so when one of its names is asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from vines.packages import need

if TYPE_CHECKING:
    from vines.viewer._browse import browse, catalogue_of
    from vines.viewer._cache import cached_rrd
    from vines.viewer._layout import Shown, blueprint
    from vines.viewer._remarks import remarks
    from vines.viewer._save import save_rrd
    from vines.viewer._show import screenshot, view, web

__all__ = [
    "Shown",
    "blueprint",
    "browse",
    "cached_rrd",
    "catalogue_of",
    "remarks",
    "save_rrd",
    "screenshot",
    "view",
    "web",
]


_HOME = {
    "Shown": "_layout",
    "blueprint": "_layout",
    "browse": "_browse",
    "cached_rrd": "_cache",
    "catalogue_of": "_browse",
    "remarks": "_remarks",
    "save_rrd": "_save",
    "screenshot": "_show",
    "view": "_show",
    "web": "_show",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    need("rerun")
    return getattr(import_module(f"vines.viewer.{_HOME[name]}"), name)
