"""In which sense the ball slides during each flight, and what its friction does to the ball and to the oscillator.

Friction opposes v2 - v1. A ball that crosses the cavity fast slides one way all the time; one that a soft impact left
slow is overtaken by the oscillator, which swings to and fro under it, and its friction turns with each swing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.fit._motion import Motion

__all__ = ["Push", "Slide", "push", "slide"]

Floats = npt.NDArray[np.float64]

_CELLS = 48
"""Parts of a flight; where the sense turns, a part counts by the share that the linear interpolation gives."""


@dataclass(frozen=True, slots=True, eq=False)
class Slide:
    """Sense of sliding in the K - 1 flights between impacts.

    Attributes
    ----------
    sense : ndarray, shape (K - 1, cells)
        Mean of sign(v2 - v1) over each of the equal parts of a flight.
    after, before : ndarray, shape (K - 1,)
        Friction of 1 m/s^2 adds `after` to the ball's velocity at the start of the flight and takes `before` off that
        at its end, relative to the mean velocity of the flight [s].
    """

    sense: Floats
    after: Floats
    before: Floats


def slide(motion: Motion, x2: Floats) -> Slide:
    """Return how the ball slides.

    Parameters
    ----------
    motion : Motion
        Of the oscillator, K impacts.
    x2 : ndarray, shape (K,)
        Position of the ball at the impacts [m].

    Notes
    -----
    With the acceleration -f s(t) the velocities at the ends of a flight of length T are the mean velocity plus
    f int (T - t) s dt / T and less f int t s dt / T. The sense is that of the mean velocity of the flight beside v1:
    what friction itself changes of v2 is small beside v1.

    Examples
    --------
    A ball that flies through a cavity at rest slides one way:

    >>> still = Motion(-0.3 + 55j, 55.0, np.zeros(1, complex), np.array([0.0, 0.1, 0.2]), np.zeros(3, complex), 1.0)
    >>> found = slide(still, np.array([-0.01, 0.01]))
    >>> found.sense.min().item(), round(found.after[0].item(), 9), round(found.before[0].item(), 9)
    (1.0, 0.05, 0.05)
    """
    t = motion.starts[1:]
    time = np.diff(t)
    nodes = t[:-1, None] + time[:, None] * np.linspace(0.0, 1.0, _CELLS + 1)
    # The nodes at the ends belong to this flight, not to the next one.
    flight = np.repeat(np.arange(1, len(t)), _CELLS + 1)
    apart = (np.diff(x2) / time)[:, None] - motion.on(flight, nodes.ravel(), 1).reshape(nodes.shape)
    size = np.abs(apart[:, :-1]) + np.abs(apart[:, 1:])
    sense = (apart[:, :-1] + apart[:, 1:]) / np.where(size > 0, size, 1.0)
    share = (np.arange(_CELLS) + 0.5) / _CELLS
    return Slide(sense, time * np.mean(sense * (1 - share), axis=1), time * np.mean(sense * share, axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class Push:
    """Known part of x1 on each flight, beside the forced response and the free oscillation.

    Attributes
    ----------
    signal : ndarray, shape (n,)
        At the times of the samples [m], or its second derivative.
    start, end, speed : ndarray, shape (K + 1,)
        Position at the start, position and velocity at the end of each flight [m, m/s]; it starts without velocity.
        Before the first impact and after the last one it is taken to slide the other way than on the flight beside.
    """

    signal: Floats
    start: Floats
    end: Floats
    speed: Floats


def push(found: Slide, t: Floats, samples: Floats, s: complex, size: float, order: int = 0) -> Push:
    """Return what the friction of the ball, a known force on the oscillator, adds to x1.

    Parameters
    ----------
    found : Slide
    t : ndarray, shape (K,)
        Times of the impacts [s].
    samples : ndarray, shape (n,)
        Times at which it is wanted [s].
    s : complex
        Of the free oscillation [1/s].
    size : float
        Static displacement by the force [m].
    order : {0, 2}
        Derivative of x1 that is wanted.

    Notes
    -----
    On a part of constant force x1 is d + Re q exp(s (t - tau)), with d the static displacement; q follows from position
    and velocity going on. In the first part it is d at rest.
    """
    count, cells = found.sense.shape
    still = size * found.sense
    q = np.zeros((count, cells), complex)
    step = np.exp(s * np.diff(t) / cells)
    for i in range(1, cells):
        q[:, i] = q[:, i - 1] * step + (still[:, i - 1] - still[:, i]) * complex(1.0, s.real / s.imag)
    last = q[:, -1] * step
    first, final = -still[0, 0], -still[-1, -1]
    start = np.concatenate([[first], still[:, 0], [final]])
    end = np.concatenate([[first], still[:, -1] + last.real, [final]])
    speed = np.concatenate([[0.0], (s * last).real, [0.0]])
    flight = np.searchsorted(t, samples, side="right") - 1
    signal = np.where(flight < 0, first, final) if order == 0 else np.zeros(len(samples))
    inside = (flight >= 0) & (flight < count)
    own, when = flight[inside], samples[inside] - t[flight[inside]]
    width = np.diff(t)[own] / cells
    cell = np.minimum((when / width).astype(np.intp), cells - 1)
    signal[inside] = (s**order * q[own, cell] * np.exp(s * (when - cell * width))).real
    if order == 0:
        signal[inside] += still[own, cell]
    return Push(signal, start, end, speed)
