"""The structure alone, or with the ball riding on it, as a sum of complex exponentials that the kernels read.

Both are of one form, u_j' = s_j u_j + G_j, of which x1 and the modes are linear combinations beside a motion that turns
with the forcing (docs/dynamics.md, "Several modes").
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import LARGE, NARROW, Oscillator, oscillator
from vines.kernels import constant_at, fused_njit

__all__ = ["Structure", "driven", "oscillator_at", "structure", "weight_at"]

FIELDS = len(Oscillator._fields)
WIDTH = FIELDS + 2
"""Doubles of one exponential in a table: its `Oscillator`, and the complex weight with which x1 has it."""


class Structure(NamedTuple):
    """The structure alone, or with the ball riding on it.

    ``x1 = Re sum a_j u_j + Re h E`` over n exponentials, E = exp(i (Omega t + phi)). In the room at an address stand E
    and all u at the start of the present motion.

    Attributes
    ----------
    n : int
    loaded : float
        1 with the ball riding on it.
    table, room : int
        Addresses.
    hr, hi : float
        h.
    forced : float
        Sum of |a_j G_j|.
    to, back : int
        Addresses of what makes exponentials of the modes and back, with the ball riding on it; else 0.
    """

    n: int
    loaded: float
    table: int
    room: int
    hr: float
    hi: float
    forced: float
    to: int
    back: int


def driven(rate: complex, force: complex, Omega: float) -> Oscillator:
    """Return the `Oscillator` of u' = rate u + force E."""
    size = rate.real * rate.real + rate.imag * rate.imag
    pair = oscillator(1.0 / size, 0.0, Omega, -2.0 * rate.real / size)
    detuning = complex(pair.dr, pair.di)
    away = abs(detuning)
    q = force / detuning if away > 0.0 else complex(math.inf, math.inf)
    reach = 0.0
    if away < NARROW or abs(q) > LARGE:
        reach = 1.0 / away if away > 0.0 else math.inf
    return pair._replace(gr=force.real, gi=force.imag, qr=q.real, qi=q.imag, reach=reach)


def structure(
    space: list[npt.NDArray[np.float64]], each: list[Oscillator], weights: Any, h: complex, loaded: float = 0.0,
    to: int = 0, back: int = 0,
) -> Structure:  # fmt: skip
    """Return a `Structure` of these exponentials; what it has the addresses of is added to `space`, to be kept."""
    n = len(each)
    table, room = np.empty((n, WIDTH)), np.zeros(2 + 2 * n)
    for row, own, a in zip(table, each, weights, strict=True):
        row[:FIELDS] = own
        row[FIELDS:] = a.real, a.imag
    space += [table, room]
    forced = sum(abs(a) * math.hypot(own.gr, own.gi) for own, a in zip(each, weights, strict=True))
    return Structure(n, loaded, table.ctypes.data, room.ctypes.data, h.real, h.imag, float(forced), to, back)


@fused_njit
def _number(table, k):
    return constant_at(table, k)  # pyright: ignore[reportCallIssue]


@fused_njit
def weight_at(table, j):
    """Return the weight of exponential j in x1, as two reals."""
    first = WIDTH * j + FIELDS
    return _number(table, first), _number(table, first + 1)


@fused_njit
def oscillator_at(table, j):
    """Return the `Oscillator` of exponential j."""
    at = WIDTH * j
    return Oscillator(
        _number(table, at), _number(table, at + 1), _number(table, at + 2), _number(table, at + 3),
        _number(table, at + 4), _number(table, at + 5), _number(table, at + 6), _number(table, at + 7),
        _number(table, at + 8), _number(table, at + 9), _number(table, at + 10), _number(table, at + 11),
        _number(table, at + 12), _number(table, at + 13), _number(table, at + 14), _number(table, at + 15),
        _number(table, at + 16), _number(table, at + 17), _number(table, at + 18), _number(table, at + 19),
        _number(table, at + 20), _number(table, at + 21), _number(table, at + 22), _number(table, at + 23),
        _number(table, at + 24), _number(table, at + 25), _number(table, at + 26), _number(table, at + 27),
        _number(table, at + 28), _number(table, at + 29), _number(table, at + 30), _number(table, at + 31),
        _number(table, at + 32), _number(table, at + 33),
    )  # fmt: skip
