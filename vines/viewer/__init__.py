"""Runs in the Rerun viewer: a recording, a picture, a window, a page, or a catalogue of many.

Importing this room loads no rerun (PEP 562): each function does when it is called. Where rerun is missing, the room
says so when one of its names is asked for.
"""

from typing import Any

import lazy_loader

from vines.packages import need

_attached, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name in __all__:
        need("rerun")
    return _attached(name)
