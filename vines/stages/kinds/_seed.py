"""Seeds of draws."""

from __future__ import annotations

from typing import Any

from vines.errors import ParameterError

__all__ = ["check_seed"]


def check_seed(options: Any) -> None:
    """Refuse a seed below zero."""
    if options.seed < 0:
        raise ParameterError(f"seed is {options.seed}, allowed is seed >= 0")
