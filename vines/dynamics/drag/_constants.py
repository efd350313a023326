"""The numbers that the kernels need for a ball that is dragged: the flow of x1, x1', x2' in closed form.

The matrix of (x1, v1, v2) has one real eigenvalue -rho and the pair s, conj(s) of an oscillator. With the left
eigenvector of the first, y = v2 - (rho x1 + rho² v1)/P decays by itself, P = rho² - lam rho + 1; what x1 is beside
kappa y, is an oscillator of the stiffness delta/rho. Nothing is divided by delta or mu, and |s + rho| >= Im s, so that
the limits delta -> 0 and mu -> 0 are regular (docs/dynamics.md, "A ball that is dragged").
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

from vines.dynamics._constants import LARGE, NARROW, Oscillator, constants_at, oscillator
from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.kernels import njit

__all__ = ["DragConstants", "DragFrame", "DragTable", "Gap", "GapConstants", "drag_constants"]


class DragFrame(NamedTuple):
    """The oscillator with a ball that flies in it, or rides on it: then ``flies`` and all that is of the drag are 0.

    A motion is (u, G, y, way) as six reals: x1 = Re u + kappa y, with u and G those of `own`, y' = -rho y, and `way`
    how far the ball has come. ``tx``, ``tv`` are rho/P and rho²/P; the forced part of y is Re[(yr + i yi) G]. The ball
    has the velocity Re[(mr + i mi) u + (nr + i ni) G] + ``by`` y. Its relative velocity is Re W + ``ey`` y with
    W = a u + b G, which turns as u does under the force z G.
    """

    own: Oscillator
    flies: float
    rho: float
    kappa: float
    tx: float
    tv: float
    yr: float
    yi: float
    mr: float
    mi: float
    nr: float
    ni: float
    by: float
    ar: float
    ai: float
    br: float
    bi: float
    zr: float
    zi: float
    ey: float


class Gap(NamedTuple):
    """The same frame as seen from the ball: its position is that of the oscillator less the way of the ball."""

    frame: DragFrame


class GapConstants(NamedTuple):
    """What a search for contacts needs, in the frame of the ball, which rests."""

    Omega: float
    Omega4: float
    window: float
    near: float
    free: Gap


class DragConstants(NamedTuple):
    """As `Constants`, of a ball that is dragged, without ``friction``; ``gap`` is what is seen from the ball."""

    mu: float
    A: float
    Omega: float
    r: float
    lam: float
    delta: float
    friction: float
    Omega5: float
    period: float
    window: float
    near: float
    correction: float
    law: ImpactLaw
    free: DragFrame
    stuck: DragFrame
    gap: GapConstants


class DragTable(NamedTuple):
    """The constants of one run, where kernels for many runs take a table."""

    constants: DragConstants


@constants_at.register(DragTable)
@njit
def _constants_at(table, k):
    return table.constants


def _rate(mu: float, lam: float, delta: float) -> float:
    """Return rho, the real root of (s² + lam s + 1)(s + delta) + mu delta s² = 0 with its sign turned."""

    def excess(rho: float) -> float:
        return (rho * (rho - lam) + 1.0) * (delta - rho) + mu * delta * rho * rho

    low, high = 0.0, lam + (1.0 + mu) * delta
    for _ in range(64):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) > 0.0 else (low, middle)
    rho = delta if delta < 1e-3 else 0.5 * (low + high)
    for _ in range(4):
        bend = rho * (rho - lam) + 1.0
        rho -= excess(rho) / ((2.0 * rho - lam) * (delta - rho) - bend + 2.0 * mu * delta * rho)
    return rho


def _frame(mu: float, A: float, Omega: float, lam: float, delta: float) -> DragFrame:
    """Return the frame with a ball that flies."""
    rho = _rate(mu, lam, delta)
    size = rho * (rho - lam) + 1.0
    tx, tv = rho / size, rho * rho / size
    stiffness = 1.0 - mu * delta * tx
    half = 0.5 * (lam + mu * delta * (1.0 - lam * rho) / size)
    # The pair itself; its forcing follows below.
    pair = oscillator(1.0 / stiffness, 1.0, Omega, 2.0 * half / stiffness)
    s, io = complex(-pair.half, pair.gamma), complex(0.0, Omega)
    force = A * complex(lam * Omega, -1.0)
    # y is driven by -tv F and drives the pair in turn.
    driven = -tv / (io + rho)
    effective = 1.0 + mu * delta * driven
    lead = complex(pair.half, Omega + pair.gamma)
    g = force * effective / lead
    y = driven * lead / effective
    detuning = complex(pair.dr, pair.di)
    size = abs(detuning)
    q = g / detuning if size > 0.0 else complex(math.inf, math.inf)
    reach = 0.0
    if size < NARROW or abs(q) > LARGE:
        reach = 1.0 / size if size > 0.0 else math.inf
    own = pair._replace(gr=g.real, gi=g.imag, qr=q.real, qi=q.imag, reach=reach)
    kappa = mu * delta / (rho * (rho - 2.0 * half) + stiffness)
    m, n = tx + tv * s, tv + y
    by = 1.0 + kappa * (tx - rho * tv)
    a, b = s - m, 1.0 - n
    return DragFrame(
        own, 1.0, rho, kappa, tx, tv, y.real, y.imag, m.real, m.imag, n.real, n.imag, by,
        a.real, a.imag, b.real, b.imag, *_parts(a + b * (io - s)), -rho * kappa - by,
    )  # fmt: skip


def _parts(z: complex) -> tuple[float, float]:
    return z.real, z.imag


@functools.lru_cache(maxsize=64)
def drag_constants(mu: float, A: float, Omega: float, r: float, lam: float, delta: float) -> DragConstants:
    """Return the `DragConstants` at bare parameter values."""
    free = _frame(mu, A, Omega, lam, delta)
    fastest = max(1.0, Omega, free.rho)
    window, near = 2.0 / fastest, 4e-3 / fastest**1.25
    cube = 1.0 - r**3
    return DragConstants(
        mu,
        A,
        Omega,
        r,
        lam,
        delta,
        0.0,
        Omega**5,
        2.0 * math.pi / Omega,
        window,
        near,
        2.0 / 3.0 * mu / (1.0 + mu) ** 2 / cube if cube > 0.0 else math.inf,
        impact_law(mu, r),
        free,
        DragFrame(oscillator(1.0 + mu, A, Omega, lam), *[0.0] * 19),
        GapConstants(Omega, Omega**4, window, near, Gap(free)),
    )
