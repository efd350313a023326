"""Values in messages, as TOML writes them."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal

__all__ = ["written"]


def written(value: object) -> str:
    """Return a value as a declaration has it, not as Python shows what it was read into.

    Examples
    --------
    >>> written({"from": Decimal("0.010"), "log": True})
    '{ from = 0.010, log = true }'
    >>> written([1, "a"]), written({}), written(Decimal("NaN"))
    ("[1, 'a']", '{}', 'nan')
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Decimal):
        return str(value) if value.is_finite() else repr(float(value))
    if isinstance(value, Mapping):
        inner = ", ".join(f"{key} = {written(each)}" for key, each in value.items())
        return f"{{ {inner} }}" if inner else "{}"
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    return repr(value)
