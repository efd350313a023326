"""How kernels are compiled, kept and joined: decorators, digests, the cache on disk. It knows no physics."""

# Before anything that imports numba, which reads its settings then.
from vines.kernels._settings import WIDE

# isort: split
from vines.kernels._announcement import expected
from vines.kernels._arrays import (
    byte_vector,
    complex_matrix,
    complex_vector,
    copy_values,
    identity,
    integer_vector,
    max_abs,
    new_cube,
    new_matrix,
    new_vector,
    zero_cube,
    zero_integers,
    zero_matrix,
    zero_vector,
)
from vines.kernels._by_type import by_type
from vines.kernels._cache import CACHE
from vines.kernels._decorators import cold_njit, entry_njit, fused_njit, linked_njit, loop_njit, njit
from vines.kernels._memory import constant_at, doubles_at
from vines.kernels._rounded_once import rounded_once
from vines.kernels._tasks import Task, compile_here, compile_tasks, is_warm

__all__ = [
    "CACHE",
    "WIDE",
    "Task",
    "by_type",
    "byte_vector",
    "cold_njit",
    "compile_here",
    "compile_tasks",
    "complex_matrix",
    "complex_vector",
    "constant_at",
    "copy_values",
    "doubles_at",
    "entry_njit",
    "expected",
    "fused_njit",
    "identity",
    "integer_vector",
    "is_warm",
    "linked_njit",
    "loop_njit",
    "max_abs",
    "new_cube",
    "new_matrix",
    "new_vector",
    "njit",
    "rounded_once",
    "zero_cube",
    "zero_integers",
    "zero_matrix",
    "zero_vector",
]
