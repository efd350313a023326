"""Orbits of balls in cavities flown in mpmath: maps, multipliers and gaps by a code of its own, for any system."""

from __future__ import annotations

from itertools import combinations

import mpmath as mp

from vines.systems import ImpactPair

STEP = mp.mpf(10) ** -10


class Flown:
    """An orbit at the parameters and near the impacts that vines says, in 30 digits.

    A state is x1, v1 and x2, v2 of each ball; the capsule of the impact pair has no state of its own.
    """

    def __init__(self, orbit, half):
        p = orbit.params
        self.pair = isinstance(p, ImpactPair)
        self.half = half
        self.G = mp.mpf(p.G)
        self.balls = 1 if self.pair else p.balls
        if self.pair:
            self.B, self.Omega = mp.mpf(p.B), mp.mpf(1)
            self.mu, self.beta, self.r = [None], [mp.mpf(1)], [mp.mpf(p.r)]
        else:
            self.A, self.Omega, self.lam = mp.mpf(p.A), mp.mpf(p.Omega), mp.mpf(p.lam)
            self.mu, self.beta, self.r = ([mp.mpf(each) for each in getattr(p, name)] for name in ("mu", "beta", "r"))
        self.times = [mp.mpf(t) for t in orbit.t]
        self.period = 2 * mp.pi * orbit.word.p / self.Omega
        self.numbers = [max(ball, 1) - 1 for ball in orbit.word.balls]
        self.sides = orbit.word.sides
        self.places = self._places(orbit)

    def _places(self, orbit):
        """Where each ball is just after each impact, by its own last one, which vines says."""
        after = [tuple(map(mp.mpf, pair)) for pair in orbit._after()]
        places = []
        for j in range(len(self.times)):
            rows = []
            for b in range(self.balls):
                i = next(k % len(self.times) for k in range(j, j - len(self.times), -1) if self.numbers[k] == b)
                since = self.times[j] - self.times[i] + (self.period if i > j else 0)
                x, v = mp.mpf(orbit.states[i][2]), after[i][1]
                rows.append((x + v * since - self.G * since**2 / 2, v - self.G * since))
            places.append((mp.mpf(orbit.states[j][0]), after[j][0], rows))
        return places

    def frame(self, x, v, t, tau):
        """Position, velocity and acceleration of the frame."""
        if self.pair:
            s, c = mp.sin(t + tau), mp.cos(t + tau)
            return self.B * s, self.B * c, -self.B * s
        w, lam = self.Omega, self.lam
        # A (sin + lam w cos) = Re of A (lam w - i) e^{i w t}
        steady = self.A * mp.mpc(lam * w, -1) / mp.mpc(1 - w**2, lam * w)
        at = lambda when: steady * mp.expj(w * when)  # noqa: E731
        s = mp.mpc(-lam / 2, mp.sqrt(1 - lam**2 / 4))
        y, dy = x - at(t).real, v - (mp.j * w * at(t)).real
        c = mp.mpc(y, (s.real * y - dy) / s.imag)
        free, forced = c * mp.exp(s * tau), at(t + tau)
        return tuple((s**k * free).real + ((mp.j * w) ** k * forced).real for k in range(3))

    def gap(self, state, t, ball, tau):
        """w, w', w''."""
        x, v, rows = state
        x1, v1, a1 = self.frame(x, v, t, tau)
        x2, v2 = rows[ball]
        return x1 - x2 - v2 * tau + self.G * tau**2 / 2, v1 - v2 + self.G * tau, a1 + self.G

    def fly(self, state, t, tau):
        x, v, rows = state
        x1, v1, _ = self.frame(x, v, t, tau)
        return x1, v1, [(x2 + v2 * tau - self.G * tau**2 / 2, v2 - self.G * tau) for x2, v2 in rows]

    def strike(self, state, ball):
        x, v, rows = state
        x2, v2 = rows[ball]
        w, r = v - v2, self.r[ball]
        after = v if self.pair else v - self.mu[ball] * (1 + r) * w / (1 + self.mu[ball])
        rows = list(rows)
        rows[ball] = (x2, after + r * w)
        return x, after, rows

    def start(self):
        """A state in the middle of the flight from the last impact to the first, and its time."""
        last, first = self.times[-1], self.times[0] + self.period
        middle = (first - last) / 2
        return self.fly(self.places[-1], last, middle), last + middle - self.period

    def numbers_of(self, state):
        rows = [each for pair in state[2] for each in pair]
        return rows if self.pair else [state[0], state[1], *rows]

    def state_of(self, numbers):
        own = list(numbers) if self.pair else list(numbers[2:])
        rows = [(own[2 * k], own[2 * k + 1]) for k in range(self.balls)]
        return (mp.mpf(0), mp.mpf(0), rows) if self.pair else (numbers[0], numbers[1], rows)

    def map(self, numbers, t):
        """The state after one period, or of a symmetric orbit the mirror image of that after half of one."""
        state, count = self.state_of(numbers), len(self.times) // (2 if self.half else 1)
        end = t + self.period / (2 if self.half else 1)
        for j in range(count):
            ball, wall = self.numbers[j], self.sides[j] * self.beta[self.numbers[j]]
            tau = self.times[j] - t
            for _ in range(8):  # Newton
                w, speed, _ = self.gap(state, t, ball, tau)
                tau -= (w - wall) / speed
            state, t = self.strike(self.fly(state, t, tau), ball), t + tau
        found = self.numbers_of(self.fly(state, t, end - t))
        return [-each for each in found] if self.half else found

    def tangent(self):
        """How far the orbit is from closing, and M or H by differences."""
        state, t = self.start()
        at = self.numbers_of(state)
        closed = self.map(at, t)
        columns = []
        for k in range(len(at)):
            ahead, behind = list(at), list(at)
            ahead[k] += STEP
            behind[k] -= STEP
            columns.append([(a - b) / (2 * STEP) for a, b in zip(self.map(ahead, t), self.map(behind, t), strict=True)])
        return max(abs(a - b) for a, b in zip(closed, at, strict=True)), mp.matrix(columns).T

    def condition(self, kind):
        """The defining equation of a bifurcation, with the size of M."""
        off, M = self.tangent()
        n = M.rows
        if kind == "neimark_sacker":
            pairs = list(combinations(range(n), 2))
            M = mp.matrix([[M[i, k] * M[j, m] - M[i, m] * M[j, k] for k, m in pairs] for i, j in pairs])
            n = len(pairs)
        sign = 1 if kind in ("symmetry_breaking", "period_doubling") else -1
        return off, mp.det(mp.eye(n) + sign * M) / (1 + mp.mnorm(M, "f"))

    def closing(self, orbit):
        """How far each flight ends from the next impact of its ball, which also holds where the impact has no speed."""
        off = mp.mpf(0)
        for j, t in enumerate(self.times):
            k = (j + 1) % len(self.times)
            x1, v1, rows = self.fly(self.places[j], t, self.times[k] - t + (self.period if k <= j else 0))
            x2, v2 = rows[self.numbers[k]]
            off = max(off, *(abs(a - mp.mpf(b)) for a, b in zip((x1, v1, x2, v2), orbit.states[k], strict=True)))
            off = max(off, abs(x1 - x2 - self.sides[k] * self.beta[self.numbers[k]]))
        return off

    def touch(self, orbit):
        """The least speed of an impact or distance of a turning point to a wall, these being found on a fine grid."""
        least = mp.mpf(min(abs(orbit.w_dot)))
        for j, t in enumerate(self.times):
            following = self.times[j + 1] if j + 1 < len(self.times) else self.times[0] + self.period
            for ball in range(self.balls):
                own = self.beta[ball]
                grid = [(following - t) * k / 100 for k in range(101)]
                speeds = [self.gap(self.places[j], t, ball, tau)[1] for tau in grid]
                for a, b, first, second in zip(grid, grid[1:], speeds, speeds[1:], strict=False):
                    if first * second < 0:
                        tau = (a + b) / 2
                        for _ in range(8):
                            _, speed, bend = self.gap(self.places[j], t, ball, tau)
                            tau -= speed / bend
                        least = min(least, abs(abs(self.gap(self.places[j], t, ball, tau)[0]) - own))
        return least
