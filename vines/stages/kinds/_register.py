"""The kinds of stages that vines knows: a file each, called as the kind; those with an underscore are shared."""

from __future__ import annotations

import functools

from vines.pipeline import KINDS

__all__ = ["register_kinds"]


@functools.cache
def register_kinds() -> None:
    """Make the kinds of vines known to declarations; calling it again changes nothing."""
    KINDS.add_modules("vines.stages.kinds", "KIND")
