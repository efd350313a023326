"""Values as JSON knows them. Every room may import this module; it imports nothing but the standard library."""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import Decimal
from typing import Any

__all__ = ["plain"]


def plain(value: Any) -> Any:
    """Return a value as JSON knows it: what is not finite is null, SQL's decimals are numbers, the unknown is text.

    Examples
    --------
    >>> plain({"a": (1, float("nan")), "b": Decimal("0.5"), "c": None})
    {'a': [1, None], 'b': 0.5, 'c': None}
    """
    if isinstance(value, Decimal | float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    return value if value is None or isinstance(value, bool | int | str) else str(value)
