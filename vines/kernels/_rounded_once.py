"""A product with a sum that is rounded once by order, not as the compiler chooses."""

from __future__ import annotations

from typing import Any

from numba import types  # pyright: ignore[reportPrivateImportUsage]
from numba.extending import intrinsic

from vines.kernels._decorators import fused_njit

__all__ = ["rounded_once"]


@intrinsic
def _multiply_add(context: Any, a: Any, b: Any, c: Any) -> Any:
    del context, a, b, c

    def generate(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        del context, sig
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


@fused_njit
def rounded_once(a, b, c):
    """Return a b + c, rounded once.

    Examples
    --------
    >>> rounded_once(1.0 + 2.0**-30, 1.0 - 2.0**-30, -1.0) == -(2.0**-60)
    True
    """
    return _multiply_add(a, b, c)  # pyright: ignore[reportCallIssue]
