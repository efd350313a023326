"""Figures: tables in, pictures out. Imports no other room but the errors.

Lazy (PEP 562): names of panels cost nothing; numpy and matplotlib are loaded when something is drawn. Where matplotlib
is missing, a function that draws says so when it is imported.
"""

from typing import Any

import lazy_loader

from vines.packages import need

_attached, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


_DRAWS = frozenset({"finish", "save", "save_as", "start_symbol", "style_settings", "wearing"})
"""What needs matplotlib beside the figures themselves."""


def __getattr__(name: str) -> Any:
    if name in _DRAWS or name.endswith("_figure"):
        need("matplotlib")
    return _attached(name)
