"""A named tuple of vines goes from kernel to kernel as one argument.

numba takes a tuple apart at each call and puts it together again on the other side: constants of fifty numbers, a
hundred instructions. What the processor does is the same, for LLVM takes it apart.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core.datamodel.models import TupleModel, UniTupleModel
from numba.core.datamodel.registry import default_manager

__all__ = ["pass_tuples_whole"]


class _OneArgument:
    """How a value is passed; numba's interface."""

    get_value_type: Any

    def get_argument_type(self) -> Any:
        """Return the type of the argument."""
        return self.get_value_type()

    def as_argument(self, builder: Any, value: Any) -> Any:
        """Return the argument for a value."""
        return value

    def from_argument(self, builder: Any, value: Any) -> Any:
        """Return the value of an argument."""
        return value


class _Whole(_OneArgument, TupleModel):
    """A named tuple as one argument."""


class _WholeUniform(_OneArgument, UniTupleModel):
    """A named tuple of numbers of one kind as one argument."""


def pass_tuples_whole() -> None:
    """Let numba pass tuples of plain numbers whose class is of vines as they are, from now on, in this process."""
    default_manager.register(types.NamedTuple, _either(TupleModel, _Whole))
    default_manager.register(types.NamedUniTuple, _either(UniTupleModel, _WholeUniform))


def _either(theirs: Any, ours: Any) -> Any:
    def model(manager: Any, kind: Any) -> Any:
        home = kind.instance_class.__module__.partition(".")[0]
        return (ours if home == "vines" and _is_plain(kind) else theirs)(manager, kind)

    return model


def _is_plain(kind: Any) -> bool:
    inner = getattr(kind, "types", None)
    return isinstance(kind, types.Number) if inner is None else all(map(_is_plain, inner))
