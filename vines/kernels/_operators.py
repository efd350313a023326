"""What an operator does to plain numbers and arrays is worked out once a process, not at each place where it stands.

For each ``a + b`` numba tries some eight templates in turn, most of which fail with an error that nobody reads: lists,
strings, dates, arrays come before the sum of two floats. The answer depends on the types, on the function and on the
flags of the compilation alone, so it is remembered for those; a tenth of the time of compiling goes away.
"""

from __future__ import annotations

from types import BuiltinFunctionType
from typing import Any

import numpy as np
from numba.core import targetconfig, types
from numba.core.types.functions import BaseFunction

__all__ = ["remember_operators"]

_PLAIN = (types.Number, types.Boolean, types.Array, types.SliceType, types.NoneType)

_Key = tuple[BaseFunction, Any, tuple[types.Type, ...], str]


def _is_plain(of: Any) -> bool:
    return all(map(_is_plain, of)) if isinstance(of, types.BaseTuple) else isinstance(of, _PLAIN)  # pyright: ignore[reportArgumentType]


def _flags() -> str:
    """Return the flags of the compilation under way as text, because some of them cannot be hashed."""
    top: Any = targetconfig.ConfigStack.top_or_none()
    if top is None:
        return ""
    if _LAST[0] is not top or _LAST[1] != top._values:
        _LAST[:] = top, dict(top._values), str(top._values)
    return _LAST[2]


_LAST: list[Any] = [None, {}, ""]
"""The flags that were asked for last, their values then, and these as text."""


def remember_operators() -> None:
    """Let numba remember the signatures of operators and functions of C, from now on, in this process."""
    if getattr(BaseFunction.get_call_type, "remembers", False):
        return
    work_out = BaseFunction.get_call_type
    known: dict[_Key, tuple[Any, Any]] = {}

    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        of = getattr(self, "typing_key", None)
        if kws or not isinstance(of, BuiltinFunctionType | np.ufunc) or not all(map(_is_plain, args)):
            return work_out(self, context, args, kws)
        key = (self, context, tuple(args), _flags())
        if key not in known:
            found = work_out(self, context, args, kws)
            known[key] = found, self.get_impl_key(found)
        signature, implementation = known[key]
        # where numba looks up what to call for the signature, at each place where it stands
        self._impl_keys[signature.args] = implementation
        return signature

    get_call_type.remembers = True  # pyright: ignore[reportFunctionMemberAccess]
    BaseFunction.get_call_type = get_call_type
