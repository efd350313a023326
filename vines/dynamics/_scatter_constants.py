"""The numbers that the kernels need for a run with scatter: also a second harmonic, forces that change, and draws."""

from __future__ import annotations

import cmath
import math
from typing import NamedTuple

from vines.dynamics._constants import Oscillator, constants_kernel, oscillator
from vines.dynamics._integrals import base_per_force
from vines.kernels import doubles_at, linked_njit, njit

__all__ = [
    "AHEAD",
    "COLOURS",
    "COSINES",
    "DRAWS",
    "FIRST",
    "FORMS",
    "JUMPS",
    "NUMBERS",
    "PIECES",
    "ROOM",
    "SINES",
    "SQUARES",
    "SUMS",
    "TURNS",
    "Coloured",
    "Harmonic",
    "Piece",
    "ScatterConstants",
    "ScatterOscillator",
    "added",
    "scatter_constants",
]

AHEAD = 64
"""Held forces drawn at once, and turns of the phase."""

NUMBERS = 8
"""Numbers that say how a piece begins: u, G1, G2, the held force, and 0, with which they fill a vector."""

SQUARES = NUMBERS * NUMBERS
"""Products of two of them."""

FORMS = 4
"""Integrals of a whole piece that are quadratic forms in them: of x1^2, of v1^2, the work, the damper loss."""

# Places in a run's room: the number of a piece, and what the base has worked in jumps of its phase; held forces from
# that piece on, and by what the phase turns at their begin, with its cosine and sine; the coloured force at every
# second begin; the forms for flight and for sticking, sums of products.
FIRST, JUMPS, DRAWS = 0, 1, 8
TURNS = DRAWS + AHEAD
COSINES = TURNS + AHEAD
SINES = COSINES + AHEAD
COLOURS = SINES + AHEAD
PIECES = COLOURS + AHEAD
SUMS = PIECES + 2 * FORMS * SQUARES
ROOM = SUMS + SQUARES


class Harmonic(NamedTuple):
    """What `Oscillator` holds of a forcing, for another one: G = g exp(i Omega t) with its own frequency.

    ``gr + i gi`` is g where the phase of the first harmonic is 0; ``er + i ei`` is 1/(i Omega - s); ``c2r … c6i`` the
    sums in the derivatives of u; ``br + i bi`` gives the velocity of the base, Re[b G]. Where there is none
    forcing and ``reach`` are 0.
    """

    Omega: float
    gr: float
    gi: float
    dr: float
    di: float
    er: float
    ei: float
    reach: float
    c2r: float
    c2i: float
    c3r: float
    c3i: float
    c4r: float
    c4i: float
    c5r: float
    c5i: float
    c6r: float
    c6i: float
    br: float
    bi: float


class Piece(NamedTuple):
    """What a time does: the factors of u and of each G, and what each G adds to u."""

    ur: float
    ui: float
    f1r: float
    f1i: float
    b1r: float
    b1i: float
    f2r: float
    f2i: float
    b2r: float
    b2i: float


class ScatterOscillator(NamedTuple):
    """One oscillator under both harmonics and a held force: x = held + Re u, u' = s u + G1 + G2.

    ``piece`` is what a whole time between two draws does; over it x leaves the chord between its ends by no more than
    ``bend`` + ``sag`` |u|.
    """

    first: Oscillator
    second: Harmonic
    piece: Piece
    bend: float
    sag: float
    br: float
    bi: float


class Coloured(NamedTuple):
    """A coloured force: its standard deviation, the step in units of its memory, and its value at the begin, or nan.

    The others are those of `held_halves`.
    """

    size: float
    rate: float
    begun: float
    p11: float
    p12: float
    p21: float
    p22: float
    l11: float
    l21: float
    l22: float


class ScatterConstants(NamedTuple):
    """As `Constants`, and what is drawn.

    ``r`` is the restitution of a slow impact without its deviation; the held forces have the standard deviation
    ``noise``, one for each ``grid`` of time from ``origin`` on, where the phase turns by ``diffusion`` times a normal
    number; ``drawn`` says whether anything changes there. Draws are those of `stream` at the seed `key`.
    ``room`` is the address of `ROOM` doubles, for what is worked out on the way.
    """

    mu: float
    A: float
    Omega: float
    r: float
    lam: float
    Omega5: float
    period: float
    window: float
    near: float
    correction: float
    free: ScatterOscillator
    stuck: ScatterOscillator
    sigma_r: float
    r_speed: float
    noise: float
    diffusion: float
    colour: Coloured
    drawn: bool
    grid: float
    origin: float
    second: float
    second_phase: float
    key: int
    stream: int
    room: int


@njit
def _harmonic(o, A, Omega, lam, phase):
    """Return what another forcing of the oscillator is, at frequency Omega."""
    p = oscillator(1.0 / o.stiffness, A, Omega, lam)
    g = complex(p.gr, p.gi) * complex(math.cos(phase), math.sin(phase))
    b = base_per_force(p, Omega, lam)
    reach = p.reach if A > 0.0 else 0.0
    return Harmonic(
        Omega, g.real, g.imag, p.dr, p.di, p.er, p.ei, reach,
        p.c2r, p.c2i, p.c3r, p.c3i, p.c4r, p.c4i, p.c5r, p.c5i, p.c6r, p.c6i, b.real, b.imag,
    )  # fmt: skip


@linked_njit
def added(s, omega, length):
    """Return the integral of exp(s (length - t)) exp(i omega t) over a short time, also at resonance."""
    y = 0.5 * (complex(0.0, omega) - s) * length
    mean = cmath.exp(0.5 * (complex(0.0, omega) + s) * length)
    if abs(y) > 0.5:
        return mean * length * cmath.sinh(y) / y
    p = y * y
    return (
        mean
        * length
        * (
            1.0
            + p / 6.0 * (1.0 + p / 20.0 * (1.0 + p / 42.0 * (1.0 + p / 72.0 * (1.0 + p / 110.0 * (1.0 + p / 156.0)))))
        )
    )


@linked_njit
def _scattering(o, A, Omega, lam, phase, grid):
    second = _harmonic(o, A, 2.0 * Omega, lam, phase)
    s = complex(-o.half, o.gamma)
    u = cmath.exp(s * grid)
    f1, f2 = cmath.exp(complex(0.0, Omega * grid)), cmath.exp(complex(0.0, 2.0 * Omega * grid))
    b1, b2 = added(s, Omega, grid), added(s, 2.0 * Omega, grid)
    piece = Piece(u.real, u.imag, f1.real, f1.imag, b1.real, b1.imag, f2.real, f2.imag, b2.real, b2.imag)
    base = base_per_force(o, Omega, lam)
    # |u''| is |s|^2 |u| + |c G1| + |c G2| at most, and |u| grows by (|G1| + |G2|) grid at most.
    first, other = math.hypot(o.gr, o.gi), math.hypot(second.gr, second.gi)
    sag = 0.125 * grid * grid * o.stiffness
    bend = sag * grid * (first + other) + 0.125 * grid * grid * (
        math.hypot(o.c2r, o.c2i) * first + math.hypot(second.c2r, second.c2i) * other
    )
    return ScatterOscillator(o, second, piece, bend, sag, base.real, base.imag)


@linked_njit
def scatter_constants(parameters, numbers, stream, origin, address):
    """Return the `ScatterConstants` of a run.

    Parameters
    ----------
    parameters : ndarray, shape (5,)
        mu, A, Omega, r, lam.
    numbers : ndarray, shape (18,)
        A row of what `Scatter.numbers` gives.
    stream : int
        Number of the run.
    origin : float
        Time at which it begins.
    address : int
        Where there is room for `ROOM` doubles, kept by whoever calls as long as the constants are used.
    """
    room = doubles_at(address, ROOM)
    # Nothing drawn yet, nothing summed.
    room[FIRST] = math.inf
    room[JUMPS] = 0.0
    for k in range(SUMS, ROOM):
        room[k] = 0.0
    mu, A, Omega, r, lam = parameters[0], parameters[1], parameters[2], parameters[3], parameters[4]
    c = constants_kernel(mu, A, Omega, r, lam)
    grid = c.period / numbers[3]
    second = numbers[4] * A
    colour = Coloured(
        numbers[8] * A, numbers[9], numbers[10] * A,
        numbers[11], numbers[12], numbers[13], numbers[14], numbers[15], numbers[16], numbers[17],
    )  # fmt: skip
    fastest = max(1.0, 2.0 * Omega if second > 0.0 else Omega)
    return ScatterConstants(
        mu,
        A,
        Omega,
        r,
        lam,
        c.Omega5,
        c.period,
        2.0 / fastest,
        4e-3 / (fastest * math.sqrt(math.sqrt(fastest))),
        c.correction,
        _scattering(c.free, second, Omega, lam, numbers[5], grid),
        _scattering(c.stuck, second, Omega, lam, numbers[5], grid),
        numbers[0],
        numbers[1],
        numbers[2] * A,
        numbers[7],
        colour,
        numbers[2] * A > 0.0 or numbers[7] > 0.0 or colour.size > 0.0,
        grid,
        origin,
        second,
        numbers[5],
        int(numbers[6]),
        stream,
        address,
    )
