"""Which variables a statement of numba's has: asked for some ten times of each, and found without a call for each part.

numba asks of every part of a statement, its place in the file and the names of functions too, whether it is a variable
or holds any, by a call that goes through five classes.
"""

from __future__ import annotations

from typing import Any

from numba.core import ir

__all__ = ["find_variables_quickly"]

_HOLDS_NONE = frozenset((ir.Loc, str, int, float, bool, type(None), type(len)))


def find_variables_quickly() -> None:
    """Let numba look into the parts of statements by their class, from now on, in this process."""
    if getattr(ir.Inst._rec_list_vars, "by_class", False):
        return
    look = ir.Inst._rec_list_vars

    def rec_list_vars(self: Any, val: Any) -> list[Any]:
        kind = type(val)
        if kind is dict:
            val = val.values()
        elif kind is not list and kind is not tuple:
            return look(self, val)
        found = []
        for each in val:
            kind = type(each)
            if kind is ir.Var:
                found.append(each)
            elif kind is ir.Expr:
                found += rec_list_vars(each, each._kws)
            elif kind not in _HOLDS_NONE:
                found += rec_list_vars(self, each)
        return found

    rec_list_vars.by_class = True  # pyright: ignore[reportFunctionMemberAccess]
    ir.Inst._rec_list_vars = rec_list_vars
