"""A loop over a range whose step is one counts its rounds by a difference.

numba divides by the step, asks for its sign and writes the message for a step of zero, and leaves it to LLVM to find
out that the step is one: sixty instructions a loop.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from llvmlite.ir.instructions import InsertValue
from numba import types
from numba.core import cgutils
from numba.core.imputils import builtin_registry, lower_builtin
from numba.cpython import rangeobj

__all__ = ["count_rounds_at_once"]

_STEP = 2
"""The place of the step in numba's description of a range."""

_DONE: list[bool] = []


def count_rounds_at_once() -> None:
    """Let numba count the rounds of loops with the step one at once, from now on, in this process."""
    if not _DONE:
        _DONE.append(True)
        kind = types.int64
        state, _ = rangeobj.range_impl_map[kind]
        [rounds] = [each for each, name, of in builtin_registry.functions if name == "getiter" and of == (state,)]
        lower_builtin(range, kind)(_upwards)
        lower_builtin(range, kind, kind)(_upwards)
        lower_builtin("getiter", state)(_rounds(rounds))


def _upwards(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    numbers = (context.get_constant(types.int64, 0), *args)[-2:]
    value = ir.Constant(context.get_value_type(sig.return_type), ir.Undefined)
    for place, number in enumerate((*numbers, context.get_constant(types.int64, 1))):
        value = builder.insert_value(value, number, place)
    return value


def _rounds(any_step: Any) -> Any:
    def rounds(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        value = args[0]
        # As `_upwards` leaves it, in the block of the loop.
        step = value.operands[1] if isinstance(value, InsertValue) and list(value.indices) == [_STEP] else None
        if not isinstance(step, ir.Constant) or step.constant != 1:
            return any_step(context, builder, sig, args)
        start, stop = (builder.extract_value(value, place) for place in (0, 1))
        difference = builder.sub(stop, start)
        zero = difference.type(0)
        found = cgutils.create_struct_proxy(sig.return_type)(context, builder)
        found.iter, found.count = (cgutils.alloca_once(builder, start.type) for _ in range(2))
        found.stop, found.step = stop, step
        builder.store(start, found.iter)
        builder.store(builder.select(builder.icmp_signed(">", difference, zero), difference, zero), found.count)
        return found._getvalue()

    return rounds
