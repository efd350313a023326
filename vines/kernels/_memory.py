"""Arrays by their address: numbers that travel with a run's constants cost nothing, counted references do."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import carray, types  # pyright: ignore[reportPrivateImportUsage]
from numba.extending import intrinsic

from vines.kernels._decorators import fused_njit

__all__ = ["constant_at", "doubles_at"]


@intrinsic
def _pointer(context: Any, address: Any) -> Any:
    del context, address

    def generate(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(sig.return_type))

    return types.CPointer(types.float64)(types.intp), generate


@fused_njit
def doubles_at(address, n):
    """Return the n doubles at an address, ``array.ctypes.data`` of an array that whoever calls keeps alive."""
    return carray(_pointer(address), n)  # pyright: ignore[reportCallIssue]


@intrinsic
def constant_at(context: Any, address: Any, k: Any) -> Any:
    """Return double k at an address, where nothing is written as long as a kernel runs."""
    del context, address, k

    def generate(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        del context, sig
        first = builder.inttoptr(arguments[0], ir.DoubleType().as_pointer())
        found = builder.load(builder.gep(first, [arguments[1]]))
        # So that it need not be loaded again after something else was written.
        found.set_metadata("invariant.load", builder.module.add_metadata([]))
        return found

    return types.float64(types.intp, types.intp), generate
