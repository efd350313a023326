"""An element of an array is read and written with the few instructions that it takes.

numba writes the whole description of an array to the stack at each access, reads all of its shape and strides back, and
leaves it to LLVM to find out that one address was meant: thirty instructions, the greatest part of what LLVM is given
to read. Here arrays without gaps whose indices are all integers are addressed at once; the rest goes numba's way.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.np import arrayobj
from numba.np.arrayobj import load_item, store_item

__all__ = ["address_elements_at_once"]

_READ = {types.Integer: arrayobj.getitem_arraynd_intp, types.BaseTuple: arrayobj.getitem_array_tuple}
"""What numba does for an index of a class."""

_DONE: list[bool] = []


def address_elements_at_once() -> None:
    """Let numba address elements of arrays at once, from now on, in this process."""
    if not _DONE:
        _DONE.append(True)
        for kind, read in _READ.items():
            lower_builtin(operator.getitem, types.Array, kind)(_reader(read))
            lower_builtin(operator.setitem, types.Array, kind, types.Any)(_write)


def _reader(read: Any) -> Any:
    def element(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = _place(context, builder, sig.args, args)
        return read(context, builder, sig, args) if place is None else load_item(context, builder, sig.args[0], place)

    return element


def _write(context: Any, builder: Any, sig: Any, args: Any) -> None:
    place = _place(context, builder, sig.args, args)
    if place is None:
        arrayobj.setitem_array(context, builder, sig, args)
    else:
        array, _, kind = sig.args
        store_item(context, builder, array, context.cast(builder, args[2], kind, array.dtype), place)


def _place(context: Any, builder: Any, kinds: Sequence[Any], args: Sequence[Any]) -> Any:
    """Return a pointer to an element; None where more than an element may be meant."""
    array, index = kinds[:2]
    value, indices = args[:2]
    several = getattr(index, "types", None)
    of = (index,) if several is None else several
    plain = type(array) is types.Array and array.layout == "C" and isinstance(array.dtype, types.Number)
    if not plain or context.enable_boundscheck:
        return None
    if len(of) != array.ndim or not all(isinstance(each, types.Integer) for each in of):
        return None
    indices = (indices,) if several is None else cgutils.unpack_tuple(builder, indices, count=len(of))
    model = context.data_model_manager[array]
    shape = model.get_field_position("shape")
    place = None
    for axis, (kind, each) in enumerate(zip(of, indices, strict=True)):
        size = builder.extract_value(value, [shape, axis])
        found = arrayobj.fix_integer_index(context, builder, kind, each, size)
        place = found if place is None else builder.add(builder.mul(place, size), found)
    return builder.gep(builder.extract_value(value, model.get_field_position("data")), [place])
