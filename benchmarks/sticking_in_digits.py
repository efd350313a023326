"""The map from release to release of an orbit that sticks, in many digits and by itself: no kernel of vines is used.

Only the order of the impacts and first guesses of their times are taken from an orbit. A chatter is followed, impact by
impact, until what is left of it would change nothing in the digits of interest; then comes the merge.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import mpmath as mp
import numpy as np

from vines.dynamics import simulate
from vines.orbits import Orbit

__all__ = ["multipliers_in_digits", "rounds_in_digits"]

DIGITS = 70
SMALL = mp.mpf("1e-22")
"""Departure speed, over the contact force, at which a chatter is replaced by its merge."""

IMPACT, STICK, RELEASE = 1, 2, 3
SAME = 1e-6

STEP = mp.mpf("1e-18")
"""Of the central differences."""


class Event(NamedTuple):
    """An impact: wall and time, and, if it is the last of a followed chatter, how long the ball sticks then."""

    side: int
    t: float
    sticks: float


class Motion:
    """The forced oscillator of a mass from a state at a time, in closed form."""

    def __init__(self, values: dict[str, mp.mpf], mass: mp.mpf, x: mp.mpf, v: mp.mpf, t: mp.mpf) -> None:
        A, Omega, lam = values["A"], values["Omega"], values["lam"]
        self.mass, self.t, self.Omega = mass, t, Omega
        self.half = lam / (2 * mass)
        self.gamma = mp.sqrt(1 / mass - self.half**2)
        # Steady response to A sin(theta) + lam Omega A cos(theta).
        self.q = A * mp.mpc(lam * Omega, -1) / mp.mpc(1 - mass * Omega**2, lam * Omega)
        xp, vp, _ = self._steady(t)
        self.a = x - xp
        self.b = (v - vp + self.half * self.a) / self.gamma

    def _steady(self, t: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        turned = self.q * mp.expj(self.Omega * t)
        return turned.real, -self.Omega * turned.imag, -(self.Omega**2) * turned.real

    def at(self, t: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        """Return x, v and the acceleration."""
        s, c = mp.sin(self.gamma * (t - self.t)), mp.cos(self.gamma * (t - self.t))
        size = mp.exp(-self.half * (t - self.t))
        xp, vp, ap = self._steady(t)
        x = size * (self.a * c + self.b * s)
        v = size * ((self.gamma * self.b - self.half * self.a) * c - (self.gamma * self.a + self.half * self.b) * s)
        return x + xp, v + vp, ap - 2 * self.half * v - x / self.mass


def _contact(motion: Motion, x2: mp.mpf, v2: mp.mpf, side: int, guess: mp.mpf) -> mp.mpf:
    """Return the time at which the gap is `side`, by Newton's method."""
    t = guess
    for _ in range(60):
        x, v, _ = motion.at(t)
        step = (x - x2 - v2 * (t - motion.t) - side) / (v - v2)
        t -= step
        if abs(step) < mp.mpf("1e-40"):
            return t
    raise ArithmeticError("no contact near the guess")


def _force(values: dict[str, mp.mpf], t: mp.mpf) -> mp.mpf:
    angle = values["Omega"] * t
    return values["A"] * (mp.sin(angle) + values["lam"] * values["Omega"] * mp.cos(angle))


def _round(
    values: dict[str, mp.mpf], side: int, t: mp.mpf, v: mp.mpf, events: Sequence[Event]
) -> tuple[mp.mpf, mp.mpf]:
    """Return time and velocity of the release to which that at t with velocity v leads."""
    mu, r, lam = values["mu"], values["r"], values["lam"]
    x = _force(values, t) - lam * v
    x2, v1, v2 = x - side, v, v
    motion = Motion(values, mp.mpf(1), x, v1, t)

    def strike(at: mp.mpf, wall: int) -> None:
        nonlocal motion, t, x, x2, v1, v2
        x, v1, _ = motion.at(at)
        common, closing = v1 + mu * v2, v1 - v2
        v1, v2 = (common - mu * r * closing) / (1 + mu), (common + r * closing) / (1 + mu)
        t, x2 = at, x - wall
        motion = Motion(values, mp.mpf(1), x, v1, t)

    for event in events:
        wall = event.side
        strike(_contact(motion, x2, v2, wall, mp.mpf(event.t)), wall)
        if not event.sticks:
            continue
        while True:
            push, leaves = wall * motion.at(t)[2], wall * (v2 - v1)
            if leaves / push < SMALL:
                break
            strike(_contact(motion, x2, v2, wall, t + 2 * leaves / push), wall)
        v1 = v2 = (v1 + mu * v2) / (1 + mu)
        stuck = Motion(values, 1 + mu, x, v1, t)
        t = mp.findroot(lambda s, stuck=stuck: stuck.at(s)[2], mp.mpf(event.t) + event.sticks)
        x, v1, _ = stuck.at(t)
        x2, v2 = x - wall, v1
        motion = Motion(values, mp.mpf(1), x, v1, t)
    return t, v1


def _events(orbit: Orbit) -> tuple[mp.mpf, list[Event]]:
    """Return the time of a release on the wall of the last spell, and the impacts up to the next one like it."""
    rows = simulate(orbit.params, **orbit.start(), periods=2 * orbit.word.p).events
    last = orbit.spells[-1]
    late = (rows["t"] - last["t_release"]) % orbit.period
    alike = (rows["kind"] == RELEASE) & (np.minimum(late, orbit.period - late) < SAME)
    first, second = np.flatnonzero(alike)[:2]
    told = rows[first + 1 : second + 1]
    events = []
    for k, row in enumerate(told):
        if row["kind"] == IMPACT:
            ends = told[k + 1]["kind"] == STICK
            events.append(Event(int(row["side"]), float(row["t"]), float(told[k + 2]["t"] - row["t"]) if ends else 0.0))
    return mp.mpf(float(rows[first]["t"])), events


def rounds_in_digits(orbit: Orbit) -> tuple[mp.mpf, mp.matrix]:
    """Return how far the release of an orbit is from coming back after its period, and the slopes of the round.

    Returns
    -------
    (defect, matrix)
        The larger of the differences in time and velocity, and the derivatives of time and velocity by those before.
    """
    with mp.workdps(DIGITS):
        values = {name: mp.mpf(value) for name, value in orbit.params.as_dict().items()}
        t, events = _events(orbit)
        side, v = int(orbit.spells["side"][-1]), mp.mpf(float(orbit.spells["v1"][-1]))
        end, speed = _round(values, side, t, v, events)
        period = 2 * mp.pi * orbit.word.p / values["Omega"]
        slopes = mp.matrix(2, 2)
        for j, (dt, dv) in enumerate(((STEP, 0), (0, STEP))):
            above = _round(values, side, t + dt, v + dv, events)
            below = _round(values, side, t - dt, v - dv, events)
            for i in range(2):
                slopes[i, j] = (above[i] - below[i]) / (2 * STEP)
        return max(abs(end - t - period), abs(speed - v)), slopes


def multipliers_in_digits(orbit: Orbit) -> tuple[float, np.ndarray]:
    """Return the defect of an orbit and its two multipliers that sticking leaves, the largest modulus first."""
    defect, slopes = rounds_in_digits(orbit)
    found = np.linalg.eigvals(np.array(slopes.tolist(), dtype=float)).astype(complex)
    return float(defect), found[np.lexsort((-found.imag, -found.real, -np.abs(found)))]
