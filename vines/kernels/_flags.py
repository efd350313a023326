"""Flags of a compilation are read off at once, not each by a call of its own.

numba compares them at every call that it types and after every pass: twenty-two flags, each a property with a default
that is a property too.
"""

from __future__ import annotations

from typing import Any

from numba.core.targetconfig import TargetConfig

__all__ = ["read_flags_at_once"]


def read_flags_at_once() -> None:
    """Let numba read the flags of compilations at once, from now on, in this process."""
    if getattr(TargetConfig.values, "at_once", False):
        return
    defaults: dict[type, dict[str, Any]] = {}

    def values(self: Any) -> dict[str, Any]:
        kind = type(self)
        if kind not in defaults:
            defaults[kind] = {name: option.default for name, option in kind.options.items()}
        return {**defaults[kind], **self._values}

    values.at_once = True  # pyright: ignore[reportFunctionMemberAccess]
    TargetConfig.values = values
