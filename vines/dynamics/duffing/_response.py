"""How the frame answers without a ball: its periodic responses by Newton's method on half a period, and the largest."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from vines.dynamics._flight import advance_phase
from vines.dynamics.duffing._constants import duffing_constants
from vines.dynamics.taylor.kernels import X, at, coefficients, expand, expand_disturbances, peak
from vines.kernels import entry_njit

__all__ = ["harmonic_amplitudes", "largest_response"]

_TURNS = 40
_TRANSIENT, _WATCHED = 256, 64
_NEUTRAL = 1e-9


@entry_njit
def half_period(f, x, v, phase, Y):
    """Fly the frame over half a forcing period; Y, the columns of which are disturbances, is carried along.

    Returns
    -------
    (x1, x1', largest |x1|)
    """
    a = coefficients(f)
    tau = math.pi / f.Omega
    done, largest = 0.0, abs(x)
    while done < tau:
        h = min(expand(f, x, v, 0.0, 0.0, advance_phase(phase, f.Omega * done)), tau - done)
        expand_disturbances(f, h, Y)
        largest, _ = peak(a, f.order, h, largest)
        x, v = at(a, X, f.order, h)
        done += h
    return x, v, largest


def harmonic_amplitudes(A: float, Omega: float, lam: float, alpha: float, mass: float) -> list[float]:
    """Return the amplitudes, ascending, that one harmonic gives the frame of a mass without a ball.

    They solve ``((1 - mass Omega² + 3 alpha a²/4)² + (lam Omega)²) a² = A² (1 + (lam Omega)²)``: one or three.
    """
    stiff, damping, cube = 1.0 - mass * Omega**2, (lam * Omega) ** 2, 0.75 * alpha
    drive = A * A * (1.0 + damping)

    def excess(square: float) -> float:
        return ((stiff + cube * square) ** 2 + damping) * square - drive

    turns = [0.0]
    inner = stiff * stiff - 3.0 * damping
    if stiff < 0.0 and inner > 0.0:
        turns += [(-2.0 * stiff + sign * math.sqrt(inner)) / (3.0 * cube) for sign in (-1.0, 1.0)]
    end = max(turns[-1], drive / (stiff * stiff + damping) if stiff * stiff + damping > 0.0 else 0.0, 1e-300)
    while not excess(end) >= 0.0:
        end *= 2.0
    found = []
    for low, high in pairwise([*turns, end]):
        if excess(low) * excess(high) <= 0.0:
            found.append(math.sqrt(_root(excess, low, high)))
    return found


def _root(of: Callable[[float], float], low: float, high: float) -> float:
    """Return a root between two places where a function has different signs, by bisection to a part in 10^12."""
    rises = of(low) < of(high)
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        if (of(middle) < 0.0) == rises:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@functools.lru_cache(maxsize=4096)
def largest_response(
    A: float, Omega: float, lam: float, alpha: float, mass: float, order: int
) -> tuple[float, float, float]:
    """Return max|x1| of the largest stable response, of the forcing's period and symmetric, and x1, x1' at phase 0.

    Responses are those that Newton's method finds from the amplitudes of `harmonic_amplitudes`. Where none of these is
    stable it is the largest |x1| in 64 periods of what a run from the largest amplitude has come to after 256.
    """
    if A == 0.0:
        return 0.0, 0.0, 0.0
    c = duffing_constants(mass - 1.0, A, Omega, 0.0, lam, alpha, order)
    frame = c.stuck
    stable: list[tuple[float, float, float]] = []
    begin = 0.0, 0.0
    for amplitude in harmonic_amplitudes(A, Omega, lam, alpha, mass):
        begin = _started(A, Omega, lam, alpha, mass, amplitude)
        found = _response(frame, *begin)
        if found is not None and found[3] <= 1.0 + _NEUTRAL:
            stable.append(found[:3])
    return max(stable) if stable else _run(frame, *begin)


def _started(A: float, Omega: float, lam: float, alpha: float, mass: float, amplitude: float) -> tuple[float, float]:
    """Return x1 and x1' at phase 0 of one harmonic of an amplitude."""
    answer = A * complex(1.0, lam * Omega) / complex(1.0 - mass * Omega**2 + 0.75 * alpha * amplitude**2, lam * Omega)
    # The forcing is Im A (1 + i lam Omega) exp(i phase).
    return answer.imag, Omega * answer.real


def _response(frame: Any, x: float, v: float) -> tuple[float, float, float, float] | None:
    """Return max|x1|, x1, x1' and the largest modulus of the multipliers of the symmetric response near a state."""
    for _ in range(_TURNS):
        Y = np.eye(4)
        x_end, v_end, largest = half_period(frame, x, v, 0.0, Y)
        M = Y[:2, :2]
        # After half a period it is its own mirror image.
        try:
            step = np.linalg.solve(M + np.eye(2), [x + x_end, v + v_end])
        except np.linalg.LinAlgError:
            return None
        size = float(np.abs(step).max())
        if not math.isfinite(size):
            return None
        if size <= 1e-13 * (1.0 + largest):
            return largest, float(x), float(v), float(np.abs(np.linalg.eigvals(M)).max()) ** 2
        x, v = x - step[0], v - step[1]
    return None


def _run(frame: Any, x: float, v: float) -> tuple[float, float, float]:
    best = 0.0
    for half in range(2 * (_TRANSIENT + _WATCHED)):
        x, v, largest = half_period(frame, x, v, 0.0 if half % 2 == 0 else math.pi, np.eye(4))
        if half >= 2 * _TRANSIENT:
            best = max(best, largest)
    return best, x, v
