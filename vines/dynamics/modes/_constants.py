"""The numbers that the kernels need for a structure of several modes; one kernel serves any number of them.

Those of the structure with the ball riding on it follow from an eigenvalue problem (docs/dynamics.md, "Several modes").
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.dynamics._constants import constants_at, oscillator
from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.dynamics.modes._structure import Structure, driven, structure
from vines.errors import ParameterError
from vines.kernels import constant_at, fused_njit, njit

__all__ = [
    "GAMMA",
    "LAM",
    "PHI",
    "RATE",
    "STIFFNESS",
    "ModesConstants",
    "ModesTable",
    "modes_constants",
    "of_mode",
]

PHI, GAMMA, STIFFNESS, LAM, RATE = range(5)
"""What stands of each mode: shape and participation, squared frequency and damping, and the k-th largest of the
exponents of the structure alone."""

NUMBERS = 5

DEFECTIVE = 1e6
"""Condition of the modes of the loaded structure above which they are too nearly parallel to be told apart."""


class _Fields(NamedTuple):
    mu: float
    A: float
    Omega: float
    r: float
    mobility: float
    direct: float
    Omega4: float
    Omega5: float
    period: float
    window: float
    near: float
    correction: float
    law: ImpactLaw
    free: Structure
    stuck: Structure
    modes: int
    each: int
    noted: int


class ModesConstants(_Fields):
    """As `Constants`; what there is once a mode stands in a table of `modes` rows, and `each` is its address.

    So a kernel is compiled once for all numbers of modes. The doubles live as long as the constants do: they are an
    attribute of them, no field. At `noted` stand the modes of a motion that kernels begin by x1 and v1 alone.
    """

    space: list[npt.NDArray[np.float64]]


class ModesTable(NamedTuple):
    """The constants of one run, where kernels for many runs take a table."""

    constants: ModesConstants


def _loaded(
    space: list[npt.NDArray[np.float64]], mu: float, A: float, Omega: float, direct: float,
    omega: npt.NDArray[np.float64], lam: npt.NDArray[np.float64], phi: npt.NDArray[np.float64],
    gamma: npt.NDArray[np.float64],
) -> Structure:  # fmt: skip
    """Return the structure with the ball riding on it.

    The ball presses with ``-mu x1''``: ``(1 + mu phi phi^T) z'' + lam z' + omega² z = gamma (omega² e + lam e')
    - mu direct e'' phi``, whose 2n exponents are n pairs as long as each mode is underdamped.
    """
    n = len(omega)
    square = omega * omega
    inverse = np.eye(n) - mu / (1.0 + mu * phi @ phi) * np.outer(phi, phi)
    # Amplitudes times frequencies beside velocities, so that all entries are of one size.
    state = np.zeros((2 * n, 2 * n))
    state[:n, n:] = np.diag(omega)
    state[n:, :n] = -inverse * omega
    state[n:, n:] = -inverse * lam
    rates, right = (np.asarray(each, dtype=np.complex128) for each in np.linalg.eig(state))
    try:
        left = np.linalg.inv(right)
    except np.linalg.LinAlgError:
        left = np.full_like(right, np.inf)
    if not np.linalg.norm(right) * np.linalg.norm(left) < DEFECTIVE:
        raise ParameterError(
            f"mu is {mu:g}: with the ball riding on it two modes of the structure coincide; change mu or a lam a little"
        )
    kept = np.argsort(rates.imag)[n:]
    rates, right, left = rates[kept], right[:, kept], left[kept]
    force = A * (gamma * (-1j * square + lam * Omega) - 1j * mu * direct * Omega**2 * phi)
    push = np.concatenate([np.zeros(n), inverse @ force])
    other = left @ push.conj() / (-1j * Omega - rates)
    turning = (right @ other).conj()
    # From z and z' to exponentials and back, mode by mode.
    to = np.empty((n, 2 * n + 1), dtype=complex)
    to[:, 0:-1:2], to[:, 1:-1:2], to[:, -1] = 2.0 * left[:, :n] * omega, 2.0 * left[:, n:], -other
    back = np.empty((2 * n, n + 1), dtype=complex)
    back[0::2, :-1], back[1::2, :-1] = right[:n] / omega[:, None], right[n:]
    back[0::2, -1], back[1::2, -1] = turning[:n] / omega, turning[n:]
    weights = phi @ back[0::2, :-1]
    h = complex(phi @ back[0::2, -1]) - 1j * direct * A
    away, home = np.ascontiguousarray(to).view(np.float64), np.ascontiguousarray(back).view(np.float64)
    space += [away, home]
    each = [driven(complex(rate), complex(g), Omega) for rate, g in zip(rates, left @ push, strict=True)]
    return structure(space, each, weights, h, 1.0, away.ctypes.data, home.ctypes.data)


def modes_constants(mu: float, A: float, Omega: float, r: float, *modes: float) -> ModesConstants:
    """Return the `ModesConstants` at bare parameter values; `modes` is all omega, lam, phi and gamma.

    Raises
    ------
    ParameterError
        If two modes of the structure with the ball riding on it coincide.
    """
    omega, lam, phi, gamma = np.reshape(np.array(modes, dtype=np.float64), (4, -1))
    n = len(omega)
    mobility, direct = float(phi @ phi), 1.0 - float(phi @ gamma)
    space: list[npt.NDArray[np.float64]] = []
    square = omega * omega
    alone = [
        oscillator(1.0 / k, g * A, Omega, damped / k) for k, damped, g in zip(square, lam, gamma, strict=True)
    ]  # fmt: skip
    free = structure(space, alone, phi.astype(complex), -1j * direct * A)
    stuck = _loaded(space, mu, A, Omega, direct, omega, lam, phi, gamma)
    each, noted = np.column_stack([phi, gamma, square, lam, np.sort(-0.5 * lam)[::-1]]), np.zeros(2 * n)
    space += [each, noted]
    fastest = max(1.0, Omega, float(omega.max()))
    cube, pull = 1.0 - r**3, mu * mobility
    found = ModesConstants(
        mu, A, Omega, r, mobility, direct, Omega**4, Omega**5, 2.0 * math.pi / Omega, 2.0 / fastest,
        4e-3 / fastest**1.25, 2.0 / 3.0 * pull / (1.0 + pull) ** 2 / cube if cube > 0.0 else math.inf,
        impact_law(pull, r), free, stuck, n, each.ctypes.data, noted.ctypes.data,
    )  # fmt: skip
    found.space = space
    return found


@constants_at.register(ModesTable)
@njit
def _constants_at(table, k):
    return table.constants


@fused_njit
def of_mode(each, k, what):
    """Return a number of mode k, from 0 on, in the table of modes at an address."""
    return constant_at(each, NUMBERS * k + what)  # pyright: ignore[reportCallIssue]
