"""Kernels with several bodies: the type of the first argument picks one, in kernels as in Python."""

from __future__ import annotations

from typing import NamedTuple

import pytest
from numba.core.errors import TypingError

from vines.kernels import by_type, entry_njit, fused_njit, linked_njit


class Square(NamedTuple):
    side: float


class Box(NamedTuple):
    base: Square
    height: float


class Unknown(NamedTuple):
    side: float


@by_type(Square)
@fused_njit
def size(of, scale):
    """Return how much room there is."""
    return scale * of.side**2


@size.register(Box)
@linked_njit
def _volume(of, scale, more):
    # Another number of arguments, and a call of the other body: what is passed on is a tuple that bodies take apart.
    return size(of.base, scale) * of.height + more


@linked_njit
def _twice(of, rest):
    return 2.0 * size(of, *rest)


@entry_njit
def _both(side):
    return _twice(Square(side), (3.0,)), _twice(Box(Square(side), 2.0), (3.0, 0.5))


def test_a_caller_is_written_once_and_takes_the_body_of_its_type() -> None:
    assert _both(2.0) == (24.0, 49.0)
    assert _twice(Square(2.0), (3.0,)) == 24.0


def test_python_takes_the_same_body() -> None:
    assert size(Square(2.0), 3.0) == 12.0
    assert size(Box(Square(2.0), 2.0), 3.0, 0.5) == 24.5
    assert size.__name__ == "size"


def test_a_type_without_a_body_is_refused() -> None:
    with pytest.raises(TypingError):
        _twice(Unknown(2.0), (3.0,))
    with pytest.raises(KeyError):
        size(Unknown(2.0), 3.0)
