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


class Run:
    """Ball and oscillator from a release on, the events told one by one."""

    def __init__(self, values: dict[str, mp.mpf], side: int, t: mp.mpf, v: mp.mpf) -> None:
        self.values, self.t, self.v1, self.v2 = values, t, v, v
        self.x = _force(values, t) - values["lam"] * v
        self.x2 = self.x - side
        self.motion = Motion(values, mp.mpf(1), self.x, v, t)

    def strike(self, wall: int, guess: mp.mpf) -> None:
        """Go on to the impact on a wall next to a guess of its time."""
        mu, r = self.values["mu"], self.values["r"]
        at = _contact(self.motion, self.x2, self.v2, wall, guess)
        self.x, self.v1, _ = self.motion.at(at)
        common, closing = self.v1 + mu * self.v2, self.v1 - self.v2
        self.v1, self.v2 = (common - mu * r * closing) / (1 + mu), (common + r * closing) / (1 + mu)
        self.t, self.x2 = at, self.x - wall
        self.motion = Motion(self.values, mp.mpf(1), self.x, self.v1, at)

    def leaves(self, wall: int) -> tuple[mp.mpf, mp.mpf]:
        """Return departure speed and push towards the wall."""
        return wall * (self.v2 - self.v1), wall * self.motion.at(self.t)[2]

    def released(self, sticks: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        """Return time, x1 and v1 of the release if the ball merges now, from a guess of how long it sticks."""
        mu = self.values["mu"]
        stuck = Motion(self.values, 1 + mu, self.x, (self.v1 + mu * self.v2) / (1 + mu), self.t)
        t = mp.findroot(lambda s: stuck.at(s)[2], self.t + sticks)
        return t, *stuck.at(t)[:2]

    def ride(self, wall: int, sticks: mp.mpf) -> None:
        """Merge now and go on to the release."""
        self.t, self.x, self.v1 = self.released(sticks)
        self.x2, self.v2 = self.x - wall, self.v1
        self.motion = Motion(self.values, mp.mpf(1), self.x, self.v1, self.t)


def _round(
    values: dict[str, mp.mpf], side: int, t: mp.mpf, v: mp.mpf, events: Sequence[Event]
) -> tuple[mp.mpf, mp.mpf]:
    """Return time and velocity of the release to which that at t with velocity v leads."""
    run = Run(values, side, t, v)
    for event in events:
        run.strike(event.side, mp.mpf(event.t))
        if not event.sticks:
            continue
        while True:
            speed, push = run.leaves(event.side)
            if speed / push < SMALL:
                break
            run.strike(event.side, run.t + 2 * speed / push)
        run.ride(event.side, mp.mpf(event.t) + event.sticks - run.t)
    return run.t, run.v1


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


FINE = mp.mpf("1e-24")
"""Of one-sided ones."""

LEFT = mp.mpf("1e-6")
"""Time left of a chatter that is only just complete, where it is compared with the limit: to so much that is wrong, and
the difference grows by its power -1.6."""


def _limit(r: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    """Return departure speed over j s², and the share of the time s left that a hop takes, of that limit."""
    y = mp.findroot(
        lambda y: (3 - y) * (1 - y) ** 2 - r * (3 - 2 * y), (mp.mpf("0.001"), mp.mpf("0.999")), solver="anderson"
    )
    return y / 2 - y * y / 6, y


def end_in_digits(orbit: Orbit, parameter: str) -> float:
    """Return the value of a parameter at which the last chatter of an orbit is only just complete.

    The orbit has to be near that end; if its word is symmetric it is taken to be its own mirror image. Unknown are time
    and velocity of the release after that chatter and the parameter, so many impacts of the chatter being followed that
    what is left of it does not matter.
    """
    with mp.workdps(DIGITS):
        values = {name: mp.mpf(value) for name, value in orbit.params.as_dict().items()}
        lengths = orbit.spells["t_release"] - orbit.spells["t_start"]
        spell = orbit.spells[int(np.argmin(lengths))]
        half = orbit.word.symmetric
        wall = int(spell["side"]) * (-1 if half else 1)
        rest = orbit.period / (2 if half else 1)
        begin = {"x1": spell["x1"], "v1": spell["v1"], "x2": spell["x1"] - spell["side"], "v2": spell["v1"]}
        flown = simulate(orbit.params, **begin, t=spell["t_release"], periods=orbit.word.p + 1).events
        # All after the start, but for the last hops of the chatter, of which doubles know little.
        known = [row for row in flown if 1e-6 < row["t"] - spell["t_release"] < rest - 1e-3]
        if any(row["kind"] != IMPACT for row in known):
            raise ValueError("only orbits with one star, or two mirror images of one, are compared")

        def equations(t: mp.mpf, v: mp.mpf, value: mp.mpf) -> list[mp.mpf]:
            at = {**values, parameter: value}
            run, (hop, share) = Run(at, int(spell["side"]), t, v), _limit(at["r"])
            for row in known:
                run.strike(int(row["side"]), mp.mpf(float(row["t"])))
            left = mp.mpf("1e-3")
            while True:
                end, x, speed = run.released(left)
                left = end - run.t
                if left < LEFT:
                    break
                run.strike(wall, run.t + share * left)
                left *= 1 - share
            falls = -wall * Motion(at, mp.mpf(1), x, speed, end).at(end + STEP)[2] / STEP
            sign = -1 if half else 1
            return [
                end - t - orbit.word.p * mp.pi * (1 if half else 2) / at["Omega"],
                speed - sign * v,
                run.leaves(wall)[0] / (falls * left**2) / hop - 1,
            ]

        y = mp.matrix([mp.mpf(float(spell["t_release"])), mp.mpf(float(spell["v1"])), values[parameter]])
        for _ in range(3):
            here, slopes = mp.matrix(equations(*y)), mp.matrix(3, 3)
            for j in range(3):
                beside = y.copy()
                beside[j] += FINE
                slopes[:, j] = (mp.matrix(equations(*beside)) - here) / FINE
            y -= mp.lu_solve(slopes, here)
        return float(y[2])
